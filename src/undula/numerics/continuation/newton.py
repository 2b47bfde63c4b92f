"""Damped Newton's method for a problem r(u; p) = 0 at a fixed parameter.

Steps are measured in the problem's own norm, in which a change of 1 is large; longer steps are
shortened to 1. A step that increases the residual is halved until it does not. Steps in the region
of quadratic convergence are not damped, as the residual may be round-off there.
"""

import math
from dataclasses import dataclass
from enum import Enum

import numpy as np

from undula.arrays import Array
from undula.numerics.continuation.problem import Evaluation, Problem

_MAX_ITERATIONS, _MAX_HALVINGS = 30, 6
# Norm of a step after which quadratic convergence leaves round-off, and norm of a step below which
# convergence is quadratic, so that the residual is not compared.
_SMALL_STEP, _LOCAL_STEP = 1e-9, 1e-4


class Convergence(Enum):
    """Outcome of Newton's method; the value states the cure."""

    CONVERGED = "a solution was found"
    NOT_CONVERGED = "steps did not become small; begin nearer to a solution"
    STALLED = "no step made the residual smaller; begin nearer to a solution"
    SINGULAR = "the linearised problem has no unique solution; begin elsewhere"
    NOT_FINITE = "the problem has no value where the method began; begin elsewhere"


@dataclass(frozen=True)
class Solution:
    """Result of Newton's method.

    Attributes
    ----------
    outcome : Convergence
        CONVERGED, or the reason of the failure.
    u : ndarray of shape (m,)
        The solution, or the last iterate.
    steps : tuple of float
        Norms of all steps.
    residual : float
        Euclidean norm of the residual at u.
    """

    outcome: Convergence
    u: Array
    steps: tuple[float, ...]
    residual: float

    @property
    def has_converged(self) -> bool:
        """True if u is a solution."""
        return self.outcome is Convergence.CONVERGED


def newton(problem: Problem, u: Array, p: float) -> Solution:
    """Solve r(u; p) = 0 for u at a fixed parameter.

    Parameters
    ----------
    problem : Problem
        A residual that is not finite means that the problem is undefined there.
    u : ndarray of shape (m,)
        The guess.
    p : float
        The parameter.

    Returns
    -------
    Solution
        Failure is an outcome, not an exception.
    """
    evaluation, steps = problem.evaluate(u, p), list[float]()
    if not np.isfinite(evaluation.residual).all():
        return Solution(Convergence.NOT_FINITE, u, (), _norm(evaluation))
    for _ in range(_MAX_ITERATIONS):
        step = _full_step(evaluation)
        if step is None:
            return Solution(Convergence.SINGULAR, u, tuple(steps), _norm(evaluation))
        norm = math.sqrt(problem.weights @ step**2)
        damping = 1.0 / max(1.0, norm)
        for _ in range(_MAX_HALVINGS):
            trial = problem.evaluate(u + damping * step, p)
            local = norm <= _LOCAL_STEP and bool(np.isfinite(trial.residual).all())
            if local or _norm(trial) <= _norm(evaluation):
                break
            damping *= 0.5
        else:
            return Solution(Convergence.STALLED, u, tuple(steps), _norm(evaluation))
        u, evaluation = u + damping * step, trial
        steps.append(damping * norm)
        if damping == 1.0 and norm <= _SMALL_STEP:
            return Solution(Convergence.CONVERGED, u, tuple(steps), _norm(evaluation))
    return Solution(Convergence.NOT_CONVERGED, u, tuple(steps), _norm(evaluation))


def _full_step(evaluation: Evaluation) -> Array | None:
    """Return the step to the zero of the linearised problem; None if that is singular."""
    zeros = np.zeros(evaluation.residual.size)
    try:
        step, _ = evaluation.linear.solve(zeros, zeros, 1.0, -evaluation.residual, 0.0)
    except np.linalg.LinAlgError:
        return None
    return step if np.isfinite(step).all() else None


def _norm(evaluation: Evaluation) -> float:
    return math.sqrt(evaluation.residual @ evaluation.residual)
