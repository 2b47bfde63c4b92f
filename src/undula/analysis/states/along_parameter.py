"""A body along a parameter, in the same unknowns at all its values.

A filament that bends alike in all directions needs no directors; a filament with natural curvature
or unequal bending stiffnesses needs them, so that it has more unknowns. Along a parameter that
leads from one to the other, directors are kept from the beginning.
"""

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any

from undula.analysis.parameters import changed
from undula.analysis.states.not_found import NotFound
from undula.errors import InputError
from undula.models.model import Model

# Kinds of states that only bodies with rotational symmetry have, in words.
_SYMMETRIC = {
    "straight": "the straight state",
    "spinning": "spinning",
    "flapping": "planar flapping",
}


def _with_shared_unknowns(model: Model, parameter: str, values: Iterable[float]) -> Model:
    """Return the model with the unknowns that it has at all these values, and in between.

    Raises
    ------
    InputError
        The parameter does not exist, or a value is out of its range.
    """
    if all(changed(model, parameter, value).axisymmetric for value in values):
        return model
    return model.with_(keep_directors=True)


def model_along(model: Model, kind: str, parameter: str, values: Iterable[float]) -> Model:
    """Return a model whose states of a kind can be followed through values of a parameter.

    Parameters
    ----------
    model : Model
        Its own value of the parameter does not matter.
    kind : {"straight", "spinning", "flapping", "equilibrium", "periodic"}
        Kind of the states.
    parameter : str
        Name of the parameter, such as "load.force".
    values : iterable of float
        Values of the parameter, in its unit.

    Returns
    -------
    Model
        With the same unknowns at all the values.

    Raises
    ------
    InputError
        The parameter does not exist, a value is out of its range, or the body has no states of the
        kind at some values.
    """
    shared = _with_shared_unknowns(model, parameter, values)
    if kind in _SYMMETRIC and not shared.axisymmetric:
        raise InputError(
            f"{_SYMMETRIC[kind]} cannot be followed along {parameter} to where the filament is held"
            " in one direction, by natural curvature or a bending_ratio other than 1, and has no"
            " such state; follow equilibrium or periodic, or take another parameter"
        )
    return shared


def with_unknowns_of(
    model: Model, state: Any, parameter: str, find: Callable[..., Any]
) -> Any | NotFound:
    """Return a state in the unknowns of a model that is the same body.

    Parameters
    ----------
    model : Model
        As returned by `model_along`.
    state : State
        A state of the body.
    parameter : str
        The parameter that the state is to be followed along.
    find : callable
        From a model and a guess to a state of the same kind, or `NotFound`.

    Returns
    -------
    State or NotFound
        The latter if the same body with directors has no such state, as a motion that repeats
        itself only up to a turn.
    """
    if model.axisymmetric == state.model.axisymmetric:
        return replace(state, model=model)
    same = find(model, state)
    if isinstance(same, NotFound):
        finding = (
            f"the state cannot be followed along {parameter}, where the filament is held in one"
            f" direction: {same.finding}"
        )
        return replace(same, finding=finding)
    return same
