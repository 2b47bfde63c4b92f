"""The kinds of states that are solved for, with the functions that each kind has."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from undula.analysis.solvers.equilibrium import (
    equilibrium_family,
    equilibrium_judge,
    equilibrium_start,
    equilibrium_unknowns,
    find_equilibrium,
)
from undula.analysis.solvers.flapping import (
    find_flapping,
    flapping_family,
    flapping_judge,
    flapping_start,
    flapping_unknowns,
)
from undula.analysis.solvers.periodic_orbits import (
    periodic_family,
    periodic_judge,
    periodic_start,
    periodic_unknowns,
)
from undula.analysis.solvers.periodic_search import find_periodic
from undula.analysis.solvers.quantities import quantities_of
from undula.analysis.solvers.spinning import (
    find_spinning,
    spinning_family,
    spinning_judge,
    spinning_start,
    spinning_unknowns,
)
from undula.analysis.states.extrapolation import Converged, converge, error_of_links
from undula.analysis.states.follow_branch import Family
from undula.analysis.states.not_found import NotFound
from undula.analysis.states.periodic_record import Periodic
from undula.analysis.states.records import Equilibrium, Flapping, Spinning
from undula.arrays import Array
from undula.errors import InputError
from undula.models.model import Model
from undula.numerics.continuation.arclength import Point


@dataclass(frozen=True)
class Kind:
    """The functions of a kind of state.

    Attributes
    ----------
    find : callable
        From a model, and optionally a guess, to the state or `NotFound`.
    family : callable
        From a state, a parameter and its scale to the family along the parameter.
    unknowns : callable
        From a state to the unknowns of its family.
    start : callable
        From a model to the problem in the force and the Hopf point at which states begin, or None.
    judge : callable
        From a model and a parameter to the function that records solutions of such a problem.
    """

    find: Callable[..., Any]
    family: Callable[[Any, str, float], Family[Any]]
    unknowns: Callable[[Any], Array]
    start: Callable[[Model], tuple[Any, Point] | None]
    judge: Callable[[Model, str], Callable[[Any, Array, float], Any]]


KINDS: Mapping[str, Kind] = {
    "spinning": Kind(
        find_spinning,
        spinning_family,
        spinning_unknowns,
        spinning_start,
        spinning_judge,
    ),
    "flapping": Kind(
        find_flapping,
        flapping_family,
        flapping_unknowns,
        flapping_start,
        flapping_judge,
    ),
    "equilibrium": Kind(
        find_equilibrium,
        equilibrium_family,
        equilibrium_unknowns,
        equilibrium_start,
        equilibrium_judge,
    ),
    "periodic": Kind(
        find_periodic,
        periodic_family,
        periodic_unknowns,
        periodic_start,
        periodic_judge,
    ),
}
#: A state of any of these kinds.
Solved = Spinning | Flapping | Equilibrium | Periodic


def kind_by_name(name: str) -> Kind:
    """Return the functions of a kind of state.

    Parameters
    ----------
    name : {"spinning", "flapping", "equilibrium", "periodic"}
        Name of the kind.

    Returns
    -------
    Kind

    Raises
    ------
    InputError
        The kind does not exist.
    """
    if name not in KINDS:
        raise InputError(f"{name!r} is no kind of state; take {' or '.join(KINDS)}")
    return KINDS[name]


def kind_of_state(state: Solved) -> Kind:
    """Return the kind of a state."""
    return KINDS[state.kind]


def with_error(state: Solved) -> Solved:
    """Return the state with the error of its frequency, of links and solver together.

    The error stays None if the state is not found with another number of links.
    """
    if isinstance(state, Equilibrium):
        return state  # its frequency is 0 exactly

    def frequency_on(other: Model) -> float | None:
        same = kind_of_state(state).find(other, state)
        return None if isinstance(same, NotFound) else float(same.frequency)

    by_links = error_of_links(state.model, state.frequency, frequency_on)
    return state if by_links is None else replace(state, error=by_links + state.solver_error)


def extrapolate(
    model: Model,
    kind: str,
    guess: Any = None,
    *,
    progress: Callable[[int], None] | None = None,
) -> Converged[Any] | NotFound:
    """Return a state in the limit of many links, by Romberg extrapolation.

    Parameters
    ----------
    model : Model
        With the fewest links from which the limit is taken.
    kind : {"spinning", "flapping", "equilibrium", "periodic"}
        Kind of the state.
    guess : optional
        Guess for the search with the fewest links, as in the function that finds such a state.
    progress : callable, optional
        Called with each number of links before the state is solved for.

    Returns
    -------
    Converged or NotFound
        Frequency, energy, tip and leading rates with their errors, and the state with the most
        links.

    Raises
    ------
    InputError
        The kind does not exist, or the links of the model are its body.

    Examples
    --------
    >>> import undula as un
    >>> limit = un.find(un.Filament(8, un.TipLoad(75.0)), "spinning", converged=True)
    >>> limit.links[:3], limit.errors["frequency"] < 1e-4 * limit.values["frequency"]
    ((8, 16, 32), True)
    """
    solver = kind_by_name(kind)

    def find(finer: Model, coarser: Any) -> Any:
        if progress:
            progress(finer.links)
        return solver.find(finer, guess if coarser is None else coarser)

    return converge(model, find, quantities_of)
