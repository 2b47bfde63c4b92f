"""Points of a curve at which a function of the point vanishes.

The curve is known in intervals. The function vanishes in an interval at whose ends its signs
differ. It may vanish twice in an interval into which it approaches 0 from both ends.
"""

from collections.abc import Iterator, Sequence
from typing import Any, Protocol, Self, TypeVar

import numpy as np
from scipy.optimize import minimize_scalar

from undula.arrays import Array

# Tolerance of the position of an extremum, relative to the length of its interval. The function
# there differs from the extremum by the square of it.
_EXTREMUM_TOLERANCE = 1e-6


class Sample(Protocol):
    """A point of a curve, with the function there."""

    @property
    def miss(self) -> float:
        """Value of the function; NaN where it is not defined."""


S = TypeVar("S", bound=Sample)


class Interval(Protocol[S]):
    """A part of a curve between neighbouring points."""

    @property
    def before(self) -> S:
        """First point."""

    @property
    def after(self) -> S:
        """Last point."""

    @property
    def length(self) -> float:
        """Length of the interval."""

    def at(self, position: float) -> S | None:
        """Return the point at a position between 0 and the length; None if it is not found."""

    def zero(self) -> S | None:
        """Return the point at which the function changes its sign; None if it is not found."""

    def split(self, point: S) -> tuple[Self, Self]:
        """Return the parts before and after a point of the interval."""


Part = TypeVar("Part", bound=Interval[Any])


def crossings(intervals: Sequence[Part], tolerance: float) -> Iterator[tuple[Part, Any]]:
    """Yield the points of a curve at which a function vanishes, each with its interval.

    Parameters
    ----------
    intervals : sequence of Interval
        Neighbouring parts of the curve, in order; at least one.
    tolerance : float
        Modulus of the function that counts as 0 at the ends of the curve and at an extremum.

    Yields
    ------
    Interval and Sample
        The point is an end of the interval, or inside it.
    """
    misses = _misses(intervals, tolerance)
    slopes = _slopes(intervals, misses)
    for index, interval in enumerate(intervals):
        first, last = misses[index], misses[index + 1]
        if first == 0.0:
            yield interval, interval.before
        elif first * last < 0.0:
            yield from _zeros([interval])
        elif last != 0.0 and first * slopes[index] < 0.0 < first * slopes[index + 1]:
            yield from _near_extremum(interval, float(np.sign(first)), tolerance)
    if misses[-1] == 0.0:
        yield intervals[-1], intervals[-1].after


def _misses(intervals: Sequence[Part], tolerance: float) -> Array:
    """Return the function at all points between intervals; 0 for round-off at the ends."""
    points = [intervals[0].before, *(interval.after for interval in intervals)]
    misses = np.array([point.miss for point in points])
    # A target that was computed at an end of the curve may lie outside the curve by round-off.
    for end in (0, -1):
        if abs(misses[end]) <= tolerance:
            misses[end] = 0.0
    return misses


def _slopes(intervals: Sequence[Part], misses: Array) -> Array:
    """Return the derivatives of the function along the curve, from parabolas."""
    positions = np.cumsum([0.0, *(interval.length for interval in intervals)])
    if len(positions) < 3:
        return np.zeros(len(positions))
    return np.asarray(np.gradient(misses, positions, edge_order=2))


def _zeros(intervals: Sequence[Part]) -> Iterator[tuple[Part, Any]]:
    for interval in intervals:
        point = interval.zero()
        if point is not None:
            yield interval, point


def _near_extremum(interval: Part, sign: float, tolerance: float) -> Iterator[tuple[Part, Any]]:
    """Yield the two zeros next to an extremum, or the extremum if the function is 0 there."""

    def distance(position: float) -> float:
        point = interval.at(position)
        return sign * point.miss if point is not None and np.isfinite(point.miss) else np.inf

    extremum = minimize_scalar(
        distance,
        bounds=(0.0, interval.length),
        method="bounded",
        options={"xatol": _EXTREMUM_TOLERANCE * interval.length},
    )
    point = interval.at(float(extremum.x))
    if point is None or not extremum.fun <= tolerance:
        return
    if extremum.fun < -tolerance:
        yield from _zeros(interval.split(point))
    else:
        yield interval, point
