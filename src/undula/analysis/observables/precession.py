"""Precession of an oscillation about the z axis, and alternation between the sides of its plane.

The plane of a beat is the direction of the oscillation about the mean. With w = x + i y from the
mean, its azimuth is half the argument of the sum of w^2 over the nodes, smoothed over a beat.
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

# Least number of maxima for a measurement, and of samples in a smoothing kernel.
_MIN_MAXIMA = 3


@dataclass(frozen=True)
class Precession:
    """Rates of rotation and of beating of a motion.

    Attributes
    ----------
    tip_turns : float
        Turns of the mean position about z [1/T], positive from x to y.
    plane_turns : float
        Turns of the plane of the beat about z [1/T], positive from x to y.
    beats : float
        Beats, of two maxima of the displacement each [1/T].
    side_switching : float
        Share of the maxima of the displacement at which the mean position has changed sides since
        the previous maximum: 1 if the sides alternate, 0 if all are on one side.
    """

    tip_turns: float
    plane_turns: float
    beats: float
    side_switching: float


def precession(time: Instants, nodes: Shapes) -> Precession | None:
    """Measure the precession of a motion.

    Parameters
    ----------
    time
        Equally spaced times [T], shape ``(m,)``.
    nodes
        Node positions [L], shape ``(m, N + 1, 3)``.

    Returns
    -------
    Precession or None
        None with fewer than three maxima of the displacement.
    """
    away = displacement(nodes)
    maxima = prominent_maxima(away, PROMINENCE * float(np.ptp(away)))
    if len(maxima) < _MIN_MAXIMA:
        return None
    span = float(time[-1] - time[0])
    plane = plane_angle(nodes, len(maxima))
    plane_span = span * len(plane) / len(time)
    return Precession(
        tip_turns=float(azimuth(nodes)[-1] - azimuth(nodes)[0]) / (2.0 * np.pi * span),
        plane_turns=float(plane[-1] - plane[0]) / (2.0 * np.pi * plane_span),
        beats=0.5 * len(maxima) / span,
        side_switching=_switching(nodes, plane, maxima),
    )


def plane_angle(nodes: Shapes, maxima: int) -> Array:
    """Return the azimuth of the plane of the beat, without jumps.

    Parameters
    ----------
    nodes
        Node positions [L], shape ``(m, N + 1, 3)``.
    maxima
        Number of maxima of the displacement in these samples, two a beat.

    Returns
    -------
    Array
        Shape ``(k,)``, k < m [rad]: the smoothing leaves out half a beat at each end.
    """
    position, weights = transverse(nodes), arc_weights(nodes.shape[1])
    swing = position - hann(len(position)) @ position
    beat = max(_MIN_MAXIMA, 2 * len(position) // max(1, maxima))
    if beat > len(position):
        return np.zeros(1)
    smooth = np.convolve(swing**2 @ weights, hann(beat), mode="valid")
    return np.asarray(0.5 * np.unwrap(np.angle(smooth)))


def _switching(nodes: Shapes, plane: Array, maxima: Array) -> float:
    """Return the share of maxima at which the mean position has changed sides since the last."""
    cut = (len(nodes) - len(plane)) // 2
    inner = maxima[(maxima >= cut) & (maxima < cut + len(plane))]
    if len(inner) < 2:
        return 0.0
    middle = transverse(mean_position(nodes))
    middle = middle - hann(len(middle)) @ middle
    across = np.imag(middle[inner] * np.exp(-1j * plane[inner - cut]))
    return float(np.mean(across[1:] * across[:-1] < 0.0))
