"""Positions, distances and extremes of shapes, sample by sample.

``nodes`` has shape ``(..., N + 1, 3)`` in units of the length L, with the base node first and at
the origin; the straight filament lies along z. A mean over the filament is a mean over the arc
length by the trapezoid rule over the nodes, with an error of the square of the link length.
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
    """Return the weights of a mean over the arc length, one for each node.

    Parameters
    ----------
    count
        Number of nodes, at least 2.

    Returns
    -------
    Array
        Shape ``(count,)``, read-only: the trapezoid rule over equal links, with sum 1.
    """
    weights = np.full(count, 1.0 / (count - 1))
    weights[[0, -1]] *= 0.5
    weights.setflags(write=False)
    return weights


@lru_cache(maxsize=64)
def _straight_nodes(count: int) -> Array:
    """Return the nodes (count, 3) of the straight filament."""
    nodes = np.zeros((count, 3))
    nodes[:, 2] = np.linspace(0.0, 1.0, count)
    nodes.setflags(write=False)
    return nodes


def as_shapes(nodes: Array) -> Shapes:
    """Return nodes as compiled sums take them.

    Parameters
    ----------
    nodes
        Node positions [L], shape ``(..., N + 1, 3)``.

    Returns
    -------
    Shapes
        The same in one contiguous array, shape ``(m, N + 1, 3)``.
    """
    return np.ascontiguousarray(nodes, dtype=np.float64).reshape(-1, *nodes.shape[-2:])


def transverse(nodes: Array) -> ComplexArray:
    """Return the transverse position x + i y of every node.

    A rotation about z by an angle multiplies it by exp(i angle).

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
    """Return the position of the free end.

    Parameters
    ----------
    nodes
        Node positions [L], shape ``(..., N + 1, 3)``.

    Returns
    -------
    Array
        Shape ``(..., 3)`` [L].
    """
    return np.asarray(nodes[..., -1, :], dtype=np.float64)


def tip_radius(nodes: Array) -> Array:
    """Return the distance of the free end from the z axis.

    Parameters
    ----------
    nodes
        Node positions [L], shape ``(..., N + 1, 3)``.

    Returns
    -------
    Array
        Shape ``(...)``, from 0 to 1 [L].
    """
    tip = tip_position(nodes)
    return np.asarray(np.hypot(tip[..., 0], tip[..., 1]), dtype=np.float64)


def tip_height(nodes: Array) -> Array:
    """Return the height of the free end over the base plane.

    Parameters
    ----------
    nodes
        Node positions [L], shape ``(..., N + 1, 3)``.

    Returns
    -------
    Array
        Shape ``(...)``, from -1 to 1, 1 for the straight filament [L].
    """
    return np.asarray(tip_position(nodes)[..., 2], dtype=np.float64)


def mean_position(nodes: Array) -> Array:
    """Return the mean position of the filament over its arc length.

    Parameters
    ----------
    nodes
        Node positions [L], shape ``(..., N + 1, 3)``.

    Returns
    -------
    Array
        Shape ``(..., 3)`` [L]; (0, 0, 1/2) for the straight filament.
    """
    shapes = as_shapes(nodes)
    mean = np.empty((len(shapes), 3))
    means(shapes, arc_weights(nodes.shape[-2]), mean)
    return mean.reshape(*nodes.shape[:-2], 3)


def displacement(nodes: Array) -> Array:
    """Return the distance from straight, RMS over the arc length.

    Each node is compared with its position on the straight filament along z.

    Parameters
    ----------
    nodes
        Node positions [L], shape ``(..., N + 1, 3)``.

    Returns
    -------
    Array
        Shape ``(...)``, at least 0 [L]; 0 for the straight filament.
    """
    shapes, count = as_shapes(nodes), nodes.shape[-2]
    distance = np.empty(len(shapes))
    distances_from(shapes, _straight_nodes(count), arc_weights(count), distance)
    return distance.reshape(nodes.shape[:-2])


def azimuth(nodes: Shapes) -> Instants:
    """Return the azimuth of the mean position about z, continuous in time.

    The angle has a meaning while the mean position stays away from the axis and turns by less than
    half a turn between samples. At a passage next to the axis it jumps by about half a turn, with a
    sign that depends on the side of the passage. For planar flapping, and for every motion that
    changes sides, use the integral of the rate of rotation stored with the run
    (``rotation_angle``).

    Parameters
    ----------
    nodes
        Node positions [L], shape ``(m, N + 1, 3)``, samples in order of time.

    Returns
    -------
    Instants
        Shape ``(m,)`` [rad]; starts in (-pi, pi], grows for a rotation from x to y.
    """
    mean = mean_position(nodes)
    return np.asarray(np.unwrap(np.arctan2(mean[..., 1], mean[..., 0])), dtype=np.float64)


@dataclass(frozen=True)
class Range:
    """Smallest, largest and mean value of a quantity over a window.

    Attributes
    ----------
    min, max, mean
        In the unit of the quantity.
    """

    min: float
    max: float
    mean: float


def envelope(values: Instants) -> Range:
    """Return the range of a smooth quantity, with extremes interpolated between the samples.

    A parabola through each local extreme of the samples and its two neighbours gives the extreme
    with an error of fourth order in the sampling interval instead of second. The two ends of the
    window are not interpolated.

    Parameters
    ----------
    values
        Equally spaced samples, shape ``(m,)``, m at least 1.

    Returns
    -------
    Range
        Extremes, and the plain mean of the samples, in the unit of the values.
    """
    return Range(*extremes_and_mean(np.ascontiguousarray(values, dtype=np.float64)))
