"""The time loop: steps until every asked time is reached, compiled end to end.

`advance` works on a `StepperState` in place and comes back when the asked times are filled, when a
number of steps is done (so that the caller can show progress or stop), when the list of sections is
full, or when no step can succeed. Calling it again goes on as if it had never come back.
"""

import math
from typing import Any

import numpy as np

from undula.jit.borrowed import borrowed
from undula.jit.compilation import entry, kernel
from undula.numerics.integration.dense_output import energy_maximum, interpolate
from undula.numerics.integration.status import Status
from undula.numerics.integration.step import (
    OPTIONS_SIZES,
    correct,
    integrate_rates,
    predict,
)
from undula.numerics.integration.step_size import (
    SAFETY,
    SHORTEST_FACTOR,
    accept,
    change_step,
    choose_frame,
    factor_for,
    frame_check_due,
    plan,
)
from undula.numerics.integration.stepper_state import (
    DISPLACEMENT,
    FAILED,
    IN_FRAME,
    LARGEST_STEP,
    MEMORY_SIZES,
    ORDER,
    PLANNED_FACTOR,
    PLANNED_ORDER,
    REJECTED,
    SHAPE_SPEED,
    SMALLEST_STEP,
    SPEED,
    STEP,
    STEPS,
    STORING_RATE,
    TIME,
    TURN_RATE,
    has_its_orders,
)
from undula.numerics.integration.system import RATES, belongs, generator, matrix_width, size
from undula.numerics.integration.workspace import workspace

_DONE, _PAUSED = Status.DONE.value, Status.PAUSED.value
_TOO_SHORT, _NOT_FINITE = Status.STEP_TOO_SHORT.value, Status.NOT_FINITE.value

#: A step that does not converge with a fresh matrix is made shorter by this factor.
FAILURE_FACTOR = 0.3
#: A state farther than this from the reference counts as infinite: squares must not overflow.
LARGEST_SIZE = 1e150
#: The shortest step, as a fraction of the time reached (round-off) and in absolute terms.
SHORTEST_RELATIVE, SHORTEST_ABSOLUTE = 1e-14, 1e-18


@kernel
def take_step(system: Any, memory: Any, options: Any, work: Any) -> Any:
    """Take one accepted step, as planned or shorter; return a `Status` value."""
    if options.frame == 1:
        choose_frame(system, memory)
    memory.count[ORDER] = memory.count[PLANNED_ORDER]
    change_step(memory, work, memory.real[PLANNED_FACTOR])
    while True:
        shortest = SHORTEST_ABSOLUTE + SHORTEST_RELATIVE * abs(memory.real[TIME])
        if not memory.real[STEP] >= shortest:
            return _TOO_SHORT
        c, scale = predict(system, memory, options, work)
        if not scale <= options.atol + options.rtol * LARGEST_SIZE:
            return _NOT_FINITE
        if not correct(system, memory, options, work, c, scale):
            memory.count[FAILED] += 1
            change_step(memory, work, FAILURE_FACTOR)
            continue
        integrate_rates(system, work, c)
        error = step_error(system, memory, options, work) / scale
        if error <= 1.0:
            break
        memory.count[REJECTED] += 1
        factor = SHORTEST_FACTOR
        if np.isfinite(error):
            factor = max(factor, SAFETY * factor_for(error, memory.count[ORDER]))
        change_step(memory, work, factor)
    accept(memory, work)
    memory.real[TIME] += memory.real[STEP]
    memory.count[STEPS] += 1
    memory.real[SMALLEST_STEP] = min(memory.real[SMALLEST_STEP], memory.real[STEP])
    memory.real[LARGEST_STEP] = max(memory.real[LARGEST_STEP], memory.real[STEP])
    plan(system, memory, options, error, scale)
    return _DONE


@kernel
def step_error(system: Any, memory: Any, options: Any, work: Any) -> Any:
    """Return the estimated error of the step's positions, in the frame with that of its angle."""
    n = work.y.shape[0]
    error = size(system, work.change, options.mask)
    if memory.count[IN_FRAME] == 1:
        lever = size(system, work.turning, options.mask)
        error = math.hypot(error, lever * work.change[n])
    return error * options.error[memory.count[ORDER]]


