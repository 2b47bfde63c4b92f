"""What happens between steps: order and length of the next one, and the frame to take it in."""

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
from undula.numerics.integration.system import rotate, size

#: A step is made this much shorter than its error estimate would allow.
SAFETY = 0.8
#: No step is shortened by more after an error, or lengthened by more after a success.
SHORTEST_FACTOR, LONGEST_FACTOR = 0.2, 10.0
#: A change of length by less is not worth a new matrix.
WORTHWHILE = 1.1
#: The frame turns along when less than this part of the speed is a change of shape, in so many
#: looks on end, and stops when more than the other part is. There is a look after so many steps.
ENGAGE_BELOW, RELEASE_ABOVE, VOTES = 0.3, 0.8, 3
STEPS_A_LOOK = 4


@kernel
def rescale(differences: Any, order: Any, ratio: Any, series: Any) -> None:
    """Turn backward differences up to `order` for a step h into those for ratio * h, in place.

    The interpolating polynomial stays the same: with the backward shift 1 - D over h, the new
    differences are powers of 1 - (1 - D)^ratio, a series in D that is finite for polynomials.
    `series` (2, order + 1) is scratch for its coefficients and for those of its powers.
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
def change_step(memory: Any, work: Any, ratio: Any) -> None:
    """Change the length of the steps by a factor."""
    if ratio != 1.0:
        rescale(memory.differences, memory.count[ORDER], ratio, work.series)
        memory.real[STEP] *= ratio
        memory.count[EQUAL_STEPS] = 0


@kernel
def accept(memory: Any, work: Any) -> None:
    """Take the change found into the backward differences."""
    differences, order = memory.differences, memory.count[ORDER]
    for i in range(differences.shape[1]):
        differences[order + 2, i] = work.change[i] - differences[order + 1, i]
        differences[order + 1, i] = work.change[i]
    for j in range(order, 0, -2):  # two differences at a time: memory is what it waits for
        for i in range(differences.shape[1]):
            sum_ = differences[j, i] + differences[j + 1, i]
            differences[j, i] = sum_
            differences[j - 1, i] += sum_
    if order % 2 == 0:
        for i in range(differences.shape[1]):
            differences[0, i] += differences[1, i]
    memory.count[EQUAL_STEPS] += 1


@kernel
def plan(system: Any, memory: Any, options: Any, error: Any, scale: Any) -> None:
    """Choose order and length of the next step from the errors that each order would make."""
    order = memory.count[ORDER]
    memory.count[PLANNED_ORDER] = order
    memory.real[PLANNED_FACTOR] = 1.0
    if memory.count[EQUAL_STEPS] < order + 1:
        return
    best, best_order = factor_for(error, order), order
    if order > 1:
        lower = options.error[order - 1] * size(system, memory.differences[order], options.mask)
        factor = factor_for(lower / scale, order - 1)
        if factor > best:
            best, best_order = factor, order - 1
    if order + 4 <= memory.differences.shape[0]:
        higher = options.error[order + 1] * size(
            system, memory.differences[order + 2], options.mask
        )
        factor = factor_for(higher / scale, order + 1)
        if factor > best:
            best, best_order = factor, order + 1
    factor = min(LONGEST_FACTOR, SAFETY * best, options.longest_step / memory.real[STEP])
    if best_order != order or factor > WORTHWHILE or factor < 1.0 / WORTHWHILE:
        memory.count[PLANNED_ORDER] = best_order
        memory.real[PLANNED_FACTOR] = factor


@kernel
def factor_for(error: Any, order: Any) -> Any:
    """Return the factor that would bring the error of a step of this order to 1."""
    return max(error, 1e-10) ** (-1.0 / (order + 1))


@kernel
def frame_check_due(memory: Any, options: Any) -> Any:
    """Tell whether the speeds after the last step are going to be looked at."""
    counts = memory.count
    return options.frame == 1 and (counts[IN_FRAME] == 1 or counts[STEPS] % STEPS_A_LOOK == 0)


@kernel
def choose_frame(system: Any, memory: Any) -> None:
    """Enter or leave the co-rotating frame when the share of the shape in the speed says so."""
    if memory.count[STEPS] % STEPS_A_LOOK > 0:
        return
    in_frame = memory.count[IN_FRAME] == 1
    share = memory.real[SHAPE_SPEED] / memory.real[SPEED] if memory.real[SPEED] > 0.0 else 1.0
    votes = share > RELEASE_ABOVE if in_frame else share < ENGAGE_BELOW
    memory.count[FRAME_VOTES] = memory.count[FRAME_VOTES] + 1 if votes else 0
    if memory.count[FRAME_VOTES] >= VOTES:
        memory.count[FRAME_VOTES] = 0
        memory.count[FRAME_CHANGES] += 1
        memory.count[IN_FRAME] = 0 if in_frame else 1
        turn_history(system, memory, 1.0 if in_frame else -1.0)
        memory.real[FACTORED_C] = 0.0


@kernel
def turn_history(system: Any, memory: Any, sign: Any) -> None:
    """Turn every past state by its own angle, to the lab (sign +1) or to the frame (sign -1)."""
    n = memory.factored_at.shape[0]
    differences, rows = memory.differences, memory.count[ORDER] + 3
    swap_differences_and_values(differences, rows)
    for j in range(rows):
        rotate(system, differences[j, :n], sign * differences[j, n], differences[j, :n])
    swap_differences_and_values(differences, rows)


@kernel
def swap_differences_and_values(differences: Any, rows: Any) -> None:
    """Turn backward differences into past values, or back: the map is its own inverse."""
    for first in range(1, rows):
        for j in range(rows - 1, first - 1, -1):
            for i in range(differences.shape[1]):
                differences[j, i] = differences[j - 1, i] - differences[j, i]
