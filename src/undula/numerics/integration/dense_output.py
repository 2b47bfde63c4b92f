"""Dense output: the interpolating polynomial of the last step, and energy maxima in it."""

from typing import Any

from undula.jit.compilation import kernel, overwrite
from undula.numerics.integration.stepper_state import IN_FRAME, ORDER, STEP, TIME
from undula.numerics.integration.system import rotate

#: Iterations of false position for a maximum in a step, with an order of convergence of 1.4.
ITERATIONS = 8


@kernel
def interpolate(system: Any, stepper: Any, time: Any, out: Any) -> None:
    """Write the unknowns, in the lab frame, and the integrals at `time` to out (n + RATES,)."""
    step, n = stepper.real[STEP], stepper.factored_at.shape[0]
    overwrite(out, stepper.differences[0])
    factor = 1.0
    for j in range(stepper.count[ORDER]):
        factor *= (time - stepper.real[TIME] + j * step) / (step * (j + 1))
        for i in range(out.shape[0]):
            out[i] += factor * stepper.differences[j + 1, i]
    if stepper.count[IN_FRAME] == 1:
        rotate(system, out[:n], out[n], out[:n])


@kernel
def storing_rate(stepper: Any, time: Any) -> Any:
    """Return the rate of energy storage at `time`: active power less dissipation."""
    step, n = stepper.real[STEP], stepper.factored_at.shape[0]
    factor, slope, total = 1.0, 0.0, 0.0
    for j in range(stepper.count[ORDER]):
        position, span = time - stepper.real[TIME] + j * step, step * (j + 1)
        slope = (slope * position + factor) / span
        factor *= position / span
        total += slope * (stepper.differences[j + 1, n + 1] - stepper.differences[j + 1, n + 2])
    return total


@kernel
def energy_maximum(stepper: Any) -> Any:
    """Return the time of a maximum of the stored energy within the last step.

    The zero of the storing rate is computed by the Illinois variant of false position, in which the
    value at an end that stays is halved.
    """
    early, late = stepper.real[TIME] - stepper.real[STEP], stepper.real[TIME]
    rising, falling = storing_rate(stepper, early), storing_rate(stepper, late)
    if not rising > 0.0 >= falling:
        return late  # the polynomials of two steps differ: the maximum is where they meet
    time, side = late, 0
    for _ in range(ITERATIONS):
        time = (early * falling - late * rising) / (falling - rising)
        storing = storing_rate(stepper, time)
        if storing > 0.0:
            early, rising = time, storing
            falling *= 0.5 if side == 1 else 1.0
            side = 1
        else:
            late, falling = time, storing
            rising *= 0.5 if side == -1 else 1.0
            side = -1
    return time
