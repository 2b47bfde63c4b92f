"""Recurrence of the shape at maxima of the displacement, up to rotations.

With the rotational symmetry reduced, the states at maxima of the displacement are a Poincare
section: a motion that is periodic up to a rotation visits the same few points, a quasi-periodic one
a curve, a chaotic one a cloud. The displacement has less noise than the energy, which contains
second differences.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from undula.analysis.observables.alignment import Compare, comparison
from undula.analysis.observables.peaks import PROMINENCE, prominent_maxima
from undula.analysis.observables.shapes import displacement
from undula.arrays import Array, Instants, Shapes

#: Largest number of maxima of the displacement in one period.
MAX_MAXIMA_PER_PERIOD = 12
#: Rise of a maximum above the minima next to it, as a share of the range of the displacement. The
#: second is tried without a recurrence with the first, which may count a ripple only at times.
PROMINENCES = (PROMINENCE, 0.2)
#: Largest distance of a recurring shape, relative to the displacement: several times the error of
#: the interpolation between 24 samples a beat, and a tenth of the distances in chaotic motions.
MAX_RECURRENCE_DISTANCE = 5e-3
#: Least number of recurrences of a periodic motion.
MIN_REPETITIONS = 3
#: Factor over the window up to which recurrence distances count as constant.
MAX_STEADY_FACTOR = 2.0
#: Share of the largest recurrence distance below which distances are errors of integration and
#: interpolation.
ERROR_SHARE = 0.2
#: Samples on either side of a maximum in the fit of a parabola, as a share of those between maxima.
_NEIGHBOUR_SHARE = 1.0 / 16.0
#: Shift in time of the shapes with which the distance is minimised over the time of a maximum
#: [samples]: so small that the shape moves along a straight line.
_TIME_SHIFT = 0.1


@dataclass(frozen=True)
class Recurrence:
    """Recurrence of a shape in a window.

    Attributes
    ----------
    maxima
        Number of maxima of the displacement in the window.
    every
        Number of maxima in a period: the least with a recurrence, else the one with the least
        distance.
    distance
        Median distance between a shape and its recurrence, after the best rotation and the best
        small shift in time, relative to the displacement.
    worst
        Largest of these distances.
    growth
        Factor by which the distances grow over the window, from its first third to its last.
    period
        Time between a shape and its recurrence [T].
    turn
        Rotation of the shape in a period [rad], in (-pi, pi].
    """

    maxima: int
    every: int
    distance: float
    worst: float
    growth: float
    period: float
    turn: float

    @property
    def repeats(self) -> bool:
        """True if the shape recurs over the whole window and often enough."""
        enough = self.maxima >= (MIN_REPETITIONS + 1) * self.every
        return (
            enough
            and self.distance <= MAX_RECURRENCE_DISTANCE
            and self.worst <= MAX_STEADY_FACTOR * MAX_RECURRENCE_DISTANCE
        )


def recurrence(time: Instants, nodes: Shapes, axisymmetric: bool = True) -> Recurrence | None:
    """Measure the recurrence of the shape.

    Parameters
    ----------
    time
        Equally spaced times [T], shape ``(m,)``.
    nodes
        Node positions [L], shape ``(m, N + 1, 3)``.
    axisymmetric
        True if shapes are compared up to rotations about z.

    Returns
    -------
    Recurrence or None
        None with fewer than four maxima of the displacement.
    """
    away, compare = displacement(nodes), comparison(axisymmetric=axisymmetric)
    rms = float(np.sqrt(np.mean(away**2)))
    nearest = None
    for prominence in PROMINENCES:
        times, shapes = _shapes_at_maxima(time, nodes, away, prominence * float(np.ptp(away)))
        most = min(MAX_MAXIMA_PER_PERIOD, len(times) // (MIN_REPETITIONS + 1))
        candidates = []
        for every in range(1, most + 1):
            candidates.append(_recurrence_after(every, times, shapes, rms, compare))
            if candidates[-1].repeats:
                return candidates[-1]
        nearest = nearest or min(candidates, key=lambda item: item.distance, default=None)
    return nearest


def _shapes_at_maxima(
    time: Instants, nodes: Shapes, away: Array, height: float
) -> tuple[Instants, Sequence[Shapes]]:
    """Return times (k,) of prominent maxima between samples, and three sets of shapes.

    The shapes (k, N + 1, 3) are those at these times, shortly before and shortly after. The time is
    that of the vertex of a parabola fitted to the neighbouring samples; the shapes are cubic
    interpolants.
    """
    top = prominent_maxima(away, height)
    if len(top) < MIN_REPETITIONS + 1:
        return time[:0], (nodes[:0],) * 3
    neighbours = max(1, int(_NEIGHBOUR_SHARE * np.min(np.diff(top))))
    margin = max(3, neighbours)
    top = top[(top >= margin) & (top < len(time) - margin)]
    position = top + _vertex(away, top, neighbours)
    interval = (time[-1] - time[0]) / (len(time) - 1)
    shapes = [_between(nodes, position + shift) for shift in (0.0, -_TIME_SHIFT, _TIME_SHIFT)]
    return np.asarray(time[0] + position * interval), shapes


def _vertex(values: Array, top: Array, neighbours: int) -> Array:
    """Return the offset of the vertex of the parabola fitted about each sample [samples]."""
    offsets = np.arange(-neighbours, neighbours + 1)
    square = offsets**2 - np.mean(offsets**2)
    values_near = values[top[:, None] + offsets]
    slope = values_near @ offsets / np.sum(offsets**2)
    curvature = values_near @ square / np.sum(square**2)
    vertex = np.divide(-0.5 * slope, curvature, out=np.zeros(len(top)), where=curvature < 0.0)
    return np.asarray(np.clip(vertex, -1.0, 1.0))


def _between(nodes: Shapes, position: Array) -> Shapes:
    """Return shapes (k, N + 1, 3) at positions between samples, by cubics through four of them."""
    first = np.floor(position).astype(int) - 1
    x = position - first
    shapes = np.zeros((len(position), *nodes.shape[1:]))
    for j in range(4):
        weight = np.ones_like(x)
        for other in range(4):
            if other != j:
                weight *= (x - other) / (j - other)
        shapes += weight[:, None, None] * nodes[first + j]
    return shapes


def _recurrence_after(
    every: int, times: Instants, shapes: Sequence[Shapes], rms: float, compare: Compare
) -> Recurrence:
    """Compare each shape with the one a number of maxima later."""
    pairs, before, after = (compare(near[every:], shapes[0][:-every]) for near in shapes)
    slope, curvature = _parabola(before.distance**2, pairs.distance**2, after.distance**2)
    reduction = np.divide(
        slope**2, 2.0 * curvature, out=np.zeros_like(curvature), where=curvature > 0.0
    )
    distances = np.sqrt(np.maximum(pairs.distance**2 - reduction, 0.0)) / rms
    third = max(1, len(distances) // 3)
    first, last = (
        max(ERROR_SHARE * MAX_RECURRENCE_DISTANCE, float(np.median(part)))
        for part in (distances[:third], distances[-third:])
    )
    return Recurrence(
        maxima=len(times),
        every=every,
        distance=float(np.median(distances)),
        worst=float(np.max(distances)),
        growth=last / first,
        period=float(np.median(times[every:] - times[:-every])),
        turn=float(np.angle(np.mean(np.exp(1j * pairs.angle)))),
    )


def _parabola(before: Array, here: Array, after: Array) -> tuple[Array, Array]:
    """Return slope and second derivative of the parabola through three equally spaced values."""
    return 0.5 * (after - before), after - 2.0 * here + before
