"""A bifurcation known for one model: found again for a similar one, and for many links."""

from collections.abc import Callable
from typing import Any

from undula.analysis.branch_records import Bifurcation
from undula.analysis.convergence import Converged, converge
from undula.analysis.kinds import follow, kind_named
from undula.analysis.parameters import changed
from undula.analysis.states import NotFound
from undula.models.model import Model

# It is looked for within this share of its value, on either side.
_NEARBY = 0.05


def found_again(
    known: Bifurcation[Any],
    model: Model,
    parameter: str,
    is_it: Callable[[Bifurcation[Any]], bool],
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
    """
    start, end = (known.value + side * _NEARBY * abs(known.value) for side in (-1.0, 1.0))
    begun = kind_named(known.state).find(changed(model, parameter, start), known.state)
    if isinstance(begun, NotFound):
        return begun
    branch = follow(begun, parameter, end, enough=is_it)
    for bifurcation in branch.bifurcations:
        if is_it(bifurcation):
            return bifurcation
    return NotFound(f"no such change between {parameter} {start:.6g} and {end:.6g}")


def limit_of(known: Bifurcation[Any], parameter: str) -> Converged[Any] | NotFound:
    """Return a bifurcation in the limit of many links, with its value and frequencies."""
    first = known.state.model

    def again(model: Model, coarser: Bifurcation[Any] | None) -> Bifurcation[Any] | NotFound:
        if coarser is None and model.links == first.links:
            return known
        return found_again(coarser or known, model, parameter, lambda one: _alike(one, known))

    return converge(first, again, quantities_of)


def quantities_of(bifurcation: Bifurcation[Any]) -> dict[str, float]:
    """Return the numbers of a bifurcation that are worth converging."""
    numbers = {"value": bifurcation.value, "frequency": bifurcation.frequency}
    if bifurcation.second_frequency is not None:
        numbers["second_frequency"] = bifurcation.second_frequency
    return numbers


def _alike(one: Bifurcation[Any], other: Bifurcation[Any]) -> bool:
    return (one.kind, one.loses, one.gains) == (other.kind, other.loses, other.gains)
