"""Newton's method for a problem r(u; p) = 0 at a fixed parameter, damped where it has to be.

Steps are measured in the problem's own norm, in which a change of 1 is large: longer ones are cut
to it. A step that makes the residual grow is halved until it does not; steps in the region of
quadratic convergence are left alone, as the residual may be nothing but round-off there.
"""

import math
from dataclasses import dataclass
from enum import Enum

import numpy as np

from undula.arrays import Array
from undula.numerics.continuation.problem import Evaluation, Problem

_MOST_ITERATIONS, _MOST_HALVINGS = 30, 6
# After a step of this size quadratic convergence leaves round-off; a step of this size is part of
# that convergence, whatever the residual says.
_SMALL_STEP, _LOCAL_STEP = 1e-9, 1e-4


class Convergence(Enum):
    """How Newton's method ended; the value says what to do."""

    CONVERGED = "a solution was found"
    NOT_CONVERGED = "steps did not become small; begin nearer to a solution"
    STALLED = "no step made the residual smaller; begin nearer to a solution"
    SINGULAR = "the linearised problem has no unique solution; begin elsewhere"
    NOT_FINITE = "the problem has no value where the method began; begin elsewhere"


@dataclass(frozen=True)
class Solution:
    """What Newton's method found.

    Attributes
    ----------
    outcome : Convergence
    u : ndarray of shape (m,)
        The solution, or the last point reached.
    steps : tuple of float
        Sizes of all steps in the problem's norm.
    residual : float
        Euclidean norm of the residual at u.
    """

    outcome: Convergence
    u: Array
    steps: tuple[float, ...]
    residual: float

    @property
    def converged(self) -> bool:
        """Whether it is a solution."""
        return self.outcome is Convergence.CONVERGED


def newton(problem: Problem, u: Array, p: float) -> Solution:
    """Solve r(u; p) = 0 for u, from a guess (m,), at a fixed parameter.

    A residual that is not finite means that the problem has no value there. Failure is an outcome,
    not an exception.
    """
    at, steps = problem.evaluate(u, p), list[float]()
    if not np.isfinite(at.residual).all():
        return Solution(Convergence.NOT_FINITE, u, (), _norm(at))
    for _ in range(_MOST_ITERATIONS):
        step = _full_step(at)
        if step is None:
            return Solution(Convergence.SINGULAR, u, tuple(steps), _norm(at))
        size = math.sqrt(problem.weights @ step**2)
        part = 1.0 / max(1.0, size)
        for _ in range(_MOST_HALVINGS):
            tried = problem.evaluate(u + part * step, p)
            local = size <= _LOCAL_STEP and bool(np.isfinite(tried.residual).all())
            if local or _norm(tried) <= _norm(at):
                break
            part *= 0.5
        else:
            return Solution(Convergence.STALLED, u, tuple(steps), _norm(at))
        u, at = u + part * step, tried
        steps.append(part * size)
        if part == 1.0 and size <= _SMALL_STEP:
            return Solution(Convergence.CONVERGED, u, tuple(steps), _norm(at))
    return Solution(Convergence.NOT_CONVERGED, u, tuple(steps), _norm(at))


def _full_step(at: Evaluation) -> Array | None:
    """Return the step to the zero of the linearised problem; None if there is no such."""
    nothing = np.zeros(at.residual.size)
    try:
        step, _ = at.linear.solve(nothing, nothing, 1.0, -at.residual, 0.0)
    except np.linalg.LinAlgError:
        return None
    return step if np.isfinite(step).all() else None


def _norm(at: Evaluation) -> float:
    return math.sqrt(at.residual @ at.residual)
