"""What one reads off a trajectory, sample by sample.

Conventions shared by every function here: ``nodes`` has shape ``(..., N + 1, 3)`` in units of the
length L, the base node first and at the origin; the straight filament lies along z. A mean over
the filament is a mean over its arc length: the trapezoid rule over the nodes, which counts the two
end nodes half and so tends to the integral with the square of the link length.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from undula.arrays import Array, ComplexArray, Instants, Shapes


def arc_weights(count: int) -> Array:
    """Weights of a mean over the arc length, one for each node.

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
    return weights


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
    return np.asarray(np.einsum("k,...kc->...c", arc_weights(nodes.shape[-2]), nodes))


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
    away = np.array(nodes, dtype=np.float64)
    away[..., 2] -= np.linspace(0.0, 1.0, nodes.shape[-2])
    square = np.einsum("k,...kc,...kc->...", arc_weights(nodes.shape[-2]), away, away)
    return np.asarray(np.sqrt(square), dtype=np.float64)


def winding_angle(nodes: Shapes) -> Instants:
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
    return Range(min=-_largest(-values), max=_largest(values), mean=float(np.mean(values)))


def _largest(values: Instants) -> float:
    before, here, after = values[:-2], values[1:-1], values[2:]
    bend = 2.0 * here - before - after
    top = (here >= before) & (here >= after) & (bend > 0.0)
    vertices = here[top] + (after[top] - before[top]) ** 2 / (8.0 * bend[top])
    return float(max(np.max(values), np.max(vertices, initial=-np.inf)))
