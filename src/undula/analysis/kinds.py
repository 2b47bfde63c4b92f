"""The kinds of states that are solved for, and what every question asks of a kind."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

from undula.analysis.branch_records import Bifurcation, Branch
from undula.analysis.branches import Family, Progress, follow_branch
from undula.analysis.convergence import Converged, converge
from undula.analysis.flapping import find_flapping, flapping_family, flapping_unknowns
from undula.analysis.parameters import value_of
from undula.analysis.spinning import find_spinning, spinning_family, spinning_unknowns
from undula.analysis.states import Flapping, NotFound, Spinning
from undula.arrays import Array
from undula.errors import InputError
from undula.models.model import Model
from undula.numerics.continuation import Steps

KindName = Literal["spinning", "flapping"]

# A branch is stepped along in parts of the way that it is asked to go.
_PARTS = 8.0


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
    """

    find: Callable[..., Any]
    family: Callable[[Any, str, float], Family[Any]]
    unknowns: Callable[[Any], Array]
    quantities: Callable[[Any], Mapping[str, float]]


def _of_spinning(state: Spinning) -> dict[str, float]:
    return {
        "frequency": state.frequency,
        "bending_energy": state.bending_energy,
        "tip_radius": state.tip_radius,
        "tip_height": state.tip_height,
        "leading_rate": state.leading_rate,
    }


def _of_flapping(state: Flapping) -> dict[str, float]:
    ranges = {
        "bending_energy": state.energy,
        "tip_radius": state.tip_radius,
        "tip_height": state.tip_height,
    }
    spread = {
        f"{name}_{part}": getattr(values, part)
        for name, values in ranges.items()
        for part in ("min", "max", "mean")
    }
    rates = {"leading_rate_in_plane": state.leading_rate_in_plane}
    if state.leading_rate_out_of_plane is not None:
        rates["leading_rate_out_of_plane"] = state.leading_rate_out_of_plane
    return {"frequency": state.frequency} | spread | rates


KINDS: Mapping[str, Kind] = {
    "spinning": Kind(find_spinning, spinning_family, spinning_unknowns, _of_spinning),
    "flapping": Kind(find_flapping, flapping_family, flapping_unknowns, _of_flapping),
}


def kind_of(name: str) -> Kind:
    """Return the kind of a name.

    Raises
    ------
    InputError
        There is no such kind.
    """
    if name not in KINDS:
        raise InputError(f"{name!r} is no kind of state; take {' or '.join(KINDS)}")
    return KINDS[name]


def with_error(state: Spinning | Flapping) -> Spinning | Flapping:
    """Return the state with the error of its frequency against many links, if there is a limit.

    The state is solved for once more with two thirds of the links, or twice as many if they are
    few; the error falls as the square of their number.
    """
    links = state.model.links
    other_links = 2 * links // 3 if links >= 12 else 2 * links
    other = state.model.with_links(other_links)
    if other is None:
        return state
    found = kind_named(state).find(other, state)
    if isinstance(found, NotFound):
        return state
    share = abs((links / other_links) ** 2 - 1.0)
    return replace(state, error=abs(found.frequency - state.frequency) / share)


def converged(model: Model, kind: str) -> Converged[Any] | NotFound:
    """Return a state in the limit of many links.

    Parameters
    ----------
    model : Model
        With the fewest links of those that the limit is taken from.
    kind : {"spinning", "flapping"}

    Raises
    ------
    InputError
        There is no such kind, or the links of the model are its body.
    """
    chosen = kind_of(kind)
    return converge(model, chosen.find, chosen.quantities)


def follow(
    state: Spinning | Flapping,
    parameter: str,
    to: float,
    *,
    progress: Progress | None = None,
    enough: Callable[[Bifurcation[Any]], bool] = lambda _: False,
) -> Branch[Any]:
    """Follow a state along a parameter, judge it all along, and locate its bifurcations.

    Parameters
    ----------
    state : Spinning or Flapping
    parameter : str
        Name of the parameter, such as "load.force" or "model.drag_ratio".
    to : float
        Its value at which to end. A branch that turns back ends where it began, or where no step
        succeeds; then it is not complete.
    progress : callable, optional
        Called with each value that was reached.
    enough : callable, optional
        Tells of a bifurcation whether the branch may end behind it.

    Raises
    ------
    InputError
        There is no such parameter, or it is a whole number, or `to` is where the state is.
    """
    kind, start = kind_named(state), value_of(state.model, parameter)
    if to == start:
        raise InputError(f"{parameter} is {start} already; give another value to follow to")
    scale = abs(to - start) / _PARTS
    family = kind.family(state, parameter, scale)
    return follow_branch(
        family, kind.unknowns(state), start, to, Steps(scale=scale), progress, enough
    )


def kind_named(state: Spinning | Flapping) -> Kind:
    """Return the kind that a state is of."""
    return KINDS["spinning" if isinstance(state, Spinning) else "flapping"]
