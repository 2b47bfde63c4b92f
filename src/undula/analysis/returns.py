"""Does the shape come back? Shapes at successive maxima of the energy, compared up to turns.

In the frame of the motion's own symmetry a state at a maximum of the elastic energy is a point of a
Poincare section: a motion that is periodic up to a turn visits the same few points again and again,
one on a torus a curve of them, a chaotic one a cloud.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from undula.analysis.alignment import aligned_distance
from undula.analysis.observables import displacement
from undula.arrays import Array, Instants, Shapes

#: Most maxima of the energy that one period may have.
MOST_MAXIMA = 12
#: A shape that comes back to within this share of the displacement, does: ten times what the
#: interpolation between some 24 samples a beat leaves, and a tenth of what chaotic motions show.
RECURRENT = 5e-3
#: A motion has to come back so often to be called periodic.
FEWEST_REPETITIONS = 3
#: Distances that grow or shrink by less than this factor over the window keep their size.
STEADY_FACTOR = 2.0


@dataclass(frozen=True)
class Recurrence:
    """How nearly a motion repeats itself.

    Attributes
    ----------
    maxima
        Maxima of the energy in the window.
    every
        Number of maxima after which the shape comes back: the least with which it does, else the
        one with which it comes nearest.
    distance
        Median distance between a shape and the one that comes back, after the best turn, relative
        to the displacement.
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


def recurrence(time: Instants, nodes: Shapes, bending_energy: Instants) -> Recurrence | None:
    """Measure how the shape comes back; None with fewer than four maxima of the energy.

    Parameters
    ----------
    time
        Equally spaced times [T], shape ``(m,)``.
    nodes
        Node positions [L], shape ``(m, N + 1, 3)``.
    bending_energy
        Bending energy, shape ``(m,)``.
    """
    at, shapes = energy_maxima(time, nodes, bending_energy)
    if len(at) < FEWEST_REPETITIONS + 1:
        return None
    size = float(np.sqrt(np.mean(displacement(shapes) ** 2))) or 1.0
    most = min(MOST_MAXIMA, len(at) // (FEWEST_REPETITIONS + 1))
    found = [_after(every, at, shapes, size) for every in range(1, most + 1)]
    coming_back = [one for one in found if one.repeats]
    return coming_back[0] if coming_back else min(found, key=lambda one: one.distance)


def energy_maxima(
    time: Instants, nodes: Shapes, bending_energy: Instants
) -> tuple[Instants, Shapes]:
    """Return times (k,) and shapes (k, N + 1, 3) at the maxima of the energy between samples.

    The time is that of a parabola through the three samples around it, the shape that of the cubic
    through four.
    """
    here = bending_energy[1:-1]
    top = np.flatnonzero((here >= bending_energy[:-2]) & (here > bending_energy[2:])) + 1
    top = top[(top >= 2) & (top < len(time) - 2)]
    before, after = bending_energy[top - 1], bending_energy[top + 1]
    shift = 0.5 * (after - before) / (2.0 * bending_energy[top] - before - after)
    first = top - np.where(shift < 0.0, 2, 1)
    place = top + shift - first
    cubic = sum(
        (_lagrange(j, place)[:, None, None] * nodes[first + j] for j in range(4)),
        start=np.zeros((len(top), *nodes.shape[1:])),
    )
    interval = (time[-1] - time[0]) / max(1, len(time) - 1)
    return np.asarray(time[top] + shift * interval), np.asarray(cubic)


def _lagrange(j: int, x: Array) -> Array:
    """Return the cubic that is 1 at the j-th of 0, 1, 2, 3 and 0 at the others."""
    value = np.ones_like(x)
    for other in range(4):
        if other != j:
            value = value * (x - other) / (j - other)
    return value


def _after(every: int, at: Instants, shapes: Shapes, size: float) -> Recurrence:
    """Compare each shape with the one so many maxima later."""
    alignment = aligned_distance(shapes[every:], shapes[:-every])
    distances = alignment.distance / size
    third = max(1, len(distances) // 3)
    # Below a tenth of what counts, distances are made of errors of integration and interpolation.
    first, last = (
        max(0.1 * RECURRENT, float(np.median(part)))
        for part in (distances[:third], distances[-third:])
    )
    return Recurrence(
        maxima=len(at),
        every=every,
        distance=float(np.median(distances)),
        worst=float(np.max(distances)),
        growth=last / first,
        period=float(np.median(at[every:] - at[:-every])),
        turn=float(np.angle(np.mean(np.exp(1j * alignment.angle)))),
    )
