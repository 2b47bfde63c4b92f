"""Choice of order, length and frame of the next step, and the change of stored differences."""

from typing import Any

from undula.jit.compilation import kernel
from undula.numerics.integration.stepper_state import (
    EQUAL_STEPS,
    FACTORED_C,
    FRAME_CHANGES,
    FRAME_VOTES,
    IN_FRAME,
    ORDER,
    PLANNED_FACTOR,
    PLANNED_ORDER,
    SHAPE_SPEED,
    SPEED,
    STEP,
    STEPS,
)
from undula.numerics.integration.system import error_norm, rotate

#: Step over the longest step that the error estimate allows.
SAFETY = 0.8
#: Smallest factor of the step after an error, largest factor after a success.
MIN_FACTOR, MAX_FACTOR = 0.2, 10.0
#: Smallest factor of the step that is worth a new matrix.
MIN_FACTOR_CHANGE = 1.1
#: Limits of the speed of shape change over the speed: the co-rotating frame is entered below the
#: first and left above the second, each after this number of consecutive checks.
ENTER_FRAME_BELOW, LEAVE_FRAME_ABOVE, VOTES_TO_CHANGE = 0.3, 0.8, 3
#: Steps from one check to the next.
STEPS_PER_FRAME_CHECK = 4


@kernel
def rescale(differences: Any, order: Any, ratio: Any, series: Any) -> None:
    """Convert backward differences for a step h to those for a step ratio * h, in place.

    The interpolating polynomial of degree `order` stays the same. With the backward shift 1 - D
    over h, the new differences are powers of 1 - (1 - D)^ratio, a series in D that is finite for
    polynomials. `series` (2, order + 1) is scratch for the coefficients of it and of its powers.
    """
    binomial, series[1, 0] = 1.0, 1.0
    for j in range(1, order + 1):
        binomial *= (j - 1 - ratio) / j
        series[0, j], series[1, j] = -binomial, 0.0
    for k in range(1, order + 1):
        for j in range(order, -1, -1):  # the next power, from the highest term down
            term = 0.0
            for i in range(1, j + 1):
                term += series[0, i] * series[1, j - i]
            series[1, j] = term
        for i in range(differences.shape[1]):  # needs rows k and higher only
            differences[k, i] *= series[1, k]
        for j in range(k + 1, order + 1):
            for i in range(differences.shape[1]):
                differences[k, i] += series[1, j] * differences[j, i]


@kernel
def change_step(stepper: Any, work: Any, ratio: Any) -> None:
    """Multiply the step by a factor."""
    if ratio != 1.0:
        rescale(stepper.differences, stepper.count[ORDER], ratio, work.series)
        stepper.real[STEP] *= ratio
        stepper.count[EQUAL_STEPS] = 0


@kernel
def accept(stepper: Any, work: Any) -> None:
    """Update the backward differences by the accepted change."""
    differences, order = stepper.differences, stepper.count[ORDER]
    for i in range(differences.shape[1]):
        differences[order + 2, i] = work.change[i] - differences[order + 1, i]
        differences[order + 1, i] = work.change[i]
    for j in range(order, 0, -2):  # two differences at a time, as memory access limits the speed
        for i in range(differences.shape[1]):
            sum_ = differences[j, i] + differences[j + 1, i]
            differences[j, i] = sum_
            differences[j - 1, i] += sum_
    if order % 2 == 0:
        for i in range(differences.shape[1]):
            differences[0, i] += differences[1, i]
    stepper.count[EQUAL_STEPS] += 1


@kernel
def plan(system: Any, stepper: Any, options: Any, error: Any, scale: Any) -> None:
    """Choose order and length of the next step from the error estimates of three orders."""
    order = stepper.count[ORDER]
    stepper.count[PLANNED_ORDER] = order
    stepper.real[PLANNED_FACTOR] = 1.0
    if stepper.count[EQUAL_STEPS] < order + 1:
        return
    best, best_order = factor_for(error, order), order
    if order > 1:
        lower = options.error[order - 1] * error_norm(
            system, stepper.differences[order], options.mask
        )
        factor = factor_for(lower / scale, order - 1)
        if factor > best:
            best, best_order = factor, order - 1
    if order + 4 <= stepper.differences.shape[0]:
        higher = options.error[order + 1] * error_norm(
            system, stepper.differences[order + 2], options.mask
        )
        factor = factor_for(higher / scale, order + 1)
        if factor > best:
            best, best_order = factor, order + 1
    factor = min(MAX_FACTOR, SAFETY * best, options.longest_step / stepper.real[STEP])
    if best_order != order or factor > MIN_FACTOR_CHANGE or factor < 1.0 / MIN_FACTOR_CHANGE:
        stepper.count[PLANNED_ORDER] = best_order
        stepper.real[PLANNED_FACTOR] = factor


@kernel
def factor_for(error: Any, order: Any) -> Any:
    """Return the factor of the step at which the error estimate of this order becomes 1."""
    return max(error, 1e-10) ** (-1.0 / (order + 1))


@kernel
def frame_check_due(stepper: Any, options: Any) -> Any:
    """Return whether `choose_frame` needs the speeds after the last step."""
    counts = stepper.count
    return options.frame == 1 and (
        counts[IN_FRAME] == 1 or counts[STEPS] % STEPS_PER_FRAME_CHECK == 0
    )


@kernel
def choose_frame(system: Any, stepper: Any) -> None:
    """Enter or leave the co-rotating frame, by the share of shape change in the speed."""
    if stepper.count[STEPS] % STEPS_PER_FRAME_CHECK > 0:
        return
    in_frame = stepper.count[IN_FRAME] == 1
    share = stepper.real[SHAPE_SPEED] / stepper.real[SPEED] if stepper.real[SPEED] > 0.0 else 1.0
    votes = share > LEAVE_FRAME_ABOVE if in_frame else share < ENTER_FRAME_BELOW
    stepper.count[FRAME_VOTES] = stepper.count[FRAME_VOTES] + 1 if votes else 0
    if stepper.count[FRAME_VOTES] >= VOTES_TO_CHANGE:
        stepper.count[FRAME_VOTES] = 0
        stepper.count[FRAME_CHANGES] += 1
        stepper.count[IN_FRAME] = 0 if in_frame else 1
        turn_history(system, stepper, 1.0 if in_frame else -1.0)
        stepper.real[FACTORED_C] = 0.0


@kernel
def turn_history(system: Any, stepper: Any, sign: Any) -> None:
    """Rotate each past state by its own angle, to the lab (sign +1) or to the frame (sign -1)."""
    n = stepper.factored_at.shape[0]
    differences, rows = stepper.differences, stepper.count[ORDER] + 3
    swap_differences_and_values(differences, rows)
    for j in range(rows):
        rotate(system, differences[j, :n], sign * differences[j, n], differences[j, :n])
    swap_differences_and_values(differences, rows)


@kernel
def swap_differences_and_values(differences: Any, rows: Any) -> None:
    """Convert backward differences to past values, or back: the map is its own inverse."""
    for first in range(1, rows):
        for j in range(rows - 1, first - 1, -1):
            for i in range(differences.shape[1]):
                differences[j, i] = differences[j - 1, i] - differences[j, i]
