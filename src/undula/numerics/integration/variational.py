"""Small changes of a trajectory, carried along with it: the variational equations, step by step.

Predictions, and changes of step and order, are linear in the backward differences. The end of a
step solves residual(y, w, c) = 0 with y = predicted + d and w = d + psi, so that a small change of
the past changes it by the solution of

    J dy = R(x) (dpredicted - dpsi),    J = d residual / dy  with dw = dy.

These are exact derivatives of the discrete trajectory, not a discretisation of the derivative's
equations. The frame has to be the lab's.

Source: internal differentiation, Bock (1981); for Lyapunov exponents Benettin et al. (1980).
"""

from typing import Any

import numpy as np

from undula.jit.compilation import entry, kernel
from undula.numerics.integration.status import Status
from undula.numerics.integration.step import OPTIONS_SIZES
from undula.numerics.integration.step_size import rescale
from undula.numerics.integration.stepper_state import (
    MEMORY_SIZES,
    ORDER,
    STEP,
    TIME,
    has_its_orders,
)
from undula.numerics.integration.system import (
    apply_drag,
    belongs,
    derivative,
    derivative_width,
    factor_derivative,
    matrix_width,
    solve_derivative,
)
from undula.numerics.integration.time_loop import take_step
from undula.numerics.integration.workspace import workspace

_DONE, _PAUSED = Status.DONE.value, Status.PAUSED.value
_NOT_FINITE = Status.NOT_FINITE.value


@kernel
def update_differences(memory: Any, difference: Any, found: Any) -> None:
    """Take a change (n,) of the end of a step into its backward differences (rows, n)."""
    order = memory.count[ORDER]
    for i in range(found.shape[0]):
        difference[order + 2, i] = found[i] - difference[order + 1, i]
        difference[order + 1, i] = found[i]
    for j in range(order, -1, -1):
        for i in range(found.shape[0]):
            difference[j, i] += difference[j + 1, i]


@kernel
def carry(
    system: Any, memory: Any, options: Any, work: Any, difference: Any, band: Any, scratch: Any
) -> None:
    """Carry one small change through the step that was just taken."""
    order, n = memory.count[ORDER], difference.shape[1]
    predicted, found = scratch[0], scratch[1]
    for i in range(n):
        predicted[i], past = difference[0, i], 0.0
        for j in range(1, order + 1):
            predicted[i] += difference[j, i]
            past += options.gamma[j] * difference[j, i]
        scratch[2, i] = predicted[i] - past / options.alpha[order]
    apply_drag(system, work.y, scratch[2], found)
    solve_derivative(system, band, found)
    for i in range(n):
        found[i] -= predicted[i]
    update_differences(memory, difference, found)


@entry(
    f"{MEMORY_SIZES}, {OPTIONS_SIZES}, changes (c, r, n), band (n, d)",
    where=lambda system, memory, n, b, d: (
        belongs(system, n)
        and b == matrix_width(system)
        and d == derivative_width(system)
        and has_its_orders(memory)
    ),
)
def advance_with_changes(
    system: Any, memory: Any, options: Any, changes: Any, band: Any, end: Any, most_steps: Any
) -> Any:
    """Step on until `end` is reached or passed, and carry small changes along.

    Parameters
    ----------
    system, memory, options
        As for `undula.numerics.integration.time_loop.advance`, with options.frame = 0.
    changes : ndarray, shape (k, max order + 3, n)
        Backward differences of k small changes, changed in place; the first row is the change.
    band : ndarray, shape (n, 2 b + 1)
        Scratch for the derivative, b its half-bandwidth.
    end : float
    most_steps : int
        The loop comes back after so many steps.

    Returns
    -------
    status : int
        A `Status` value.
    """
    n = memory.factored_at.shape[0]
    work, scratch, taken = workspace(n), np.zeros((3, n)), 0
    while memory.real[TIME] < end:
        if taken == most_steps:
            return _PAUSED
        before = memory.real[STEP]
        status = take_step(system, memory, options, work)
        if status != _DONE:
            return status
        taken += 1
        order, ratio = memory.count[ORDER], memory.real[STEP] / before
        c = memory.real[STEP] / options.alpha[order]
        derivative(system, work.y, work.w, c, 0.0, band)
        if not factor_derivative(system, band):
            return _NOT_FINITE
        for k in range(changes.shape[0]):
            if ratio != 1.0:
                rescale(changes[k], order, ratio, work.series)
            carry(system, memory, options, work, changes[k], band, scratch)
    return _DONE
