"""The complete state of a stepper; checkpoints store it, so that a resumed run is the same run."""

from typing import Any, NamedTuple

import numpy as np

from undula.jit.compilation import kernel
from undula.numerics.integration.schemes import BackwardDifferentiation
from undula.numerics.integration.system import RATES

#: Indices of `StepperState.real`.
TIME, STEP, PLANNED_FACTOR, FACTORED_C, FACTORED_ANGLE, CONTRACTION = range(6)
TURN_RATE, SPEED, SHAPE_SPEED, DISPLACEMENT, STORING_RATE, SMALLEST_STEP, LARGEST_STEP = range(
    6, 13
)
REALS = 13
#: Indices of `StepperState.count`.
ORDER, PLANNED_ORDER, EQUAL_STEPS, STEPS, REJECTED, FAILED, FACTORISATIONS, SOLVES = range(8)
IN_FRAME, FRAME_VOTES, FRAME_CHANGES, PLANAR = range(8, 12)
COUNTS = 12
#: Shapes of a stepper's arrays, for the declarations of entry points, see `undula.jit.sizes`.
STEPPER_SIZES = (
    f"stepper.factored_at (n), stepper.differences (r, n + {RATES}), stepper.factors (n, b),"
    f" stepper.border (n), stepper.real ({REALS}), stepper.count ({COUNTS}) int"
)


class StepperState(NamedTuple):
    """Arrays of a stepper, changed in place, for n unknowns and `RATES` integrals.

    Attributes
    ----------
    differences : ndarray, shape (max order + 3, n + RATES)
        Backward differences of the unknowns, followed by those of the integrals.
    factors : ndarray, shape (n, 2 b + 1)
        The factored matrix of Newton's method; count[PLANAR] is 1 if it is the planar matrix.
    factored_at : ndarray, shape (n,)
        The state at which it was assembled, in the orientation of the matrix.
    border : ndarray, shape (n,)
        Its solution for the column of the rate of rotation.
    real : ndarray, shape (REALS,)
        Times, steps and rates, by the indices above.
    count : ndarray of int, shape (COUNTS,)
        Orders, counters and flags, by the indices above.
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
    """Return a stepper before its first step.

    Parameters
    ----------
    system : NamedTuple
        The system, see `undula.numerics.integration.system`.
    scheme : BackwardDifferentiation
        The family of formulas.
    y : ndarray, shape (n,)
        Unknowns at the start.
    rates : ndarray, shape (n + RATES,)
        Rates of change of the unknowns and of the integrals at the start.
    time : float
        Time of the start.
    step : float
        First step, above 0.

    Returns
    -------
    StepperState
        A stepper of order 1.
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
def orders_are_valid(stepper: Any) -> Any:
    """Return whether a stepper has the differences that its order and its planned order need."""
    highest = stepper.differences.shape[0] - 3
    order, planned = stepper.count[ORDER], stepper.count[PLANNED_ORDER]
    return 0 < order <= highest and 0 < planned <= highest
