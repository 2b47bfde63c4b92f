"""Pseudo-arclength continuation: a branch of solutions of r(u; p) = 0, through folds.

A point is predicted along the tangent and corrected by Newton's method in the plane across it,

    r(u, p) = 0,    <t_u, u - u_0> + t_p (p - p_0) / s^2 = ds,

with the problem's weights in the product and a scale s of the parameter. The step adapts to the
number of iterations and to the turn of the tangent.

Source: Keller (1977), in Rabinowitz (ed.), Applications of Bifurcation Theory, 359.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import brentq

from undula.arrays import Array
from undula.errors import InputError
from undula.numerics.continuation.problem import Evaluation, Problem

# Newton's method: a step this small, relative to changes of order 1, leaves about its square; and
# how many steps it may take.
_SMALL, _MOST_ITERATIONS = 1e-7, 12
# A step that takes no more iterations than this may grow, and by how much; it shrinks on failure.
_EASY, _GROWTH, _SHRINKAGE = 4, 2.0, 0.4
# Cosine of the largest turn of the tangent in one step.
_STRAIGHT = 0.5
# How far beside a singular point another will do, in tolerances.
_BESIDE = (0.0, 1.0, -1.0, 100.0, -100.0)


@dataclass(frozen=True)
class Point:
    """A solution on a branch with its unit tangent.

    Attributes
    ----------
    u : ndarray of shape (m,)
    p : float
    tangent : ndarray of shape (m,)
        Derivative of u by the arclength.
    tangent_p : float
        Derivative of p by the arclength.
    iterations : int
        Newton's iterations that it took.
    """

    u: Array
    p: float
    tangent: Array
    tangent_p: float
    iterations: int = 0


@dataclass(frozen=True)
class Steps:
    """How a branch is stepped along.

    Attributes
    ----------
    first, least, most : float
        Arclength of the first, the smallest and the largest step.
    scale : float
        The change of the parameter that counts as 1.
    """

    first: float = 0.1
    least: float = 1e-6
    most: float = 0.5
    scale: float = 1.0


def follow(
    problem: Problem, start: Point, steps: Steps, ends: tuple[float, float]
) -> Iterator[Point]:
    """Yield the points of a branch after `start`, until p comes to an end or steps fail.

    Parameters
    ----------
    problem : Problem
    start : Point
        A solution; its tangent gives the direction.
    steps : Steps
    ends : (float, float)
        Least and largest parameter; the last point lies on one of them.
    """
    point, length = start, steps.first
    while length >= steps.least:
        ahead = point.p + length * point.tangent_p
        end = min(max(ahead, ends[0]), ends[1])
        at_end = ahead != end and point.p != end
        if at_end:
            reached = _point_at(problem, point, end, steps.scale)
        else:
            reached = advance(problem, point, length, steps.scale)
        # A point beyond an end by its bend: after a shorter step the end itself is solved for.
        if (
            reached is None
            or not _comes_next(problem, steps.scale, point, reached, length)
            or not ends[0] <= reached.p <= ends[1]
        ):
            length *= _SHRINKAGE
            continue
        if reached.iterations <= _EASY:
            length = min(steps.most, _GROWTH * length)
        yield reached
        if at_end:
            return
        point, problem = reached, problem.referred_to(reached.u)


def _point_at(problem: Problem, point: Point, p: float, scale: float) -> Point | None:
    """Return the point of the branch at a parameter ahead, None if Newton's method fails."""
    length = (p - point.p) / point.tangent_p
    solved = solved_at(problem, point.u + length * point.tangent, p)
    there = None if solved is None else _evaluated(problem, solved[0], p)
    if solved is None or there is None:
        return None
    reached = replace(point, u=solved[0], p=p, iterations=solved[1])
    return _tangent_from(there, problem, reached, scale)


# Newton's method notices for itself that it has lost its way.
@np.errstate(over="ignore", invalid="ignore")
def advance(problem: Problem, point: Point, length: float, scale: float) -> Point | None:
    """Return the point of the branch at an arclength from a point, None if Newton's method fails.

    The arclength may be negative; the tangent keeps its direction.
    """
    u, p = point.u + length * point.tangent, point.p + length * point.tangent_p
    row, corner = problem.weights * point.tangent, point.tangent_p / scale**2
    for iteration in range(1, _MOST_ITERATIONS + 1):
        there = _evaluated(problem, u, p)
        if there is None:
            return None
        ahead = float(row @ (u - point.u)) + corner * (p - point.p) - length
        du, dp = _answer(there, there.by_parameter, row, corner, -there.residual, -ahead)
        u, p = u + du, p + dp
        size = np.sqrt(problem.weights @ du**2 + (dp / scale) ** 2)
        if not np.isfinite(size) or (iteration > 2 and size > 10.0):
            return None
        if size < _SMALL:
            reached = replace(point, u=u, p=p, iterations=iteration)
            return _tangent_from(there, problem, reached, scale)
    return None


