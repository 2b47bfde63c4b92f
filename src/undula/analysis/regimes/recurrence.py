"""Does the shape come back? Shapes where it is farthest from straight, compared up to turns.

In the frame of the motion's own symmetry a state at a maximum of the displacement is a point of a
Poincare section: a motion that is periodic up to a turn visits the same few points again and again,
one on a torus a curve of them, a chaotic one a cloud. The displacement shows them better than the
energy, which is made of second differences and so of noise first.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from undula.analysis.observables.alignment import Compare, comparison
from undula.analysis.observables.peaks import PROMINENCE, prominent_maxima
from undula.analysis.observables.shapes import displacement
from undula.arrays import Array, Instants, Shapes

#: Most maxima of the displacement that one period may have.
MOST_MAXIMA = 12
#: Shares of the whole swing by which a maximum rises above the minima next to it. If nothing comes
#: back with the first, a ripple may be counted at times only: then the second is tried.
PROMINENCES = (PROMINENCE, 0.2)
#: A shape that comes back to within this share of the displacement, does: several times what the
#: interpolation between some 24 samples a beat leaves, and a tenth of what chaotic motions show.
RECURRENT = 5e-3
#: A motion has to come back so often to be called periodic.
FEWEST_REPETITIONS = 3
#: Distances that grow or shrink by less than this factor over the window keep their size.
STEADY_FACTOR = 2.0
#: Distances below this part of what counts are made of errors of integration and interpolation.
ERRORS = 0.2
#: Samples beside a maximum that the parabola is laid through, as a part of those between maxima.
_BESIDE = 1.0 / 16.0
#: Shift in time by which shapes are compared as well, so that an error in the time of a maximum
#: does not count, in samples: so little that the shape moves along a straight line.
_NUDGE = 0.1


@dataclass(frozen=True)
class Recurrence:
    """How nearly a motion repeats itself.

    Attributes
    ----------
    maxima
        Maxima of the displacement in the window.
    every
        Number of maxima after which the shape comes back: the least with which it does, else the
        one with which it comes nearest.
    distance
        Median distance between a shape and the one that comes back, after the best turn and the
        best small shift in time, relative to the displacement.
    worst
        The largest of these distances.
    growth
        Factor by which the distances grow over the window, from its first third to its last.
    period
        Time after which the shape comes back [T].
    turn
        Angle by which it has turned then [rad], in (-pi, pi].
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
        """Whether the shape comes back, over the whole window and often enough."""
        enough = self.maxima >= (FEWEST_REPETITIONS + 1) * self.every
        return enough and self.distance <= RECURRENT and self.worst <= STEADY_FACTOR * RECURRENT


def recurrence(time: Instants, nodes: Shapes, axisymmetric: bool = True) -> Recurrence | None:
    """Measure how the shape comes back; None with fewer than four maxima of the displacement.

    Parameters
    ----------
    time
        Equally spaced times [T], shape ``(m,)``.
    nodes
        Node positions [L], shape ``(m, N + 1, 3)``.
    axisymmetric
        Whether turns about z do not count.
    """
    away, compare = displacement(nodes), comparison(axisymmetric=axisymmetric)
    size = float(np.sqrt(np.mean(away**2)))
    nearest = None
    for prominence in PROMINENCES:
        at, shapes = _farthest(time, nodes, away, prominence * float(np.ptp(away)))
        most = min(MOST_MAXIMA, len(at) // (FEWEST_REPETITIONS + 1))
        found = []
        for every in range(1, most + 1):
            found.append(_after(every, at, shapes, size, compare))
            if found[-1].repeats:
                return found[-1]
        nearest = nearest or min(found, key=lambda one: one.distance, default=None)
    return nearest


def _farthest(
    time: Instants, nodes: Shapes, away: Array, height: float
) -> tuple[Instants, Sequence[Shapes]]:
    """Return times (k,) of the prominent maxima, between samples, and shapes (k, N + 1, 3).

    These are at the times and a little before and after. The time is that of the parabola nearest
    to the samples beside, the shape that of the cubic through four.
    """
    top = prominent_maxima(away, height)
    if len(top) < FEWEST_REPETITIONS + 1:
        return time[:0], (nodes[:0],) * 3
    beside = max(1, int(_BESIDE * np.min(np.diff(top))))
    margin = max(3, beside)
    top = top[(top >= margin) & (top < len(time) - margin)]
    place = top + _vertex(away, top, beside)
    interval = (time[-1] - time[0]) / (len(time) - 1)
    near = [_between(nodes, place + shift) for shift in (0.0, -_NUDGE, _NUDGE)]
    return np.asarray(time[0] + place * interval), near


def _vertex(values: Array, top: Array, beside: int) -> Array:
    """Return how far from each sample the parabola through it and its neighbours culminates."""
    around = np.arange(-beside, beside + 1)
    square = around**2 - np.mean(around**2)
    near = values[top[:, None] + around]
    slope = near @ around / np.sum(around**2)
    bend = near @ square / np.sum(square**2)
    vertex = np.divide(-0.5 * slope, bend, out=np.zeros(len(top)), where=bend < 0.0)
    return np.asarray(np.clip(vertex, -1.0, 1.0))


def _between(nodes: Shapes, place: Array) -> Shapes:
    """Return shapes (k, N + 1, 3) at places between samples, by cubics through four of them."""
    first = np.floor(place).astype(int) - 1
    x = place - first
    shapes = np.zeros((len(place), *nodes.shape[1:]))
    for j in range(4):
        weight = np.ones_like(x)
        for other in range(4):
            if other != j:
                weight *= (x - other) / (j - other)
        shapes += weight[:, None, None] * nodes[first + j]
    return shapes


def _after(
    every: int, at: Instants, shapes: Sequence[Shapes], size: float, compare: Compare
) -> Recurrence:
    """Compare each shape with the one so many maxima later."""
    there, before, after = (compare(near[every:], shapes[0][:-every]) for near in shapes)
    slope, bend = _parabola(before.distance**2, there.distance**2, after.distance**2)
    gained = np.divide(slope**2, 2.0 * bend, out=np.zeros_like(bend), where=bend > 0.0)
    distances = np.sqrt(np.maximum(there.distance**2 - gained, 0.0)) / size
    third = max(1, len(distances) // 3)
    first, last = (
        max(ERRORS * RECURRENT, float(np.median(part)))
        for part in (distances[:third], distances[-third:])
    )
    return Recurrence(
        maxima=len(at),
        every=every,
        distance=float(np.median(distances)),
        worst=float(np.max(distances)),
        growth=last / first,
        period=float(np.median(at[every:] - at[:-every])),
        turn=float(np.angle(np.mean(np.exp(1j * there.angle)))),
    )


def _parabola(before: Array, here: Array, after: Array) -> tuple[Array, Array]:
    """Return slope and second derivative of the parabola through three equally spaced values."""
    return 0.5 * (after - before), after - 2.0 * here + before
