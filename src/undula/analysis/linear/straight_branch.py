"""Branch of straight states along a parameter: growth rates and Hopf points."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import brentq

from undula.analysis.linear.spectrum import spectrum
from undula.analysis.linear.stability import method_for_all
from undula.analysis.parameters import changed, value_of
from undula.analysis.states.along_parameter import model_along
from undula.arrays import Array
from undula.models.model import Model

# Number of points of a branch; between two of them the rate is assumed to change its sign at most
# once.
_POINT_COUNT = 201


@dataclass(frozen=True)
class StraightBranch:
    """The straight state along a parameter.

    Attributes
    ----------
    parameter : str
        Name of the parameter.
    values : ndarray of shape (m,)
        Values of the parameter, in its unit.
    rates, frequencies : ndarray of shape (m,)
        Rate [1/T] and frequency [cycles/T] of the leading disturbance.
    hopf : tuple of (float, float)
        Values at which a pair crosses the imaginary axis, with its frequency [cycles/T].
    links : int or None
        Number of links of the discretisation; None for the continuum.
    """

    parameter: str
    values: Array
    rates: Array
    frequencies: Array
    hopf: tuple[tuple[float, float], ...]
    links: int | None = None


def follow_straight(model: Model, parameter: str, start: float, to: float) -> StraightBranch:
    """Follow the straight state along a parameter.

    Parameters
    ----------
    model : Model
        Model of the filament or chain.
    parameter : str
        Name of a continuous parameter, such as "load.force".
    start, to : float
        First and last value of the parameter.

    Returns
    -------
    StraightBranch

    Raises
    ------
    InputError
        The model has no such parameter, or a value is out of its range.
    """
    value_of(model, parameter)
    model_along(model, "straight", parameter, (start, to))
    method = method_for_all([changed(model, parameter, value) for value in (start, to)])

    def leading(value: float) -> complex:
        return complex(spectrum(changed(model, parameter, value), count=1, method=method).values[0])

    values = np.linspace(start, to, _POINT_COUNT)
    sigma = np.array([leading(value) for value in values])
    sign_changes = np.flatnonzero(sigma.real[1:] * sigma.real[:-1] < 0.0)
    hopf = []
    for k in sign_changes:
        root = float(brentq(lambda v: leading(v).real, values[k], values[k + 1], xtol=1e-13))
        hopf.append((root, abs(leading(root).imag) / (2.0 * np.pi)))
    frequencies = np.abs(sigma.imag) / (2.0 * np.pi)
    links = model.links if method == "discrete" else None
    return StraightBranch(parameter, values, sigma.real, frequencies, tuple(hopf), links)


def straight_at_values(
    model: Model, branch: StraightBranch, values: Sequence[float]
) -> StraightBranch:
    """Return a branch of straight states at chosen values in place of its own.

    Parameters
    ----------
    model : Model
        Model of the branch.
    branch : StraightBranch
        The branch; its Hopf points stay.
    values : sequence of float
        Values of the parameter, in their order.

    Returns
    -------
    StraightBranch
    """
    ends = [changed(model, branch.parameter, float(end)) for end in branch.values[[0, -1]]]
    method = method_for_all(ends)
    sigma = np.array(
        [
            spectrum(changed(model, branch.parameter, value), count=1, method=method).values[0]
            for value in values
        ]
    )
    frequencies = np.abs(sigma.imag) / (2.0 * np.pi)
    return replace(
        branch, values=np.array(values, dtype=float), rates=sigma.real, frequencies=frequencies
    )