def with_tangent(problem: Problem, point: Point, scale: float) -> Point:
    """Return the point with its own tangent, in the direction of the one that it carries."""
    return _tangent_from(problem.evaluate(point.u, point.p), problem, point, scale)


def _tangent_from(there: Evaluation, problem: Problem, point: Point, scale: float) -> Point:
    """Return the point with the tangent of an evaluation there, or within a last step of it."""
    row, corner = problem.weights * point.tangent, point.tangent_p / scale**2
    nothing = np.zeros_like(point.u)
    du, dp = _answer(there, there.by_parameter, row, corner, nothing, 1.0)
    length = float(np.sqrt(problem.weights @ du**2 + (dp / scale) ** 2))
    return replace(point, tangent=du / length, tangent_p=dp / length)


@np.errstate(over="ignore", invalid="ignore")
def solved_at(problem: Problem, u: Array, p: float) -> tuple[Array, int] | None:
    """Return the solution near u at the parameter p with its iterations; None if there is none."""
    nothing = np.zeros_like(u)
    for iteration in range(1, _MOST_ITERATIONS + 1):
        there = _evaluated(problem, u, p)
        if there is None:
            return None
        du, _ = _answer(there, nothing, nothing, 1.0, -there.residual, 0.0)
        u = u + du
        size = np.sqrt(problem.weights @ du**2)
        if not np.isfinite(size) or (iteration > 2 and size > 10.0):
            return None
        if size < _SMALL:
            return u, iteration
    return None


def located(
    problem: Problem,
    before: Point,
    after: Point,
    test: Callable[[Point], float],
    scale: float,
    tolerance: float,
) -> Point | None:
    """Return the point between two neighbours at which a test function changes its sign, if any.

    Parameters
    ----------
    problem : Problem
    before, after : Point
        Neighbours on a branch, with values of the test of opposite sign.
    test : callable
        A continuous function of a point.
    scale : float
        As in `Steps`.
    tolerance : float
        Largest error of the parameter, in units of the scale.
    """
    whole = float((problem.weights * before.tangent) @ (after.u - before.u))
    whole += before.tangent_p * (after.p - before.p) / scale**2
    found: dict[float, Point] = {0.0: before, whole: after}
    # Each is asked for once: what round-off leaves of a value may differ from one time to the next.
    values: dict[float, float] = {}

    def value(length: float) -> float:
        if length not in found:
            # At a branch point the equations are singular: one beside it is as good.
            beside = (advance(problem, before, length + k * tolerance, scale) for k in _BESIDE)
            point = next(filter(None, beside), None)
            if point is None:
                raise ArithmeticError
            found[length] = point
        if length not in values:
            values[length] = test(found[length])
        if np.isnan(values[length]):
            raise ArithmeticError
        return values[length]

    try:
        if value(0.0) * value(whole) > 0.0:
            return None
        at = brentq(value, 0.0, whole, xtol=tolerance)
        value(at)
    except ArithmeticError:
        return None
    return found[at]


def _evaluated(problem: Problem, u: Array, p: float) -> Evaluation | None:
    """Return the problem at a point, None where it is not defined or singular."""
    try:
        return problem.evaluate(u, p)
    except (InputError, np.linalg.LinAlgError):
        return None


def _answer(
    there: Evaluation, column: Array, row: Array, corner: float, right: Array, last: float
) -> tuple[Array, float]:
    """Return the solution of a bordered system, no numbers where it has none."""
    try:
        return there.linear.solve(column, row, corner, right, last)
    except np.linalg.LinAlgError:
        return np.full_like(right, np.nan), np.nan


def _comes_next(
    problem: Problem, scale: float, point: Point, reached: Point, length: float
) -> bool:
    """Tell whether a point lies on the same stretch of a branch: neither far away nor turned."""
    du, dp = reached.u - point.u, reached.p - point.p
    away = np.sqrt(problem.weights @ du**2 + (dp / scale) ** 2)
    across = problem.weights @ (point.tangent * reached.tangent)
    cosine = across + point.tangent_p * reached.tangent_p / scale**2
    return bool(cosine >= _STRAIGHT and _STRAIGHT * away <= length)
