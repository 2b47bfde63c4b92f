"""States between steps: the interpolating polynomial of the last step, and sections through it."""

from typing import Any

from undula.jit.compilation import kernel, overwrite
from undula.numerics.integration.stepper_state import IN_FRAME, ORDER, STEP, TIME
from undula.numerics.integration.system import rotate

#: Trials to find a section in a step; the error falls with a power of 1.4 at each.
TRIALS = 8


@kernel
def interpolate(system: Any, memory: Any, time: Any, out: Any) -> None:
    """Write the unknowns, in the lab frame, and the integrals at `time` to out (n + RATES,)."""
    step, n = memory.real[STEP], memory.factored_at.shape[0]
    overwrite(out, memory.differences[0])
    factor = 1.0
    for j in range(memory.count[ORDER]):
        factor *= (time - memory.real[TIME] + j * step) / (step * (j + 1))
        for i in range(out.shape[0]):
            out[i] += factor * memory.differences[j + 1, i]
    if memory.count[IN_FRAME] == 1:
        rotate(system, out[:n], out[n], out[:n])


@kernel
def storing_rate(memory: Any, time: Any) -> Any:
    """Return the rate of energy storage, power put in less power dissipated, at `time`."""
    step, n = memory.real[STEP], memory.factored_at.shape[0]
    factor, slope, total = 1.0, 0.0, 0.0
    for j in range(memory.count[ORDER]):
        position, span = time - memory.real[TIME] + j * step, step * (j + 1)
        slope = (slope * position + factor) / span
        factor *= position / span
        total += slope * (memory.differences[j + 1, n + 1] - memory.differences[j + 1, n + 2])
    return total


@kernel
def energy_maximum(memory: Any) -> Any:
    """Return the time within the last step at which the storing of energy turned to releasing.

    By the Illinois variant of false position: of the two ends, one that stays counts half.
    """
    early, late = memory.real[TIME] - memory.real[STEP], memory.real[TIME]
    rising, falling = storing_rate(memory, early), storing_rate(memory, late)
    if not rising > 0.0 >= falling:
        return late  # the polynomials of two steps differ: the turn is where they meet
    time, side = late, 0
    for _ in range(TRIALS):
        time = (early * falling - late * rising) / (falling - rising)
        storing = storing_rate(memory, time)
        if storing > 0.0:
            early, rising = time, storing
            falling *= 0.5 if side == 1 else 1.0
            side = 1
        else:
            late, falling = time, storing
            rising *= 0.5 if side == -1 else 1.0
            side = -1
    return time
