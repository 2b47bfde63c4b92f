"""What one reads off a trajectory, sample by sample.

Conventions shared by every function here: ``nodes`` has shape ``(..., N + 1, 3)`` in units of the
length L, the base node first and at the origin; the straight filament lies along z. A mean over
the filament is a mean over its arc length: the trapezoid rule over the nodes, which counts the two
end nodes half and so tends to the integral with the square of the link length.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from undula.analysis.observables.sample_sums import extremes_and_mean
from undula.analysis.observables.shape_sums import distances_from, means
from undula.arrays import Array, ComplexArray, Instants, Shapes


@lru_cache(maxsize=64)
def arc_weights(count: int) -> Array:
    """Weights of a mean over the arc length, one for each node; they cannot be written to.

    Parameters
    ----------
    count
        Number of nodes, at least 2.

    Returns
    -------
    Array
        Shape ``(count,)``, trapezoid rule over equal links, sum 1.
    """
    weights = np.full(count, 1.0 / (count - 1))
    weights[[0, -1]] *= 0.5
    weights.setflags(write=False)
    return weights


@lru_cache(maxsize=64)
def _straight_places(count: int) -> Array:
    """Return the places (count, 3) of the nodes of the straight filament."""
    places = np.zeros((count, 3))
    places[:, 2] = np.linspace(0.0, 1.0, count)
    places.setflags(write=False)
    return places


def as_shapes(nodes: Array) -> Shapes:
    """Return nodes (..., N + 1, 3) as compiled sums take them: a contiguous (m, N + 1, 3)."""
    return np.ascontiguousarray(nodes, dtype=np.float64).reshape(-1, *nodes.shape[-2:])


def transverse(nodes: Array) -> ComplexArray:
    """Transverse position x + i y of every node, where a turn about z is a factor exp(i angle).

    Parameters
    ----------
    nodes
        Node positions [L], shape ``(..., N + 1, 3)``.

    Returns
    -------
    ComplexArray
        Shape ``(..., N + 1)`` [L].
    """
    return np.asarray(nodes[..., 0] + 1j * nodes[..., 1], dtype=np.complex128)


def tip_position(nodes: Array) -> Array:
    """Position of the free end [L]: shape ``(..., 3)`` for nodes of shape ``(..., N + 1, 3)``."""
    return np.asarray(nodes[..., -1, :], dtype=np.float64)


def tip_radius(nodes: Array) -> Array:
    """Distance of the free end from the z axis [L], 0 to 1: shape ``(...)``."""
    tip = tip_position(nodes)
    return np.asarray(np.hypot(tip[..., 0], tip[..., 1]), dtype=np.float64)


def tip_height(nodes: Array) -> Array:
    """Height of the free end over the base plane [L], -1 to 1, 1 when straight: shape ``(...)``."""
    return np.asarray(tip_position(nodes)[..., 2], dtype=np.float64)


def mean_position(nodes: Array) -> Array:
    """Mean position of the filament over its arc length [L].

    Parameters
    ----------
    nodes
        Node positions [L], shape ``(..., N + 1, 3)``.

    Returns
    -------
    Array
        Shape ``(..., 3)``; (0, 0, 1/2) for the straight filament.
    """
    shapes = as_shapes(nodes)
    found = np.empty((len(shapes), 3))
    means(shapes, arc_weights(nodes.shape[-2]), found)
    return found.reshape(*nodes.shape[:-2], 3)


def displacement(nodes: Array) -> Array:
    """How far the filament is from straight: RMS over the arc length of the nodes' distances [L].

    Each node is compared with its own place on the straight filament of length 1 along z.

    Parameters
    ----------
    nodes
        Node positions [L], shape ``(..., N + 1, 3)``.

    Returns
    -------
    Array
        Shape ``(...)``; 0 for the straight filament.
    """
    shapes, count = as_shapes(nodes), nodes.shape[-2]
    found = np.empty(len(shapes))
    distances_from(shapes, _straight_places(count), arc_weights(count), found)
    return found.reshape(nodes.shape[:-2])


def azimuth(nodes: Shapes) -> Instants:
    """Azimuth of the mean position about z, followed continuously through time [rad].

    The angle is meaningful while the mean position keeps away from the axis and moves by less than
    half a turn between samples. When it passes close to the axis the azimuth jumps by about half a
    turn with a sign that depends on which side the axis was passed: for planar flapping, or for any
    motion that changes sides, the accumulated angle then says nothing, and the integral of the
    turning rate stored with the run (``rotation_angle``) is the quantity to use.

    Parameters
    ----------
    nodes
        Node positions [L], shape ``(m, N + 1, 3)``, samples in order of time.

    Returns
    -------
    Instants
        Shape ``(m,)``; starts in (-pi, pi], positive for a turn from x to y.
    """
    mean = mean_position(nodes)
    return np.asarray(np.unwrap(np.arctan2(mean[..., 1], mean[..., 0])), dtype=np.float64)


@dataclass(frozen=True)
class Range:
    """Smallest, largest and mean value of a quantity over a window, in its own unit."""

    min: float
    max: float
    mean: float


def envelope(values: Instants) -> Range:
    """Range of a sampled smooth quantity, its extremes read between the samples.

    A parabola through each sample that tops (or undercuts) its two neighbours gives the extreme
    there, with an error of fourth order in the sampling step instead of second. The two ends of the
    window are taken as they are.

    Parameters
    ----------
    values
        Equally spaced samples, shape ``(m,)``, m at least 1.

    Returns
    -------
    Range
        With the plain mean of the samples.
    """
    return Range(*extremes_and_mean(np.ascontiguousarray(values, dtype=np.float64)))
