"""One implicit step: predict, solve by a simplified Newton method, estimate the error.

Errors and corrections are measured by the system's own norm, `size`, in units of

    scale = atol + rtol * size(distance from the reference state).

It does not change when the system turns, and a small motion is computed as accurately as a large
one. A rod measures tangents, not positions: their errors are what the energy and the lengths feel.

In the co-rotating frame positions are y = Q(-angle) x and the turning rate Omega is one more
unknown, fixed by the condition that the motion in the frame has no component along the rotation:

    R(y) (w + c Omega S y) = c f(y, z),    <S y, w> = 0,    w = c dy/dt.

The angle is integrated beside, like the power put in and the power dissipated, by the same formula.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from undula.jit.compilation import kernel
from undula.numerics.integration.newton_matrix import is_stale, reassemble, solve_frozen
from undula.numerics.integration.schemes import BackwardDifferentiation
from undula.numerics.integration.stepper_state import CONTRACTION, IN_FRAME, ORDER, STEP
from undula.numerics.integration.system import (
    RATES,
    constraint_error,
    generator,
    rates,
    residual,
    size,
)

#: Corrections a step may take before its matrix is made anew or its length is cut.
MOST_CORRECTIONS = 5
#: A correction that grows by this factor diverges.
DIVERGENCE = 2.0
#: What a converging iteration may leave, as a fraction of the error allowed in a step.
NEWTON_FRACTION = 0.05
#: A contraction that is used unmeasured grows by this factor a step.
CONTRACTION_AGEING = 1.2
#: Constraints are met to this many rtol.
CONSTRAINT_IN_RTOL = 2.0
#: The remembered contraction is forgotten at most this fast.
CONTRACTION_MEMORY = 0.3


class Options(NamedTuple):
    """What a stepper is told: tolerances, the norm, and the tables of its scheme."""

    rtol: float
    atol: float
    mask: np.ndarray  # (n,) 1 for positions, 0 for multipliers
    reference: np.ndarray  # (n,) the state that displacements are measured from
    stale_after: float  # a matrix is stale when a position has moved so far since
    longest_step: float
    frame: int  # 0 lab, 1 co-rotating when it pays
    gamma: np.ndarray
    alpha: np.ndarray
    error: np.ndarray


#: What options have to be beside the memory that they go with, see `undula.jit.sizes`.
OPTIONS_SIZES = (
    "options.mask (n), options.reference (n), options.gamma (r - 1), options.alpha (r - 1),"
    " options.error (r - 1)"
)


def options(
    scheme: BackwardDifferentiation,
    mask: np.ndarray,
    reference: np.ndarray,
    *,
    rtol: float,
    atol: float,
    stale_after: float,
    longest_step: float,
    frame: bool,
) -> Options:
    """Gather the options of a stepper of `scheme`."""
    gamma, alpha, error = scheme.tables
    return Options(
        rtol, atol, mask, reference, stale_after, longest_step, int(frame), gamma, alpha, error
    )


@kernel
def dot(a: Any, b: Any, mask: Any) -> Any:
    """Return the scalar product of a and b over the positions."""
    total = 0.0
    for i in range(mask.shape[0]):
        total += mask[i] * a[i] * b[i]
    return total


@kernel
def predict(system: Any, memory: Any, options: Any, work: Any) -> Any:
    """Extrapolate to the end of the step; return its parameter c and the scale of its errors."""
    order, n = memory.count[ORDER], work.y.shape[0]
    differences = memory.differences
    inverse = 1.0 / options.alpha[order]
    first = options.gamma[1] * inverse
    for i in range(differences.shape[1]):
        work.predicted[i] = differences[0, i] + differences[1, i]
    for i in range(differences.shape[1]):  # loops over both arrays would not be vectorised
        work.psi[i] = first * differences[1, i]
    for j in range(2, order, 2):  # two differences at a time: memory is what it waits for
        factor, next_factor = options.gamma[j] * inverse, options.gamma[j + 1] * inverse
        for i in range(differences.shape[1]):
            work.predicted[i] += differences[j, i] + differences[j + 1, i]
        for i in range(differences.shape[1]):
            work.psi[i] += factor * differences[j, i] + next_factor * differences[j + 1, i]
    if order % 2 == 0:
        factor = options.gamma[order] * inverse
        for i in range(differences.shape[1]):
            work.predicted[i] += differences[order, i]
        for i in range(differences.shape[1]):
            work.psi[i] += factor * differences[order, i]
    for i in range(n):
        work.y[i] = work.predicted[i]
        work.w[i] = work.y[i] - options.reference[i]
    scale = options.atol + options.rtol * size(system, work.w, options.mask)
    return memory.real[STEP] * inverse, scale


@kernel
def update_iterate(system: Any, work: Any, in_frame: Any, turn: Any) -> None:
    """Bring y, w and S y up to date with the change found so far and the turn c Omega."""
    n = work.y.shape[0]
    for i in range(n):
        work.y[i] = work.predicted[i] + work.change[i]
        work.w[i] = work.change[i] + work.psi[i]
    if in_frame:
        generator(system, work.y, work.turning)
        for i in range(n):
            work.w[i] += turn * work.turning[i]


@kernel
def one_correction(system: Any, memory: Any, options: Any, work: Any, c: Any, turn: Any) -> Any:
    """Apply one Newton correction; return its size, that of the turn included, and the new turn."""
    n = work.y.shape[0]
    in_frame = memory.count[IN_FRAME] == 1
    delta, rotation_change = work.correction, 0.0
    residual(system, work.y, work.w, c, delta)
    solve_frozen(system, memory, work, delta)
    if in_frame:
        phase_residual = dot(work.phase, work.y, options.mask) - dot(
            work.phase, delta, options.mask
        )
        turn_change = phase_residual / dot(work.phase, memory.border, options.mask)
        turn += turn_change
        rotation_change = turn_change * size(system, work.turning, options.mask)
        for i in range(n):
            delta[i] += turn_change * memory.border[i]
    for i in range(n):
        work.change[i] -= delta[i]
    return math.hypot(size(system, delta, options.mask), rotation_change), turn


@kernel
def correct(system: Any, memory: Any, options: Any, work: Any, c: Any, scale: Any) -> Any:
    """Solve for the end of the step; return whether it converged, and the turn c Omega."""
    in_frame = memory.count[IN_FRAME] == 1
    n = work.y.shape[0]
    if in_frame:
        for i in range(n):
            work.y[i] = work.predicted[i] - work.psi[i]
        generator(system, work.y, work.phase)
    for attempt in range(2):
        for i in range(work.change.shape[0]):
            work.change[i] = 0.0
        turn = work.psi[n] if in_frame else 0.0  # extrapolates the rate
        update_iterate(system, work, in_frame, turn)
        fresh = attempt == 1 or is_stale(system, memory, options, work, c)
        if fresh and not reassemble(system, memory, work, c, scale, turn):
            break
        if iterate(system, memory, options, work, c, scale, turn):
            return True
        memory.real[CONTRACTION] = 1.0
        if fresh:
            break
    return False


@kernel
def iterate(
    system: Any, memory: Any, options: Any, work: Any, c: Any, scale: Any, turn: Any
) -> Any:
    """Correct with one factored matrix until the rest is negligible; False where it is not."""
    in_frame = memory.count[IN_FRAME] == 1
    allowed = CONSTRAINT_IN_RTOL * options.rtol
    previous = 0.0
    for m in range(MOST_CORRECTIONS):
        found, turn = one_correction(system, memory, options, work, c, turn)
        if not np.isfinite(found) or (m > 0 and found > DIVERGENCE * previous):
            return False
        if m > 0 and previous > 0.0:
            remembered = CONTRACTION_MEMORY * memory.real[CONTRACTION]
            memory.real[CONTRACTION] = max(remembered, found / previous)
        previous = found
        update_iterate(system, work, in_frame, turn)
        left = found * min(1.0, memory.real[CONTRACTION])
        if left <= NEWTON_FRACTION * scale and constraint_error(system, work.y) <= allowed:
            if m == 0:
                memory.real[CONTRACTION] = min(1.0, CONTRACTION_AGEING * memory.real[CONTRACTION])
            return True
    return False


@kernel
def integrate_rates(system: Any, work: Any, c: Any) -> None:
    """Advance the angle and the integrals of power by the formula that moved the positions."""
    n, inverse = work.y.shape[0], 1.0 / c
    for i in range(n):
        work.correction[i] = work.w[i] * inverse
    rates(system, work.y, work.correction, work.rates)
    for i in range(RATES):
        work.change[n + i] = c * work.rates[i] - work.psi[n + i]
