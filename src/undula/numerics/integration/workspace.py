"""The scratch of a step, made once for many steps."""

from typing import Any, NamedTuple

import numpy as np

from undula.jit.compilation import kernel
from undula.numerics.integration.system import RATES

#: Backward differentiation of a higher order is unstable.
HIGHEST_ORDER = 6


class Work(NamedTuple):
    """Scratch of a step, so that a step allocates nothing; slices of arrays would count as well."""

    predicted: np.ndarray  # (n + RATES,)
    psi: np.ndarray  # (n + RATES,) w = y - predicted + psi
    change: np.ndarray  # (n + RATES,) y - predicted
    y: np.ndarray  # (n,)
    w: np.ndarray
    turning: np.ndarray  # S y
    phase: np.ndarray  # S psi: a step without rotation in the frame has <S psi, y> = 0
    correction: np.ndarray
    rates: np.ndarray  # (RATES,)
    series: np.ndarray  # (2, HIGHEST_ORDER + 1) for a change of step


@kernel
def workspace(n: Any) -> Any:
    """Return the scratch of a stepper of n unknowns."""
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
