"""Checked forces and parameter values of a curve, and the models along it."""

from collections.abc import Sequence

import numpy as np

from undula.analysis.parameters import changed
from undula.analysis.states.along_parameter import model_along
from undula.arrays import Array
from undula.errors import InputError, is_number
from undula.models.model import Model


def checked_forces(forces: Sequence[float] | Array) -> Array:
    """Return forces as an array, after a check of their range.

    Parameters
    ----------
    forces : sequence of float
        At least one [B/L^2], each finite and at least 0.

    Returns
    -------
    ndarray of shape (m,)

    Raises
    ------
    InputError
        The list is empty, or a force is negative or not finite.
    """
    for force in _nonempty("forces", forces):
        if not (is_number(force) and force >= 0.0):
            raise InputError(f"force = {force!r} has to be a finite number, at least 0")
    return np.asarray(forces, dtype=float)


def checked_values(values: Sequence[float] | Array) -> Array:
    """Return values of a parameter as an array, after a check.

    Parameters
    ----------
    values : sequence of float
        At least one, each finite.

    Returns
    -------
    ndarray of shape (k,)

    Raises
    ------
    InputError
        The list is empty, or a value is not finite.
    """
    for value in _nonempty("values", values):
        if not is_number(value):
            raise InputError(f"values: {value!r} has to be a finite number")
    return np.asarray(values, dtype=float)


def models_along(model: Model, parameter: str, values: Array) -> list[Model]:
    """Return the model at each value of a parameter.

    Parameters
    ----------
    model : Model
        Model of the filament or chain.
    parameter : str
        Name of any parameter but "load.force".
    values : ndarray of shape (k,)
        Values of the parameter, in its unit.

    Returns
    -------
    list of Model

    Raises
    ------
    InputError
        The parameter is the force, or the straight filament is no equilibrium at a value.
    """
    if parameter == "load.force":
        raise InputError("the curve itself is about load.force; take another parameter for it")
    model_along(model, "straight", parameter, values.tolist())
    return [changed(model, parameter, value) for value in values.tolist()]


def _nonempty(name: str, values: Sequence[float] | Array) -> Sequence[float] | Array:
    if np.ndim(values) != 1 or len(values) == 0:
        raise InputError(f"{name} = {values!r} has to be a list of numbers, one at least")
    return values
