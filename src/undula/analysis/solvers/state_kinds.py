"""The kinds of states that are solved for, and what every question asks of a kind."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from undula.analysis.parameters import FORCE, value_of
from undula.analysis.solvers.equilibrium import (
    Equilibrium,
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
from undula.analysis.solvers.quantities import of_flapping, of_periodic, of_steady
from undula.analysis.solvers.spinning import (
    find_spinning,
    spinning_family,
    spinning_judge,
    spinning_start,
    spinning_unknowns,
)
from undula.analysis.states.along_parameter import model_along, with_unknowns_of
from undula.analysis.states.branch import Bifurcation, Branch
from undula.analysis.states.extrapolation import Converged, converge, error_of_links
from undula.analysis.states.follow_branch import Family, Progress, follow_branch
from undula.analysis.states.periodic_record import Periodic
from undula.analysis.states.records import Flapping, NotFound, Spinning
from undula.arrays import Array
from undula.errors import InputError
from undula.models.model import Model
from undula.numerics.continuation.arclength import Point, Steps, advance

# A branch is stepped along in parts of the way that it is asked to go.
_PARTS = 8.0
# Arclength between a Hopf point and the first point of a branch.
_AWAY = 0.03


@dataclass(frozen=True)
class Kind:
    """What can be done with a kind of state.

    Attributes
    ----------
    find : callable
        From a model, and perhaps a guess, to the state or to none.
    family : callable
        From a state, a parameter and its scale to the family along the parameter.
    unknowns : callable
        From a state to the unknowns of its family.
    quantities : callable
        From a state to the numbers that are worth converging.
    start : callable
        From a model to the problem in the force and the Hopf point at which states begin, or None.
    judge : callable
        From a model and a parameter to the function that judges solutions of such a problem.
    """

    find: Callable[..., Any]
    family: Callable[[Any, str, float], Family[Any]]
    unknowns: Callable[[Any], Array]
    quantities: Callable[[Any], Mapping[str, float]]
    start: Callable[[Model], tuple[Any, Point] | None]
    judge: Callable[[Model, str], Callable[[Any, Array, float], Any]]


KINDS: Mapping[str, Kind] = {
    "spinning": Kind(
        find_spinning,
        spinning_family,
        spinning_unknowns,
        of_steady,
        spinning_start,
        spinning_judge,
    ),
    "flapping": Kind(
        find_flapping,
        flapping_family,
        flapping_unknowns,
        of_flapping,
        flapping_start,
        flapping_judge,
    ),
    "equilibrium": Kind(
        find_equilibrium,
        equilibrium_family,
        equilibrium_unknowns,
        of_steady,
        equilibrium_start,
        equilibrium_judge,
    ),
    "periodic": Kind(
        find_periodic,
        periodic_family,
        periodic_unknowns,
        of_periodic,
        periodic_start,
        periodic_judge,
    ),
}
_NAMES = {
    Spinning: "spinning",
    Flapping: "flapping",
    Equilibrium: "equilibrium",
    Periodic: "periodic",
}
#: A state of any of these kinds.
Solved = Spinning | Flapping | Equilibrium | Periodic


def kind_by_name(name: str) -> Kind:
    """Return the kind of a name.

    Raises
    ------
    InputError
        There is no such kind.
    """
    if name not in KINDS:
        raise InputError(f"{name!r} is no kind of state; take {' or '.join(KINDS)}")
    return KINDS[name]


def with_error(state: Solved) -> Solved:
    """Return the state with the error of its frequency, of links and solver together.

    It stays without one if the state is not found with another number of links.
    """
    if isinstance(state, Equilibrium):
        return state  # what rests has no frequency

    def again(other: Model) -> float | None:
        found = kind_of_state(state).find(other, state)
        return None if isinstance(found, NotFound) else float(found.frequency)

    by_links = error_of_links(state.model, state.frequency, again)
    return state if by_links is None else replace(state, error=by_links + state.solver_error)


def extrapolate(
    model: Model,
    kind: str,
    guess: Any = None,
    *,
    progress: Callable[[int], None] | None = None,
) -> Converged[Any] | NotFound:
    """Return a state in the limit of many links.

    Parameters
    ----------
    model : Model
        With the fewest links of those that the limit is taken from.
    kind : {"spinning", "flapping", "equilibrium", "periodic"}
    guess : optional
        What the search with the fewest links begins with, as in the call that finds such a state.
    progress : callable, optional
        Called with each number of links before the state is solved for.

    Raises
    ------
    InputError
        There is no such kind, or the links of the model are its body.
    """
    chosen = kind_by_name(kind)

    def find(finer: Model, coarser: Any) -> Any:
        if progress:
            progress(finer.links)
        return chosen.find(finer, guess if coarser is None else coarser)

    return converge(model, find, chosen.quantities)


def follow(
    state: Solved,
    parameter: str,
    to: float,
    *,
    progress: Progress | None = None,
    enough: Callable[[Bifurcation[Any]], bool] = lambda _: False,
    stop: Callable[[], bool] = lambda: False,
) -> Branch[Any]:
    """Follow a state along a parameter, judge it all along, and locate its bifurcations.

    Parameters
    ----------
    state : Spinning, Flapping, Equilibrium or Periodic
    parameter : str
        Name of the parameter, such as "load.force" or "model.drag_ratio".
    to : float
        Its value at which to end. A branch that turns back ends where it began, or where no step
        succeeds; then it is not complete.
    progress : callable, optional
        Called with each value that was reached.
    enough : callable, optional
        Tells of a bifurcation whether the branch may end behind it.
    stop : callable, optional
        Tells whether to end with what there is, which is not complete then.

    Raises
    ------
    InputError
        There is no such parameter, or it is a whole number, or `to` is where the state is or out of
        the parameter's range, or there are no such states on the way.
    """
    kind, start = kind_of_state(state), value_of(state.model, parameter)
    model = model_along(state.model, _NAMES[type(state)], parameter, (start, to))
    if to == start:
        raise InputError(f"{parameter} is {start} already; give another value to follow to")
    if model is not state.model:
        state = with_unknowns_of(model, state, parameter, kind.find)
    scale = abs(to - start) / _PARTS
    family = kind.family(state, parameter, scale)
    return follow_branch(
        family, kind.unknowns(state), start, to, Steps(scale=scale), progress, enough, stop=stop
    )


def follow_from_onset(
    model: Model,
    kind: str,
    to: float,
    *,
    progress: Progress | None = None,
    stop: Callable[[], bool] = lambda: False,
) -> Branch[Any] | NotFound:
    """Follow the branch of a kind of state from the Hopf point of the straight state on.

    The first point lies a little off the Hopf point. A subcritical branch goes down first and turns
    in a fold.

    Parameters
    ----------
    model : Model
        Its own force does not matter.
    kind : {"spinning", "flapping"}
    to : float
        The force at which to end [B/L^2], beyond the Hopf force.
    progress : callable, optional
        Called with each force that was reached.
    stop : callable, optional
        Tells whether to end with what there is, which is not complete then.

    Raises
    ------
    InputError
        There is no such kind, or `to` does not lie beyond the Hopf force.
    """
    chosen = kind_by_name(kind)
    began = chosen.start(model)
    if began is None:
        return NotFound("the straight state stays stable, so that no branch begins at it")
    problem, hopf = began
    if to <= hopf.p:
        raise InputError(f"the branch begins at force {hopf.p:.6g}; give an end beyond it")
    scale = (to - hopf.p) / _PARTS
    first = advance(problem, hopf, _AWAY, scale)
    if first is None:
        return NotFound(f"Newton's method finds no {kind} next to the Hopf point {hopf.p:.6g}")
    problem = problem.referred_to(first.u)
    state = chosen.judge(model, FORCE)(problem, first.u, first.p)
    family = chosen.family(state, FORCE, scale)
    steps = Steps(first=_AWAY, scale=scale)
    return follow_branch(
        family, first.u, first.p, to, steps, progress, start=first, least=0.0, stop=stop
    )


def kind_of_state(state: Solved) -> Kind:
    """Return the kind that a state is of."""
    return KINDS[_NAMES[type(state)]]
