"""Pseudo-arclength continuation: a branch of solutions of r(u; p) = 0, through folds.

A point is predicted along the tangent and corrected by Newton's method in the plane across it,

    r(u, p) = 0,    <t_u, u - u_0> + t_p (p - p_0) / s^2 = ds,

with the problem's weights in the product and a scale s of the parameter. The step adapts to the
number of iterations and to the rotation of the tangent.

Source: Keller (1977), in Rabinowitz (ed.), Applications of Bifurcation Theory, 359.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from undula.arrays import Array
from undula.errors import InputError
from undula.numerics.continuation.problem import Evaluation, Problem

# Newton's method: norm of the last step, whose square is the error, and number of steps.
_STEP_TOLERANCE, _MAX_ITERATIONS = 1e-7, 12
# Norm of a step after the second that means divergence.
_DIVERGED_NORM = 10.0
# Iterations up to which the next step may grow, factor of growth, factor after a failure.
_FEW_ITERATIONS, _GROWTH, _SHRINKAGE = 4, 2.0, 0.4
# Cosine of the largest rotation of the tangent in one step, and least ratio of the step's length to
# the distance between the points.
_MIN_COSINE, _MIN_LENGTH_PER_DISTANCE = 0.5, 0.5


@dataclass(frozen=True)
class Point:
    """A solution on a branch with its unit tangent.

    Attributes
    ----------
    u : ndarray of shape (m,)
        The unknowns.
    p : float
        The parameter.
    tangent : ndarray of shape (m,)
        Derivative of u by the arclength.
    tangent_p : float
        Derivative of p by the arclength.
    iterations : int
        Number of Newton's iterations.
    """

    u: Array
    p: float
    tangent: Array
    tangent_p: float
    iterations: int = 0


@dataclass(frozen=True)
class Steps:
    """Lengths of the steps along a branch.

    Attributes
    ----------
    first, least, most : float
        Arclength of the first, the smallest and the largest step.
    scale : float
        Change of the parameter that counts as 1 in the arclength.
    """

    first: float = 0.1
    least: float = 1e-6
    most: float = 0.5
    scale: float = 1.0


def trace(
    problem: Problem, start: Point, steps: Steps, ends: tuple[float, float]
) -> Iterator[Point]:
    """Trace a branch from `start` until p reaches an end or the steps fail.

    Parameters
    ----------
    problem : Problem
        The equations.
    start : Point
        A solution; its tangent gives the direction.
    steps : Steps
        Lengths of the steps.
    ends : (float, float)
        Least and largest parameter; the last point lies on one of them, unless the steps fail.

    Yields
    ------
    Point
        The points after `start`, in order.
    """
    point, length = start, steps.first
    while length >= steps.least:
        predicted = point.p + length * point.tangent_p
        end = min(max(predicted, ends[0]), ends[1])
        at_end = predicted != end and point.p != end
        if at_end:
            reached = _point_at(problem, point, end, steps.scale)
        else:
            reached = advance(problem, point, length, steps.scale)
        # The corrector may pass an end that the predictor did not: a shorter step does not.
        if (
            reached is None
            or not _is_continuous(problem, steps.scale, point, reached, length)
            or not ends[0] <= reached.p <= ends[1]
        ):
            length *= _SHRINKAGE
            continue
        if reached.iterations <= _FEW_ITERATIONS:
            length = min(steps.most, _GROWTH * length)
        yield reached
        if at_end:
            return
        point, problem = reached, problem.with_reference(reached.u)


def _point_at(problem: Problem, point: Point, p: float, scale: float) -> Point | None:
    """Return the point of the branch at a parameter ahead; None if Newton's method fails."""
    length = (p - point.p) / point.tangent_p
    solved = solve_at(problem, point.u + length * point.tangent, p)
    evaluation = None if solved is None else _evaluate(problem, solved[0], p)
    if solved is None or evaluation is None:
        return None
    reached = replace(point, u=solved[0], p=p, iterations=solved[1])
    return _tangent_from(evaluation, problem, reached, scale)


