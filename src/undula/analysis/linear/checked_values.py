"""The forces and parameter values of a curve, checked, and the models along it."""

from collections.abc import Sequence

import numpy as np

from undula.analysis.parameters import changed
from undula.analysis.states.along_parameter import model_along
from undula.arrays import Array
from undula.errors import InputError, is_number
from undula.models.model import Model


def checked_forces(forces: Sequence[float] | Array) -> Array:
    """Return forces as an array (m,).

    Raises
    ------
    InputError
        There is none, or one is not finite or negative.
    """
    for force in _some("forces", forces):
        if not (is_number(force) and force >= 0.0):
            raise InputError(f"force = {force!r} has to be a finite number, at least 0")
    return np.asarray(forces, dtype=float)


def checked_values(values: Sequence[float] | Array) -> Array:
    """Return values of a parameter as an array (k,).

    Raises
    ------
    InputError
        There is none, or one is not finite.
    """
    for value in _some("values", values):
        if not is_number(value):
            raise InputError(f"values: {value!r} has to be a finite number")
    return np.asarray(values, dtype=float)


def models_along(model: Model, parameter: str, values: Array) -> list[Model]:
    """Return the model at each value of a parameter, which the force cannot be.

    Raises
    ------
    InputError
        It is, or the straight filament is no state at a value.
    """
    if parameter == "load.force":
        raise InputError("the curve itself is about load.force; take another parameter for it")
    model_along(model, "straight", parameter, values.tolist())
    return [changed(model, parameter, value) for value in values.tolist()]


def _some(name: str, values: Sequence[float] | Array) -> Sequence[float] | Array:
    if np.ndim(values) != 1 or len(values) == 0:
        raise InputError(f"{name} = {values!r} has to be a list of numbers, one at least")
    return values
