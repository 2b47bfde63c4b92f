"""The variational equations: small changes of a trajectory, propagated with each step.

Predictions, and changes of step and order, are linear in the backward differences. The end of a
step solves residual(y, w, c) = 0 with y = predicted + d and w = d + psi. A small change of the past
therefore changes y by the solution of

    J dy = R(x) (dpredicted - dpsi),    J = d residual / dy  with dw = dy.

These are exact derivatives of the discrete trajectory, not a discretisation of the variational
equations. They hold in the lab frame only.

Source: internal differentiation, Bock (1981); for Lyapunov exponents Benettin et al. (1980).
"""

from typing import Any

import numpy as np

from undula.jit.compilation import entry, kernel
from undula.numerics.integration.matrices import (
    derivative_width,
    factor_derivative,
    matrix_width,
    solve_derivative,
)
from undula.numerics.integration.status import Status
from undula.numerics.integration.step import OPTIONS_SIZES
from undula.numerics.integration.step_size import rescale
from undula.numerics.integration.stepper_state import (
    ORDER,
    STEP,
    STEPPER_SIZES,
    TIME,
    orders_are_valid,
)
from undula.numerics.integration.system import apply_drag, derivative, sizes_match
from undula.numerics.integration.time_loop import take_step
from undula.numerics.integration.workspace import workspace

_DONE, _PAUSED = Status.DONE.value, Status.PAUSED.value
_NOT_FINITE = Status.NOT_FINITE.value


@kernel
def update_differences(stepper: Any, differences: Any, change: Any) -> None:
    """Update backward differences (rows, n) after a step by the value less its prediction (n,)."""
    order = stepper.count[ORDER]
    for i in range(change.shape[0]):
        differences[order + 2, i] = change[i] - differences[order + 1, i]
        differences[order + 1, i] = change[i]
    for j in range(order, -1, -1):
        for i in range(change.shape[0]):
            differences[j, i] += differences[j + 1, i]


@kernel
def propagate(
    system: Any, stepper: Any, options: Any, work: Any, differences: Any, band: Any, scratch: Any
) -> None:
    """Propagate one small change, with backward differences (rows, n), through the last step."""
    order, n = stepper.count[ORDER], differences.shape[1]
    predicted, change = scratch[0], scratch[1]
    for i in range(n):
        predicted[i], past = differences[0, i], 0.0
        for j in range(1, order + 1):
            predicted[i] += differences[j, i]
            past += options.gamma[j] * differences[j, i]
        scratch[2, i] = predicted[i] - past / options.alpha[order]
    apply_drag(system, work.y, scratch[2], change)
    solve_derivative(system, band, change)
    for i in range(n):
        change[i] -= predicted[i]
    update_differences(stepper, differences, change)


@entry(
    f"{STEPPER_SIZES}, {OPTIONS_SIZES}, changes (c, r, n), band (n, d)",
    where=lambda system, stepper, n, b, d: (
        sizes_match(system, n)
        and b == matrix_width(system)
        and d == derivative_width(system)
        and orders_are_valid(stepper)
    ),
)
def advance_with_changes(
    system: Any, stepper: Any, options: Any, changes: Any, band: Any, end: Any, most_steps: Any
) -> Any:
    """Step until `end` is reached or passed, and propagate small changes.

    Parameters
    ----------
    system, stepper, options
        As for `undula.numerics.integration.time_loop.advance`, with options.frame = 0.
    changes : ndarray, shape (k, max order + 3, n)
        Backward differences of k small changes, updated in place; row 0 is the change itself.
    band : ndarray, shape (n, 2 b + 1)
        Scratch for the exact derivative, with its half-bandwidth b.
    end : float
        Time of the end.
    most_steps : int
        Number of steps after which the loop returns.

    Returns
    -------
    status : int
        A `Status` value.
    """
    n = stepper.factored_at.shape[0]
    work, scratch, steps_taken = workspace(n), np.zeros((3, n)), 0
    while stepper.real[TIME] < end:
        if steps_taken == most_steps:
            return _PAUSED
        before = stepper.real[STEP]
        status = take_step(system, stepper, options, work)
        if status != _DONE:
            return status
        steps_taken += 1
        order, ratio = stepper.count[ORDER], stepper.real[STEP] / before
        c = stepper.real[STEP] / options.alpha[order]
        derivative(system, work.y, work.w, c, 0.0, band)
        if not factor_derivative(system, band):
            return _NOT_FINITE
        for k in range(changes.shape[0]):
            if ratio != 1.0:
                rescale(changes[k], order, ratio, work.series)
            propagate(system, stepper, options, work, changes[k], band, scratch)
    return _DONE
