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
from undula.analysis.parameters import neighbours, value_of
from undula.arrays import Array
from undula.models.model import Model


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
    below, above, width = neighbours(model, parameter, value_of(model, parameter))
    pencil, less, more = (
        linearisation.pencil,
        linearised(below, method).pencil,
        linearised(above, method).pencil,
    )
    if less.mass.shape != more.mass.shape or less.mass.shape != pencil.mass.shape:
        return _differences(below, above, width, method)
    matrix = pencil.stiffness(pair.p) + 1j * pair.omega * pencil.mass
    left, _, right = np.linalg.svd(matrix)
    w, c = left[:, -1].conj(), right[-1].conj()

    def change(stiffness: Array, mass: Array) -> complex:
        return complex(-(w @ (stiffness + 1j * pair.omega * mass) @ c) / (w @ pencil.mass @ c))

    by_force = change(pencil.slope(pair.p), np.zeros_like(pencil.mass))
    by_parameter = change(
        (more.stiffness(pair.p) - less.stiffness(pair.p)) / width, (more.mass - less.mass) / width
    )
    force = -by_parameter.real / by_force.real
    turning = by_parameter.imag + by_force.imag * force
    return {"value": force, "frequency": turning / (2.0 * np.pi)}


def _differences(
    below: Model, above: Model, width: float, method: Method | None
) -> dict[str, float]:
    """Return the slopes between two models whose loads break at different arc lengths."""
    low, high = (first_pair(linearised(model, method)) for model in (below, above))
    assert low is not None
    assert high is not None
    turning = (high.omega - low.omega) / width
    return {"value": (high.p - low.p) / width, "frequency": turning / (2.0 * np.pi)}
