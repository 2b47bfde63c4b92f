"""Functions for the expressions of claims, on curves.

The points of a curve may be in any order. A claim on a range needs the interval over which a
condition holds without a gap.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicSpline

from undula.arrays import Points

__all__ = [
    "at",
    "crossing",
    "exactly",
    "falling",
    "first_present",
    "holding",
    "holding_error",
    "minimum",
    "missing",
    "on",
    "peak",
    "peak_error",
    "roundoff",
]


def at(where: float, of: ArrayLike, values: ArrayLike) -> float:
    """Interpolate a curve at one place by the parabola through three points around it.

    Parameters
    ----------
    where
        The place.
    of, values
        Places and values of the curve.

    Raises
    ------
    ValueError
        The place is outside of the curve.
    """
    places, heights = _sorted(of, values)
    if not places[0] <= where <= places[-1]:
        raise ValueError(f"{where:g} is outside of {places[0]:g} to {places[-1]:g}")
    middle = int(np.clip(np.searchsorted(places, where), 1, len(places) - 2))
    near = slice(middle - 1, middle + 2)
    return float(_parabola(places[near] - where, heights[near])[0])


def exactly(where: float, of: ArrayLike, values: ArrayLike) -> float:
    """Return the value of a curve at one of its own points.

    Parameters
    ----------
    where
        The place, or several places.
    of
        Places of the curve.
    values
        Values of the curve.

    Raises
    ------
    ValueError
        The curve has no point there.
    """
    matches = np.flatnonzero(np.asarray(of, dtype=float) == where)
    if not len(matches):
        raise ValueError(f"nothing was computed at {where:g}")
    return float(np.asarray(values, dtype=float)[matches[0]])


def on(where: ArrayLike, of: ArrayLike, values: ArrayLike) -> Points:
    """Interpolate a curve at several places as `at` does; beyond its ends it is constant.

    Parameters
    ----------
    where
        The place, or several places.
    of
        Places of the curve.
    values
        Values of the curve.
    """
    places, heights = _sorted(of, values)
    inside = np.clip(np.asarray(where, dtype=float), places[0], places[-1])
    return np.array([at(place, places, heights) for place in inside])


def holding(of: ArrayLike, condition: ArrayLike, around: float) -> list[float]:
    """Return the ends of the range around a place over which a condition holds.

    Parameters
    ----------
    of
        Places.
    condition
        Values that are positive where the condition holds; the range ends at a zero, or with the
        places.
    around
        A place inside the range.

    Raises
    ------
    ValueError
        The condition does not hold at `around`.
    """
    return _range(*_sorted(of, condition), around, _zero)


def holding_error(of: ArrayLike, condition: ArrayLike, around: float) -> list[float]:
    """Return the errors of the ends of `holding`: the difference to linear interpolation.

    Parameters
    ----------
    of
        Places of the curve.
    condition
        Values that are positive where the condition holds.
    around
        A place inside the range.
    """
    places, margin = _sorted(of, condition)
    smooth, straight = (_range(places, margin, around, zero) for zero in (_zero, _straight_zero))
    return [abs(end - other) for end, other in zip(smooth, straight, strict=True)]


def crossing(of: ArrayLike, values: ArrayLike) -> float:
    """Return the first place at which a curve passes through zero.

    Parameters
    ----------
    of
        Places of the curve.
    values
        Values of the curve.

    Raises
    ------
    ValueError
        The curve has no zero.
    """
    places, heights = _sorted(of, values)
    changes = np.flatnonzero(np.sign(heights[1:]) != np.sign(heights[:-1]))
    if not len(changes):
        raise ValueError("the values do not pass through zero")
    return _zero(places, heights, int(changes[0]))


def peak(of: ArrayLike, values: ArrayLike) -> float:
    """Return the place of the first maximum of a curve inside its ends.

    Parameters
    ----------
    of
        Places of the curve.
    values
        Values of the curve.

    Raises
    ------
    ValueError
        The curve has no maximum inside.
    """
    places, heights = _sorted(of, values)
    inner = heights[1:-1]
    tops = np.flatnonzero((inner > heights[:-2]) & (inner >= heights[2:])) + 1
    if not len(tops):
        raise ValueError("the values have no maximum inside")
    top = int(tops[0])
    extrema = CubicSpline(places, heights).derivative().roots(extrapolate=False)
    return float(extrema[np.abs(extrema - places[top]).argmin()])


def peak_error(of: ArrayLike, values: ArrayLike) -> float:
    """Return the error of `peak`: the difference to the parabola through the nearest points.

    Parameters
    ----------
    of
        Places of the curve.
    values
        Values of the curve.
    """
    places, heights = _sorted(of, values)
    top = peak(places, heights)
    middle = int(np.clip(np.abs(places - top).argmin(), 1, len(places) - 2))
    near = slice(middle - 1, middle + 2)
    _, slope, curvature = _parabola(places[near] - top, heights[near])
    return float(abs(slope / (2.0 * curvature)))


def minimum(first: ArrayLike, second: ArrayLike) -> Points:
    """Return the smaller of two values at each place, for two conditions that both have to hold.

    Parameters
    ----------
    first
        Values of the first condition.
    second
        Values of the second condition.
    """
    return np.asarray(np.minimum(first, second), dtype=float)


def falling(values: ArrayLike) -> bool:
    """Return True if every value is smaller than the one before."""
    return bool((np.diff(np.asarray(values, dtype=float)) < 0.0).all())


def missing(values: ArrayLike) -> Any:
    """Return a mask of the places without a value."""
    return np.isnan(np.asarray(values, dtype=float))


def first_present(of: ArrayLike, values: ArrayLike) -> list[float]:
    """Return the beginning of the values, in the middle of the gap before, and its error.

    Parameters
    ----------
    of
        Places of the curve.
    values
        Values of the curve.
    """
    places, heights = _sorted(of, values)
    first = int(np.flatnonzero(~np.isnan(heights))[0])
    low = places[max(first - 1, 0)]
    return [float((low + places[first]) / 2.0), float((places[first] - low) / 2.0)]


def roundoff(value: float) -> float:
    """Return the round-off error of a value after a few operations."""
    return float(4.0 * np.finfo(float).eps * abs(value))


def _parabola(places: Points, values: Points) -> Points:
    """Return the coefficients of the parabola through three points, the constant first."""
    matrix = np.vander(places, 3, increasing=True)
    return np.asarray(np.linalg.solve(matrix, values))


def _range(
    places: Points, margin: Points, around: float, zero: Callable[[Points, Points, int], float]
) -> list[float]:
    """Return the ends of the range around a place on which `margin` is positive.

    `zero` returns the zero between a point, given by its index, and the next one.
    """
    inside = int(np.abs(places - around).argmin())
    if not margin[inside] > 0.0:
        raise ValueError(f"it does not hold at {around:g}")
    failing = np.flatnonzero(~(margin > 0.0))
    before, after = failing[failing < inside], failing[failing > inside]
    low = zero(places, margin, int(before[-1])) if len(before) else float(places[0])
    high = zero(places, margin, int(after[0]) - 1) if len(after) else float(places[-1])
    return [low, high]


def _zero(places: Points, values: Points, left: int) -> float:
    """Return the zero of the cubic spline to the right of a point."""
    if not np.isfinite(values).all():
        return _straight_zero(places, values, left)
    roots = CubicSpline(places, values).roots(extrapolate=False)
    inside = roots[(roots >= places[left]) & (roots <= places[left + 1])]
    return float(inside[0])


def _straight_zero(places: Points, values: Points, left: int) -> float:
    """Return the zero of the straight line to the right of a point."""
    a, b = values[left], values[left + 1]
    return float(places[left] - a * (places[left + 1] - places[left]) / (b - a))


def _sorted(of: ArrayLike, values: ArrayLike) -> tuple[Points, Points]:
    """Return places and values of a curve with rising places."""
    places, heights = np.asarray(of, dtype=float), np.asarray(values, dtype=float)
    if len(places) < 3:
        raise ValueError(f"a curve of {len(places)} points is too short")
    order = np.argsort(places, kind="stable")
    return places[order], heights[order]
