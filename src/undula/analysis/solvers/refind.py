"""A bifurcation known for one model: found again for a similar one, and for many links."""

from collections.abc import Callable
from typing import Any

from undula.analysis.parameters import changed
from undula.analysis.solvers.branches import follow
from undula.analysis.solvers.state_kinds import kind_of_state
from undula.analysis.states.branch import Bifurcation
from undula.analysis.states.extrapolation import Converged, converge
from undula.analysis.states.follow_branch import Progress
from undula.analysis.states.not_found import NotFound, SearchStatus
from undula.errors import InputError
from undula.models.model import Model

# It is looked for within these shares of its value, or of 1 if that is more, on either side.
_NEARBY = (0.05, 0.25)
# Where one side is out of the parameter's range, so many halvings bring it back.
_HALVINGS = 20


def refind_bifurcation(
    known: Bifurcation[Any],
    model: Model,
    parameter: str,
    is_it: Callable[[Bifurcation[Any]], bool],
    progress: Progress | None = None,
) -> Bifurcation[Any] | NotFound:
    """Return the bifurcation of a similar model that is next to a known one.

    Parameters
    ----------
    known : Bifurcation
    model : Model
        With other parameters or another number of links.
    parameter : str
        Name of the parameter that the bifurcation is a value of.
    is_it : callable
        Tells of a bifurcation whether it is of the right kind.
    progress : callable, optional
        Called with each value of the parameter that was reached.
    """
    found: Bifurcation[Any] | NotFound = NotFound(
        SearchStatus.ABSENT, "there is nowhere to look for it"
    )
    for share in _NEARBY:
        away = share * max(1.0, abs(known.value))
        ends = [_inside(model, parameter, known.value, side * away) for side in (-1.0, 1.0)]
        found = _between(known, model, parameter, (ends[0], ends[1]), is_it, progress)
        if not isinstance(found, NotFound):
            break
    return found


def _between(
    known: Bifurcation[Any],
    model: Model,
    parameter: str,
    ends: tuple[float, float],
    is_it: Callable[[Bifurcation[Any]], bool],
    progress: Progress | None,
) -> Bifurcation[Any] | NotFound:
    begun = kind_of_state(known.state).find(changed(model, parameter, ends[0]), known.state)
    if isinstance(begun, NotFound):
        return begun
    branch = follow(begun, parameter, ends[1], progress=progress, enough=is_it)
    if isinstance(branch, NotFound):
        return branch
    for bifurcation in branch.bifurcations:
        if is_it(bifurcation):
            return bifurcation
    return NotFound(
        SearchStatus.ABSENT,
        f"no such change between {parameter} {ends[0]:.6g} and {ends[1]:.6g}",
    )


def _inside(model: Model, parameter: str, value: float, away: float) -> float:
    """Return a value some way off, less far if the model does not allow it there."""
    for _ in range(_HALVINGS):
        try:
            changed(model, parameter, value + away)
        except InputError:
            away *= 0.5
        else:
            return value + away
    return value


def limit_of(known: Bifurcation[Any], parameter: str) -> Converged[Any] | NotFound:
    """Return a bifurcation in the limit of many links, with its value and frequencies."""
    first = known.state.model

    def again(model: Model, coarser: Bifurcation[Any] | None) -> Bifurcation[Any] | NotFound:
        if coarser is None and model.links == first.links:
            return known
        return refind_bifurcation(coarser or known, model, parameter, lambda one: alike(one, known))

    return converge(first, again, quantities_of)


def quantities_of(bifurcation: Bifurcation[Any]) -> dict[str, float]:
    """Return the numbers of a bifurcation that are worth converging."""
    numbers = {"value": bifurcation.value, "frequency": bifurcation.frequency}
    if bifurcation.second_frequency is not None:
        numbers["second_frequency"] = bifurcation.second_frequency
    return numbers


def alike(one: Bifurcation[Any], other: Bifurcation[Any]) -> bool:
    """Tell whether two bifurcations are of one kind, and do the same to stability."""
    return (one.kind, one.loses, one.gains) == (other.kind, other.loses, other.gains)
