"""Derivatives of the onset of the straight state by a parameter.

At the onset an eigenvalue sigma of the pencil K + sigma M is imaginary. A small change of the
matrices moves it by

    d sigma = -w' (dK + sigma dM) c / (w' M c)

with the right and left null vectors c and w, and the force has to follow so that sigma stays
imaginary.
"""

import numpy as np

from undula.analysis.linear.onset import first_pair
from undula.analysis.linear.pencils import linearised
from undula.analysis.linear.results import Method
from undula.analysis.parameters import changed, neighbours, value_of
from undula.arrays import Array
from undula.errors import InputError
from undula.models.model import Model
from undula.numerics.linalg.pencil import Pencil

# Difference of the fourth order: places in steps and weights, and the step relative to the
# parameter or to 1. Its error is 1e-12, and the round-off of a stiffness of 1e4 over the step 1e-9.
_STENCIL = ((-2, 1.0 / 12.0), (-1, -2.0 / 3.0), (1, 2.0 / 3.0), (2, -1.0 / 12.0))
_STEP = 1e-3


def onset_slopes(model: Model, parameter: str, method: Method | None = None) -> dict[str, float]:
    """Return the derivatives of the force and the frequency of the onset by a parameter.

    Parameters
    ----------
    model : Model
        Its own force does not matter; its straight state loses stability at some force.
    parameter : str
        Name of a number or of a value of a table, not the force.
    method : {"spectral", "modes", "discrete"}, optional
        As in `undula.onset`.

    Returns
    -------
    dict of str to float
        `value` [B/L^2] and `frequency` [cycles per T], per unit of the parameter.

    Raises
    ------
    InputError
        The parameter is not one of the model, or the model does not have the method.
    """
    linearisation = linearised(model, method)
    pair = first_pair(linearisation)
    assert pair is not None  # as the onset exists
    pencil = linearisation.pencil
    nearby = _nearby(model, parameter, method, pencil.mass.shape)
    if nearby is None:
        return _differences(model, parameter, method)
    matrix = pencil.stiffness(pair.p) + 1j * pair.omega * pencil.mass
    left, _, right = np.linalg.svd(matrix)
    w, c = left[:, -1].conj(), right[-1].conj()

    def change(stiffness: Array, mass: Array) -> complex:
        return complex(-(w @ (stiffness + 1j * pair.omega * mass) @ c) / (w @ pencil.mass @ c))

    by_force = change(pencil.slope(pair.p), np.zeros_like(pencil.mass))
    by_parameter = sum(
        weight * change(other.stiffness(pair.p), other.mass) for weight, other in nearby
    )
    force = -by_parameter.real / by_force.real
    turning = by_parameter.imag + by_force.imag * force
    return {"value": force, "frequency": turning / (2.0 * np.pi)}


def _nearby(
    model: Model, parameter: str, method: Method | None, shape: tuple[int, ...]
) -> list[tuple[float, Pencil]] | None:
    """Return nearby pencils with their weights in the derivative; None if they do not compare.

    They do not at an end of the range, and where another value moves a break of the load.
    """
    value = value_of(model, parameter)
    step = _STEP * max(1.0, abs(value))
    pencils = []
    for place, weight in _STENCIL:
        try:
            other = linearised(changed(model, parameter, value + place * step), method).pencil
        except InputError:
            return None
        if other.mass.shape != shape:
            return None
        pencils.append((weight / step, other))
    return pencils


def _differences(model: Model, parameter: str, method: Method | None) -> dict[str, float]:
    """Return the slopes between the onsets of two models, to some eight digits."""
    below, above, width = neighbours(model, parameter, value_of(model, parameter))
    low, high = (first_pair(linearised(side, method)) for side in (below, above))
    assert low is not None
    assert high is not None
    turning = (high.omega - low.omega) / width
    return {"value": (high.p - low.p) / width, "frequency": turning / (2.0 * np.pi)}
