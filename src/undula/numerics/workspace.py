"""The scratch of a step, made once for many steps."""

from typing import Any, NamedTuple

import numpy as np

from undula.compiled import kernel
from undula.numerics.system import RATES


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
    )
