"""A body along a parameter, in unknowns that it has at all values of it.

A filament that bends alike in all directions needs no directors, and one that is curved by nature
or does not bend alike does: its vector of unknowns is longer. Along a parameter that leads from one
to the other, directors are there from the beginning.
"""

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any

from undula.analysis.parameters import changed
from undula.analysis.states.records import NotFound
from undula.errors import InputError
from undula.models.model import Model

# States that stay what they are when they are turned about the axis, which some bodies cannot be.
_TURNED = {
    "straight": "the straight state",
    "spinning": "spinning",
    "flapping": "planar flapping",
}


def _with_shared_unknowns(model: Model, parameter: str, values: Iterable[float]) -> Model:
    """Return the model with unknowns that it has at all of these values, and in between.

    Raises
    ------
    InputError
        There is no such parameter, or a value is out of its range.
    """
    if all(changed(model, parameter, value).axisymmetric for value in values):
        return model
    return model.with_(keep_directors=True)


def model_along(model: Model, kind: str, parameter: str, values: Iterable[float]) -> Model:
    """Return a model whose states of a kind can be followed through values of a parameter.

    Its unknowns are the same at all of them; its own value does not matter.

    Raises
    ------
    InputError
        There is no such parameter, a value is out of its range, or there are no states of the kind
        at some values.
    """
    shared = _with_shared_unknowns(model, parameter, values)
    if kind in _TURNED and not shared.axisymmetric:
        raise InputError(
            f"{_TURNED[kind]} cannot be followed along {parameter} to where the filament is held in"
            " one direction, by natural curvature or a bending_ratio other than 1, and has no such"
            " state; follow equilibrium or periodic, or take another parameter"
        )
    return shared


def with_unknowns_of(model: Model, state: Any, parameter: str, find: Callable[..., Any]) -> Any:
    """Return a state in the unknowns of a model that is the same body.

    Parameters
    ----------
    model, parameter
        As from `model_along`.
    state
        A state of the body.
    find : callable
        From a model and a guess to a state of the same kind, or none.

    Raises
    ------
    InputError
        There is none, as of a motion that repeats itself up to a turn alone.
    """
    if model.axisymmetric == state.model.axisymmetric:
        return replace(state, model=model)
    found = find(model, state)
    if isinstance(found, NotFound):
        raise InputError(
            f"the state cannot be followed along {parameter}, where the filament is held in one"
            f" direction: {found.reason}"
        )
    return found
