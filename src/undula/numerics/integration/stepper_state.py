"""The whole memory of a stepper: what a checkpoint holds, so that a resumed run is the same run."""

from typing import Any, NamedTuple

import numpy as np

from undula.jit.compilation import kernel
from undula.numerics.integration.schemes import BackwardDifferentiation
from undula.numerics.integration.system import RATES

#: Entries of `Memory.real`.
TIME, STEP, PLANNED_FACTOR, FACTORED_C, FACTORED_ANGLE, CONTRACTION = range(6)
TURN_RATE, SPEED, SHAPE_SPEED, DISPLACEMENT, STORING_RATE, SMALLEST_STEP, LARGEST_STEP = range(
    6, 13
)
REALS = 13
#: Entries of `Memory.count`.
ORDER, PLANNED_ORDER, EQUAL_STEPS, STEPS, REJECTED, FAILED, FACTORISATIONS, SOLVES = range(8)
IN_FRAME, FRAME_VOTES, FRAME_CHANGES, PLANAR = range(8, 12)
COUNTS = 12
#: What a memory has to be for compiled code to keep inside of it, see `undula.jit.sizes`.
MEMORY_SIZES = (
    f"memory.factored_at (n), memory.differences (r, n + {RATES}), memory.factors (n, b),"
    f" memory.border (n), memory.real ({REALS}), memory.count ({COUNTS}) int"
)


class StepperState(NamedTuple):
    """Arrays that a stepper changes in place, for n unknowns and the integrals of their rates.

    Attributes
    ----------
    differences : ndarray, shape (max order + 3, n + RATES)
        Backward differences of the unknowns and, behind them, of the integrals.
    factors : ndarray, shape (n, 2 b + 1)
        The factored matrix of Newton's method; count[PLANAR] is 1 if it is a planar one.
    factored_at : ndarray, shape (n,)
        The state that it belongs to, in its own orientation.
    border : ndarray, shape (n,)
        Its solve with the column that belongs to the turning rate.
    real, count : ndarray
        Times, steps and rates; order and counters. The names above are their indices.
    """

    differences: np.ndarray
    factors: np.ndarray
    factored_at: np.ndarray
    border: np.ndarray
    real: np.ndarray
    count: np.ndarray  # type: ignore[assignment]  # hides tuple.count


def start(
    system: Any,
    scheme: BackwardDifferentiation,
    y: np.ndarray,
    rates: np.ndarray,
    time: float,
    step: float,
) -> StepperState:
    """Return the memory of a stepper about to take its first step from y (n,) at `time`.

    `rates` (n + RATES,) is the rate of change there of the unknowns and of the integrals.
    """
    n = y.size
    differences = np.zeros((scheme.max_order + 3, n + RATES))
    differences[0, :n], differences[1] = y, step * rates
    real, count = np.zeros(REALS), np.zeros(COUNTS, dtype=np.int64)
    real[[TIME, STEP, PLANNED_FACTOR, CONTRACTION, SMALLEST_STEP]] = time, step, 1.0, 1.0, np.inf
    count[[ORDER, PLANNED_ORDER]] = 1
    width = 2 * type(system).half_bandwidth + 1
    return StepperState(differences, np.zeros((n, width)), np.zeros(n), np.zeros(n), real, count)


@kernel
def has_its_orders(memory: Any) -> Any:
    """Tell whether a memory has the differences that its order and the next one take."""
    highest = memory.differences.shape[0] - 3
    order, planned = memory.count[ORDER], memory.count[PLANNED_ORDER]
    return 0 < order <= highest and 0 < planned <= highest
