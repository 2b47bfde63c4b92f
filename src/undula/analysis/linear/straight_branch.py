"""The straight state followed along a parameter: its growth rate, and where that changes sign."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from undula.analysis.linear.stability import method_for_all, spectrum
from undula.analysis.parameters import changed, value_of
from undula.analysis.states.along_parameter import model_along
from undula.arrays import Array
from undula.models.model import Model

# Points of a branch: between two of them the rate is taken to change its sign at most once.
_POINTS = 201


@dataclass(frozen=True)
class StraightBranch:
    """The straight state along a parameter.

    Attributes
    ----------
    parameter : str
        Name of the parameter.
    values : ndarray of shape (m,)
        Its values.
    rates, frequencies : ndarray of shape (m,)
        Of the leading disturbance [1/T] and [cycles per T].
    hopf : tuple of (float, float)
        Values at which a pair crosses the imaginary axis, and its frequency [cycles per T].
    links : int or None
        The number of links that all this is of; None for the method of the continuum.
    """

    parameter: str
    values: Array
    rates: Array
    frequencies: Array
    hopf: tuple[tuple[float, float], ...]
    links: int | None = None


def follow_straight(model: Model, parameter: str, start: float, to: float) -> StraightBranch:
    """Follow the straight state along a parameter.

    Raises
    ------
    InputError
        There is no such parameter, or a value is out of its range.
    """
    value_of(model, parameter)
    model_along(model, "straight", parameter, (start, to))
    method = method_for_all([changed(model, parameter, value) for value in (start, to)])

    def leading(value: float) -> complex:
        return complex(spectrum(changed(model, parameter, value), count=1, method=method).values[0])

    values = np.linspace(start, to, _POINTS)
    found = np.array([leading(value) for value in values])
    turns = np.flatnonzero(found.real[1:] * found.real[:-1] < 0.0)
    hopf = []
    for k in turns:
        at = float(brentq(lambda v: leading(v).real, values[k], values[k + 1], xtol=1e-13))
        hopf.append((at, abs(leading(at).imag) / (2.0 * np.pi)))
    frequencies = np.abs(found.imag) / (2.0 * np.pi)
    links = model.links if method == "discrete" else None
    return StraightBranch(parameter, values, found.real, frequencies, tuple(hopf), links)
