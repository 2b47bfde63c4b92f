"""Location of a zero of a test function along a branch, such as a fold or another bifurcation."""

from collections.abc import Callable

import numpy as np
from scipy.optimize import brentq

from undula.numerics.continuation.arclength import Point, advance
from undula.numerics.continuation.problem import Problem

# Distances from a singular point, in tolerances, at which a point may replace it.
_OFFSETS = (0.0, 1.0, -1.0, 100.0, -100.0)


def locate(
    problem: Problem,
    before: Point,
    after: Point,
    test: Callable[[Point], float],
    scale: float,
    tolerance: float,
) -> Point | None:
    """Locate the point between two neighbours at which a test function changes its sign.

    Parameters
    ----------
    problem : Problem
        The equations.
    before, after : Point
        Neighbours on a branch, with values of the test of opposite sign.
    test : callable
        A continuous function of a point, NaN where it is undefined.
    scale : float
        As in `Steps`.
    tolerance : float
        Largest error of the parameter, in units of the scale.

    Returns
    -------
    Point or None
        None if the sign does not change, or where no solution or no value is found.
    """
    full_length = float((problem.weights * before.tangent) @ (after.u - before.u))
    full_length += before.tangent_p * (after.p - before.p) / scale**2
    points: dict[float, Point] = {0.0: before, full_length: after}
    # Each value is computed once: round-off may differ from one evaluation to the next.
    values: dict[float, float] = {}

    def value(length: float) -> float:
        if length not in points:
            # At a branch point the equations are singular: a point next to it replaces it.
            neighbours = (advance(problem, before, length + k * tolerance, scale) for k in _OFFSETS)
            point = next(filter(None, neighbours), None)
            if point is None:
                raise ArithmeticError
            points[length] = point
        if length not in values:
            values[length] = test(points[length])
        if np.isnan(values[length]):
            raise ArithmeticError
        return values[length]

    try:
        if value(0.0) * value(full_length) > 0.0:
            return None
        root = brentq(value, 0.0, full_length, xtol=tolerance)
        value(root)  # stores the point
    except ArithmeticError:
        return None
    return points[root]