# Newton's method detects its divergence by itself.
@np.errstate(over="ignore", invalid="ignore")
def advance(problem: Problem, point: Point, length: float, scale: float) -> Point | None:
    """Return the point of the branch at an arclength from a point.

    Parameters
    ----------
    problem : Problem
        The equations.
    point : Point
        A solution with its tangent.
    length : float
        The arclength, of either sign; the tangent keeps its direction.
    scale : float
        As in `Steps`.

    Returns
    -------
    Point or None
        None if Newton's method fails.
    """
    u, p = point.u + length * point.tangent, point.p + length * point.tangent_p
    row, corner = problem.weights * point.tangent, point.tangent_p / scale**2
    for iteration in range(1, _MAX_ITERATIONS + 1):
        evaluation = _evaluate(problem, u, p)
        if evaluation is None:
            return None
        excess = float(row @ (u - point.u)) + corner * (p - point.p) - length
        du, dp = _solve_bordered(
            evaluation, evaluation.by_parameter, row, corner, -evaluation.residual, -excess
        )
        u, p = u + du, p + dp
        norm = np.sqrt(problem.weights @ du**2 + (dp / scale) ** 2)
        if not np.isfinite(norm) or (iteration > 2 and norm > _DIVERGED_NORM):
            return None
        if norm < _STEP_TOLERANCE:
            reached = replace(point, u=u, p=p, iterations=iteration)
            return _tangent_from(evaluation, problem, reached, scale)
    return None


def with_tangent(problem: Problem, point: Point, scale: float) -> Point:
    """Return the point with its exact tangent, in the direction of its present tangent."""
    return _tangent_from(problem.evaluate(point.u, point.p), problem, point, scale)


def _tangent_from(evaluation: Evaluation, problem: Problem, point: Point, scale: float) -> Point:
    """Return the point with the tangent that follows from an evaluation at it or near it."""
    row, corner = problem.weights * point.tangent, point.tangent_p / scale**2
    zeros = np.zeros_like(point.u)
    du, dp = _solve_bordered(evaluation, evaluation.by_parameter, row, corner, zeros, 1.0)
    length = float(np.sqrt(problem.weights @ du**2 + (dp / scale) ** 2))
    return replace(point, tangent=du / length, tangent_p=dp / length)


@np.errstate(over="ignore", invalid="ignore")
def solve_at(problem: Problem, u: Array, p: float) -> tuple[Array, int] | None:
    """Solve for u at a fixed parameter, without damping.

    Parameters
    ----------
    problem : Problem
        The equations.
    u : ndarray of shape (m,)
        The guess.
    p : float
        The parameter.

    Returns
    -------
    (ndarray of shape (m,), int) or None
        The solution and the number of iterations; None if Newton's method fails.
    """
    zeros = np.zeros_like(u)
    for iteration in range(1, _MAX_ITERATIONS + 1):
        evaluation = _evaluate(problem, u, p)
        if evaluation is None:
            return None
        du, _ = _solve_bordered(evaluation, zeros, zeros, 1.0, -evaluation.residual, 0.0)
        u = u + du
        norm = np.sqrt(problem.weights @ du**2)
        if not np.isfinite(norm) or (iteration > 2 and norm > _DIVERGED_NORM):
            return None
        if norm < _STEP_TOLERANCE:
            return u, iteration
    return None


def _evaluate(problem: Problem, u: Array, p: float) -> Evaluation | None:
    """Return the problem at a point; None where it is undefined or singular."""
    try:
        return problem.evaluate(u, p)
    except (InputError, np.linalg.LinAlgError):
        return None


def _solve_bordered(
    evaluation: Evaluation, column: Array, row: Array, corner: float, right: Array, last: float
) -> tuple[Array, float]:
    """Return the solution of a bordered system; NaN where it is singular."""
    try:
        return evaluation.linear.solve(column, row, corner, right, last)
    except np.linalg.LinAlgError:
        return np.full_like(right, np.nan), np.nan


def _is_continuous(
    problem: Problem, scale: float, point: Point, reached: Point, length: float
) -> bool:
    """Return True if a point continues the branch: near, with a tangent of similar direction."""
    du, dp = reached.u - point.u, reached.p - point.p
    distance = np.sqrt(problem.weights @ du**2 + (dp / scale) ** 2)
    product = problem.weights @ (point.tangent * reached.tangent)
    cosine = product + point.tangent_p * reached.tangent_p / scale**2
    return bool(cosine >= _MIN_COSINE and _MIN_LENGTH_PER_DISTANCE * distance <= length)
