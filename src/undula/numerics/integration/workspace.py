"""Scratch arrays of a step, allocated once for many steps."""

from typing import Any, NamedTuple

import numpy as np

from undula.jit.compilation import kernel
from undula.numerics.integration.system import RATES

#: Highest order of backward differentiation that is zero-stable.
HIGHEST_ORDER = 6


class Work(NamedTuple):
    """Scratch of a step, so that a step allocates no memory.

    Attributes
    ----------
    predicted : ndarray, shape (n + RATES,)
        Extrapolated unknowns and integrals.
    psi : ndarray, shape (n + RATES,)
        Contribution of past steps to w = y - predicted + psi.
    change : ndarray, shape (n + RATES,)
        The unknowns less their prediction.
    y, w : ndarray, shape (n,)
        The iterate, and c dy/dt.
    turning : ndarray, shape (n,)
        S y.
    phase : ndarray, shape (n,)
        S (predicted - psi): a step without rotation in the frame has <phase, y> = 0.
    correction : ndarray, shape (n,)
        Newton's correction.
    rates : ndarray, shape (RATES,)
        Rates of the integrals.
    series : ndarray, shape (2, HIGHEST_ORDER + 1)
        Coefficients for a change of the step.
    """

    predicted: np.ndarray
    psi: np.ndarray
    change: np.ndarray
    y: np.ndarray
    w: np.ndarray
    turning: np.ndarray
    phase: np.ndarray
    correction: np.ndarray
    rates: np.ndarray
    series: np.ndarray


@kernel
def workspace(n: Any) -> Any:
    """Return scratch for n unknowns."""
    m = n + RATES
    return Work(
        np.zeros(m),
        np.zeros(m),
        np.zeros(m),
        np.zeros(n),
        np.zeros(n),
        np.zeros(n),
        np.zeros(n),
        np.zeros(n),
        np.zeros(RATES),
        np.zeros((2, HIGHEST_ORDER + 1)),
    )