@kernel
def note_rates(memory: Any, options: Any, work: Any) -> None:
    """Note how fast the system turns and stores energy after a step."""
    n, c = work.y.shape[0], memory.real[STEP] / options.alpha[memory.count[ORDER]]
    memory.real[TURN_RATE] = (work.change[n] + work.psi[n]) / c
    stored = work.change[n + 1] - work.change[n + 2] + work.psi[n + 1] - work.psi[n + 2]
    memory.real[STORING_RATE] = stored / c


@kernel
def note_speeds(system: Any, memory: Any, options: Any, work: Any) -> None:
    """Note how fast the system moves and changes shape, and how far it is out, after a step."""
    n, c = work.y.shape[0], memory.real[STEP] / options.alpha[memory.count[ORDER]]
    turn = c * memory.real[TURN_RATE]
    generator(system, work.y, work.turning)
    memory.real[SPEED] = size(system, work.w, options.mask) / c
    for i in range(n):
        work.turning[i] = work.w[i] - turn * work.turning[i]
        work.correction[i] = work.y[i] - options.reference[i]
    memory.real[SHAPE_SPEED] = size(system, work.turning, options.mask) / c
    memory.real[DISPLACEMENT] = size(system, work.correction, options.mask)


@entry(
    f"{MEMORY_SIZES}, {OPTIONS_SIZES}, times (t), states (t, n + {RATES}),"
    f" sections (s, 1 + n + {RATES})",
    where=lambda system, memory, n, b: (
        belongs(system, n) and b == matrix_width(system) and has_its_orders(memory)
    ),
)
def advance(
    system: Any, memory: Any, options: Any, times: Any, states: Any, sections: Any, most_steps: Any
) -> Any:
    """Step on until the states at all `times` are known.

    Parameters
    ----------
    system, memory, options
        See `undula.numerics.integration.system`, `memory` and `stepping`; the memory is changed in
        place.
    times : ndarray, shape (m,)
        Increasing times, none before the last step of the memory.
    states : ndarray, shape (m, n + RATES)
        Receives unknowns (in the lab frame) and integrals at these times.
    sections : ndarray, shape (s, 1 + n + RATES)
        Receives time and state whenever the stored energy passes a maximum; the loop comes back
        when it is full.
    most_steps : int
        The loop comes back after so many steps.

    Returns
    -------
    status, filled, found : int
        A `Status` value, the number of times and of sections filled.
    """
    work = workspace(memory.factored_at.shape[0])
    told = step_on(
        borrowed(system),
        borrowed(memory),
        borrowed(options),
        borrowed(work),
        borrowed(times),
        borrowed(states),
        borrowed(sections),
        most_steps,
    )
    work.rates[0] = 0.0  # the scratch has to be there until here
    return told


@kernel
def step_on(
    system: Any,
    memory: Any,
    options: Any,
    work: Any,
    times: Any,
    states: Any,
    sections: Any,
    most_steps: Any,
) -> Any:
    """Step on, see `advance`, with scratch and everything else lent."""
    filled, found, taken = 0, 0, 0
    while True:
        while filled < times.shape[0] and times[filled] <= memory.real[TIME]:
            interpolate(system, memory, times[filled], states[filled])
            filled += 1
        done = filled == times.shape[0]
        paused = taken == most_steps or found == sections.shape[0] > 0
        if taken > 0 and (done or paused or frame_check_due(memory, options)):
            note_speeds(system, memory, options, work)
        if done:
            return _DONE, filled, found
        if paused:
            return _PAUSED, filled, found
        status = take_step(system, memory, options, work)
        if status != _DONE:
            return status, filled, found
        taken += 1
        storing = memory.real[STORING_RATE]
        note_rates(memory, options, work)
        if storing > 0.0 >= memory.real[STORING_RATE] and found < sections.shape[0]:
            sections[found, 0] = energy_maximum(memory)
            interpolate(system, memory, sections[found, 0], sections[found, 1:])
            found += 1
