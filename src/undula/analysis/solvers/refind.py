"""Re-location of a known bifurcation for a nearby model, and its limit of many links."""

from collections.abc import Callable
from typing import Any

from undula.analysis.parameters import changed
from undula.analysis.solvers.branches import follow
from undula.analysis.solvers.state_kinds import kind_of_state
from undula.analysis.solvers.upward_branch import first_bifurcation
from undula.analysis.states.branch import Bifurcation
from undula.analysis.states.extrapolation import Converged, converge
from undula.analysis.states.follow_branch import Progress
from undula.analysis.states.not_found import NotFound, SearchStatus
from undula.errors import InputError
from undula.models.model import Model

# Half-widths of the intervals that are searched, in shares of the value, or of 1 if that is more.
_HALF_WIDTHS = (0.05, 0.25)
# Number of halvings that bring an end of the interval back into the parameter's range.
_HALVINGS = 20


def refind_bifurcation(
    known: Bifurcation[Any],
    model: Model,
    parameter: str,
    is_it: Callable[[Bifurcation[Any]], bool],
    progress: Progress | None = None,
) -> Bifurcation[Any] | NotFound:
    """Return the bifurcation of a similar model that is next to a known one.

    The state is solved for on one side of the known value and followed to the other side.

    Parameters
    ----------
    known : Bifurcation
        The bifurcation of the first model, with its state.
    model : Model
        With other parameters or another number of links.
    parameter : str
        Name of the parameter that the bifurcation is a value of.
    is_it : callable
        Returns True for a bifurcation of the right kind.
    progress : callable, optional
        Called with each value of the parameter that was reached.

    Returns
    -------
    Bifurcation or NotFound
    """
    result: Bifurcation[Any] | NotFound = NotFound(
        SearchStatus.ABSENT, "there is nowhere to look for it"
    )
    for share in _HALF_WIDTHS:
        width = share * max(1.0, abs(known.value))
        low, high = (_allowed(model, parameter, known.value, side * width) for side in (-1.0, 1.0))
        result = _between(known, model, parameter, (low, high), is_it, progress)
        if not isinstance(result, NotFound):
            break
    return result


def _between(
    known: Bifurcation[Any],
    model: Model,
    parameter: str,
    ends: tuple[float, float],
    is_it: Callable[[Bifurcation[Any]], bool],
    progress: Progress | None,
) -> Bifurcation[Any] | NotFound:
    state = kind_of_state(known.state).find(changed(model, parameter, ends[0]), known.state)
    if isinstance(state, NotFound):
        return state
    branch = follow(state, parameter, ends[1], progress=progress, enough=is_it)
    if isinstance(branch, NotFound):
        return branch
    return first_bifurcation(branch.bifurcations, is_it) or NotFound(
        SearchStatus.ABSENT,
        f"no such change between {parameter} {ends[0]:.6g} and {ends[1]:.6g}",
    )


def _allowed(model: Model, parameter: str, value: float, distance: float) -> float:
    """Return a value at a distance, or less far away if the model does not allow it there."""
    for _ in range(_HALVINGS):
        try:
            changed(model, parameter, value + distance)
        except InputError:
            distance *= 0.5
        else:
            return value + distance
    return value


def limit_of(known: Bifurcation[Any], parameter: str) -> Converged[Any] | NotFound:
    """Return a bifurcation in the limit of many links.

    Parameters
    ----------
    known : Bifurcation
        On the fewest links of those that the limit is taken from.
    parameter : str
        Name of the parameter that the bifurcation is a value of.

    Returns
    -------
    Converged or NotFound
        With the value and the frequencies.

    Raises
    ------
    InputError
        The links of the model are its body, so that there is no limit.
    """
    first = known.state.model

    def refind(model: Model, coarser: Bifurcation[Any] | None) -> Bifurcation[Any] | NotFound:
        if coarser is None and model.links == first.links:
            return known
        return refind_bifurcation(
            coarser or known, model, parameter, lambda point: alike(point, known)
        )

    return converge(first, refind, quantities_of)


def quantities_of(bifurcation: Bifurcation[Any]) -> dict[str, float]:
    """Return the numbers of a bifurcation that have a limit of many links, by name."""
    numbers = {"value": bifurcation.value, "frequency": bifurcation.frequency}
    if bifurcation.second_frequency is not None:
        numbers["second_frequency"] = bifurcation.second_frequency
    return numbers


def alike(first: Bifurcation[Any], second: Bifurcation[Any]) -> bool:
    """Return whether two bifurcations are of one kind, and do the same to stability."""
    return (first.kind, first.stability) == (second.kind, second.stability)
