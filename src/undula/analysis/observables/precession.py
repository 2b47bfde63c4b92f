"""How a motion to and fro goes round the axis, and on which side of its plane it is.

The plane of a beat is the direction in which it swings about its mean. With w = x + i y from the
mean, that is half the angle of the sum of w^2 over the nodes, smoothed over a beat.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from undula.analysis.observables.peaks import PROMINENCE, prominent_maxima
from undula.analysis.observables.shapes import (
    arc_weights,
    azimuth,
    displacement,
    mean_position,
    transverse,
)
from undula.analysis.observables.spectrum import hann
from undula.arrays import Array, Instants, Shapes

# A kernel of fewer samples smooths nothing.
_LEAST = 3


@dataclass(frozen=True)
class Precession:
    """How a motion goes round, in turns and beats per T, turns positive from x to y.

    Attributes
    ----------
    tip_turns : float
        Turns of the tip about z.
    plane_turns : float
        Turns of the plane of the beat about z.
    beats : float
        Beats, of two maxima of the displacement each.
    side_switching : float
        Share of the maxima of the displacement that are on the other side of the plane of the beat
        than the one before: 1 if the sides alternate, 0 if it stays on one of them.
    """

    tip_turns: float
    plane_turns: float
    beats: float
    side_switching: float


def precession(time: Instants, nodes: Shapes) -> Precession | None:
    """Measure how a motion goes round; None with fewer than three maxima of its displacement.

    Parameters
    ----------
    time
        Equally spaced times [T], shape ``(m,)``.
    nodes
        Node positions [L], shape ``(m, N + 1, 3)``.
    """
    away = displacement(nodes)
    tops = prominent_maxima(away, PROMINENCE * float(np.ptp(away)))
    if len(tops) < _LEAST:
        return None
    span = float(time[-1] - time[0])
    plane = plane_angle(nodes, len(tops))
    smoothed_away = span * len(plane) / len(time)
    return Precession(
        tip_turns=float(azimuth(nodes)[-1] - azimuth(nodes)[0]) / (2.0 * np.pi * span),
        plane_turns=float(plane[-1] - plane[0]) / (2.0 * np.pi * smoothed_away),
        beats=0.5 * len(tops) / span,
        side_switching=_switching(nodes, plane, tops),
    )


def plane_angle(nodes: Shapes, maxima: int) -> Array:
    """Return the azimuth of the plane of the beat [rad], shape (k,), k < m, without jumps.

    Parameters
    ----------
    nodes
        Node positions [L], shape ``(m, N + 1, 3)``.
    maxima
        Maxima of the displacement in that time, two a beat. What is smoothed away, half a beat at
        each end, is missing.
    """
    sides, weights = transverse(nodes), arc_weights(nodes.shape[1])
    swing = sides - hann(len(sides)) @ sides
    beat = max(_LEAST, 2 * len(sides) // max(1, maxima))
    if beat > len(sides):
        return np.zeros(1)
    smooth = np.convolve(swing**2 @ weights, hann(beat), mode="valid")
    return np.asarray(0.5 * np.unwrap(np.angle(smooth)))


def _switching(nodes: Shapes, plane: Array, tops: Array) -> float:
    """Return how often the mean position changes sides from one maximum to the next."""
    missing = (len(nodes) - len(plane)) // 2
    seen = tops[(tops >= missing) & (tops < missing + len(plane))]
    if len(seen) < 2:
        return 0.0
    middle = transverse(mean_position(nodes))
    middle = middle - hann(len(middle)) @ middle
    across = np.imag(middle[seen] * np.exp(-1j * plane[seen - missing]))
    return float(np.mean(across[1:] * across[:-1] < 0.0))
