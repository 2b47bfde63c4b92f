"""One implicit step: predict, solve by a simplified Newton method, estimate the error.

Errors and corrections are measured in the system's own norm, `error_norm`, in units of

    scale = atol + rtol * error_norm(y - reference state).

The norm is invariant under rotation, and the scale gives a small motion the same relative accuracy
as a large one. The norm of a rod is that of tangents, not of positions, since errors of tangents
enter the energy and the lengths.

In the co-rotating frame positions are y = Q(-angle) x and the rate of rotation Omega is one more
unknown, fixed by the condition that the motion in the frame has no component along the rotation:

    R(y) (w + c Omega S y) = c f(y, z),    <S y, w> = 0,    w = c dy/dt.

The same formula integrates the angle, the active power and the dissipation.
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
    error_norm,
    generator,
    rates,
    residual,
)

#: Newton corrections of a step before its matrix is reassembled or its length reduced.
MAX_CORRECTIONS = 5
#: Growth of a correction from one iteration to the next beyond which the iteration diverges.
DIVERGENCE = 2.0
#: Error that a converged iteration may leave, as a fraction of the error allowed in a step.
NEWTON_FRACTION = 0.05
#: Factor a step by which a contraction rate grows that is used but not measured.
CONTRACTION_AGEING = 1.2
#: Largest violation of the constraints, in units of rtol.
CONSTRAINT_IN_RTOL = 2.0
#: Smallest factor by which a stored contraction rate falls in one iteration.
CONTRACTION_DECAY = 0.3


class Options(NamedTuple):
    """Options of a stepper: tolerances, norm, frame, and the tables of its scheme.

    Attributes
    ----------
    rtol, atol : float
        Tolerances of the error of a step, see the module.
    mask : ndarray, shape (n,)
        1 for positions, 0 for multipliers.
    reference : ndarray, shape (n,)
        The state from which displacements are measured.
    stale_after : float
        Displacement of a position since assembly beyond which a matrix is stale.
    longest_step : float
        Upper limit of the step.
    frame : {0, 1}
        0 for the lab frame, 1 for the co-rotating frame whenever it allows longer steps.
    gamma, alpha, error : ndarray, shape (max order + 2,)
        Tables of the scheme, see `undula.numerics.integration.schemes`.
    """

    rtol: float
    atol: float
    mask: np.ndarray
    reference: np.ndarray
    stale_after: float
    longest_step: float
    frame: int
    gamma: np.ndarray
    alpha: np.ndarray
    error: np.ndarray


#: Shapes of the options, next to `STEPPER_SIZES` in a declaration, see `undula.jit.sizes`.
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
    """Return the options of a stepper.

    Parameters
    ----------
    scheme : BackwardDifferentiation
        The family of formulas.
    mask, reference : ndarray, shape (n,)
        As in `Options`.
    rtol, atol, stale_after, longest_step : float
        As in `Options`.
    frame : bool
        True if steps may use the co-rotating frame.

    Returns
    -------
    Options
        The record for compiled code.
    """
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
def predict(system: Any, stepper: Any, options: Any, work: Any) -> Any:
    """Extrapolate to the end of the step; return the parameter c and the scale of errors."""
    order, n = stepper.count[ORDER], work.y.shape[0]
    differences = stepper.differences
    inverse = 1.0 / options.alpha[order]
    first = options.gamma[1] * inverse
    for i in range(differences.shape[1]):
        work.predicted[i] = differences[0, i] + differences[1, i]
    for i in range(differences.shape[1]):  # loops over both arrays would not be vectorised
        work.psi[i] = first * differences[1, i]
    for j in range(2, order, 2):  # two differences at a time, as memory access limits the speed
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
    scale = options.atol + options.rtol * error_norm(system, work.w, options.mask)
    return stepper.real[STEP] * inverse, scale


@kernel
def update_iterate(system: Any, work: Any, in_frame: Any, turn: Any) -> None:
    """Update y, w and S y from the present change and the rotation c Omega of the step."""
    n = work.y.shape[0]
    for i in range(n):
        work.y[i] = work.predicted[i] + work.change[i]
        work.w[i] = work.change[i] + work.psi[i]
    if in_frame:
        generator(system, work.y, work.turning)
        for i in range(n):
            work.w[i] += turn * work.turning[i]


@kernel
def newton_correction(system: Any, stepper: Any, options: Any, work: Any, c: Any, turn: Any) -> Any:
    """Apply one Newton correction; return its norm, rotation included, and the new c Omega."""
    n = work.y.shape[0]
    in_frame = stepper.count[IN_FRAME] == 1
    delta, rotation_change = work.correction, 0.0
    residual(system, work.y, work.w, c, delta)
    solve_frozen(system, stepper, work, delta)
    if in_frame:
        phase_residual = dot(work.phase, work.y, options.mask) - dot(
            work.phase, delta, options.mask
        )
        turn_change = phase_residual / dot(work.phase, stepper.border, options.mask)
        turn += turn_change
        rotation_change = turn_change * error_norm(system, work.turning, options.mask)
        for i in range(n):
            delta[i] += turn_change * stepper.border[i]
    for i in range(n):
        work.change[i] -= delta[i]
    return math.hypot(error_norm(system, delta, options.mask), rotation_change), turn


@kernel
def correct(system: Any, stepper: Any, options: Any, work: Any, c: Any, scale: Any) -> Any:
    """Solve for the end of the step; return whether the iteration converged."""
    in_frame = stepper.count[IN_FRAME] == 1
    n = work.y.shape[0]
    if in_frame:
        for i in range(n):
            work.y[i] = work.predicted[i] - work.psi[i]
        generator(system, work.y, work.phase)
    for attempt in range(2):
        for i in range(work.change.shape[0]):
            work.change[i] = 0.0
        turn = work.psi[n] if in_frame else 0.0  # extrapolated from past steps
        update_iterate(system, work, in_frame, turn)
        fresh = attempt == 1 or is_stale(system, stepper, options, work, c)
        if fresh and not reassemble(system, stepper, work, c, scale, turn):
            break
        if iterate(system, stepper, options, work, c, scale, turn):
            return True
        stepper.real[CONTRACTION] = 1.0
        if fresh:
            break
    return False


@kernel
def iterate(
    system: Any, stepper: Any, options: Any, work: Any, c: Any, scale: Any, turn: Any
) -> Any:
    """Correct with one factored matrix until the error is negligible; False on failure."""
    in_frame = stepper.count[IN_FRAME] == 1
    allowed = CONSTRAINT_IN_RTOL * options.rtol
    previous = 0.0
    for m in range(MAX_CORRECTIONS):
        correction_norm, turn = newton_correction(system, stepper, options, work, c, turn)
        if not np.isfinite(correction_norm) or (m > 0 and correction_norm > DIVERGENCE * previous):
            return False
        if m > 0 and previous > 0.0:
            decayed = CONTRACTION_DECAY * stepper.real[CONTRACTION]
            stepper.real[CONTRACTION] = max(decayed, correction_norm / previous)
        previous = correction_norm
        update_iterate(system, work, in_frame, turn)
        remaining_error = correction_norm * min(1.0, stepper.real[CONTRACTION])
        if (
            remaining_error <= NEWTON_FRACTION * scale
            and constraint_error(system, work.y) <= allowed
        ):
            if m == 0:
                stepper.real[CONTRACTION] = min(1.0, CONTRACTION_AGEING * stepper.real[CONTRACTION])
            return True
    return False


@kernel
def integrate_rates(system: Any, work: Any, c: Any) -> None:
    """Advance the angle and the integrals of power by the formula of the positions."""
    n, inverse = work.y.shape[0], 1.0 / c
    for i in range(n):
        work.correction[i] = work.w[i] * inverse
    rates(system, work.y, work.correction, work.rates)
    for i in range(RATES):
        work.change[n + i] = c * work.rates[i] - work.psi[n + i]
