"""The compiled time loop, which steps until the states at all requested times are known.

`advance` changes a `StepperState` in place. It returns when the requested times are filled, after a
number of steps (so that the caller can show progress or stop), when the array of sections is full,
or when no step succeeds. Another call continues as if the loop had not returned.
"""

import math
from typing import Any

import numpy as np

from undula.jit.borrowed import borrowed
from undula.jit.compilation import entry, kernel
from undula.numerics.integration.dense_output import energy_maximum, interpolate
from undula.numerics.integration.matrices import matrix_width
from undula.numerics.integration.status import Status
from undula.numerics.integration.step import (
    OPTIONS_SIZES,
    correct,
    integrate_rates,
    predict,
)
from undula.numerics.integration.step_size import (
    MIN_FACTOR,
    SAFETY,
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
    ORDER,
    PLANNED_FACTOR,
    PLANNED_ORDER,
    REJECTED,
    SHAPE_SPEED,
    SMALLEST_STEP,
    SPEED,
    STEP,
    STEPPER_SIZES,
    STEPS,
    STORING_RATE,
    TIME,
    TURN_RATE,
    orders_are_valid,
)
from undula.numerics.integration.system import RATES, error_norm, generator, sizes_match
from undula.numerics.integration.workspace import workspace

_DONE, _PAUSED = Status.DONE.value, Status.PAUSED.value
_TOO_SHORT, _NOT_FINITE = Status.STEP_TOO_SHORT.value, Status.NOT_FINITE.value

#: Factor of a step that does not converge with a fresh matrix.
FAILURE_FACTOR = 0.3
#: Distance from the reference beyond which a state counts as infinite, before squares overflow.
MAX_NORM = 1e150
#: Shortest step: as a fraction of the time (round-off), and absolute.
MIN_STEP_RELATIVE, MIN_STEP_ABSOLUTE = 1e-14, 1e-18


@kernel
def take_step(system: Any, stepper: Any, options: Any, work: Any) -> Any:
    """Take one accepted step, as planned or shorter; return a `Status` value."""
    if options.frame == 1:
        choose_frame(system, stepper)
    stepper.count[ORDER] = stepper.count[PLANNED_ORDER]
    change_step(stepper, work, stepper.real[PLANNED_FACTOR])
    while True:
        min_step = MIN_STEP_ABSOLUTE + MIN_STEP_RELATIVE * abs(stepper.real[TIME])
        if not stepper.real[STEP] >= min_step:
            return _TOO_SHORT
        c, scale = predict(system, stepper, options, work)
        if not scale <= options.atol + options.rtol * MAX_NORM:
            return _NOT_FINITE
        if not correct(system, stepper, options, work, c, scale):
            stepper.count[FAILED] += 1
            change_step(stepper, work, FAILURE_FACTOR)
            continue
        integrate_rates(system, work, c)
        error = step_error(system, stepper, options, work) / scale
        if error <= 1.0:
            break
        stepper.count[REJECTED] += 1
        factor = MIN_FACTOR
        if np.isfinite(error):
            factor = max(factor, SAFETY * factor_for(error, stepper.count[ORDER]))
        change_step(stepper, work, factor)
    accept(stepper, work)
    stepper.real[TIME] += stepper.real[STEP]
    stepper.count[STEPS] += 1
    stepper.real[SMALLEST_STEP] = min(stepper.real[SMALLEST_STEP], stepper.real[STEP])
    stepper.real[LARGEST_STEP] = max(stepper.real[LARGEST_STEP], stepper.real[STEP])
    plan(system, stepper, options, error, scale)
    return _DONE


@kernel
def step_error(system: Any, stepper: Any, options: Any, work: Any) -> Any:
    """Return the estimated error of positions; in the frame, that of the angle is included."""
    n = work.y.shape[0]
    error = error_norm(system, work.change, options.mask)
    if stepper.count[IN_FRAME] == 1:
        lever = error_norm(system, work.turning, options.mask)
        error = math.hypot(error, lever * work.change[n])
    return error * options.error[stepper.count[ORDER]]


@kernel
def record_rates(stepper: Any, options: Any, work: Any) -> None:
    """Store the rates of rotation and of energy storage after a step."""
    n, c = work.y.shape[0], stepper.real[STEP] / options.alpha[stepper.count[ORDER]]
    stepper.real[TURN_RATE] = (work.change[n] + work.psi[n]) / c
    stored = work.change[n + 1] - work.change[n + 2] + work.psi[n + 1] - work.psi[n + 2]
    stepper.real[STORING_RATE] = stored / c


@kernel
def record_speeds(system: Any, stepper: Any, options: Any, work: Any) -> None:
    """Store speed, speed of shape change and displacement after a step."""
    n, c = work.y.shape[0], stepper.real[STEP] / options.alpha[stepper.count[ORDER]]
    turn = c * stepper.real[TURN_RATE]
    generator(system, work.y, work.turning)
    stepper.real[SPEED] = error_norm(system, work.w, options.mask) / c
    for i in range(n):
        work.turning[i] = work.w[i] - turn * work.turning[i]
        work.correction[i] = work.y[i] - options.reference[i]
    stepper.real[SHAPE_SPEED] = error_norm(system, work.turning, options.mask) / c
    stepper.real[DISPLACEMENT] = error_norm(system, work.correction, options.mask)


@entry(
    f"{STEPPER_SIZES}, {OPTIONS_SIZES}, times (t), states (t, n + {RATES}),"
    f" sections (s, 1 + n + {RATES})",
    where=lambda system, stepper, n, b: (
        sizes_match(system, n) and b == matrix_width(system) and orders_are_valid(stepper)
    ),
)
def advance(
    system: Any, stepper: Any, options: Any, times: Any, states: Any, sections: Any, most_steps: Any
) -> Any:
    """Step until the states at all `times` are known.

    Parameters
    ----------
    system : NamedTuple
        The system, see `undula.numerics.integration.system`.
    stepper : StepperState
        Changed in place.
    options : Options
        Tolerances and tables of the scheme.
    times : ndarray, shape (m,)
        Increasing times, none before the start of the stepper's last step.
    states : ndarray, shape (m, n + RATES)
        Receives unknowns (in the lab frame) and integrals at these times.
    sections : ndarray, shape (s, 1 + n + RATES)
        Receives time and state at each maximum of the stored energy. The loop returns when it is
        full; with s = 0 no maxima are located.
    most_steps : int
        Number of steps after which the loop returns.

    Returns
    -------
    status, times_filled, sections_filled : int
        A `Status` value, the number of times and of sections filled.
    """
    work = workspace(stepper.factored_at.shape[0])
    outcome = step_on(
        borrowed(system),
        borrowed(stepper),
        borrowed(options),
        borrowed(work),
        borrowed(times),
        borrowed(states),
        borrowed(sections),
        most_steps,
    )
    work.rates[0] = 0.0  # keeps the scratch alive until here
    return outcome


@kernel
def step_on(
    system: Any,
    stepper: Any,
    options: Any,
    work: Any,
    times: Any,
    states: Any,
    sections: Any,
    most_steps: Any,
) -> Any:
    """Step as `advance` does, with borrowed scratch and arguments."""
    times_filled, sections_filled, steps_taken = 0, 0, 0
    while True:
        while times_filled < times.shape[0] and times[times_filled] <= stepper.real[TIME]:
            interpolate(system, stepper, times[times_filled], states[times_filled])
            times_filled += 1
        done = times_filled == times.shape[0]
        paused = steps_taken == most_steps or sections_filled == sections.shape[0] > 0
        if steps_taken > 0 and (done or paused or frame_check_due(stepper, options)):
            record_speeds(system, stepper, options, work)
        if done:
            return _DONE, times_filled, sections_filled
        if paused:
            return _PAUSED, times_filled, sections_filled
        status = take_step(system, stepper, options, work)
        if status != _DONE:
            return status, times_filled, sections_filled
        steps_taken += 1
        storing = stepper.real[STORING_RATE]
        record_rates(stepper, options, work)
        if storing > 0.0 >= stepper.real[STORING_RATE] and sections_filled < sections.shape[0]:
            sections[sections_filled, 0] = energy_maximum(stepper)
            interpolate(
                system, stepper, sections[sections_filled, 0], sections[sections_filled, 1:]
            )
            sections_filled += 1
