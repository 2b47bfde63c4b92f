"""How far a motion is from lying in one plane through the z axis."""

from __future__ import annotations

import math

import numpy as np

from undula.analysis.observables.shape_sums import second_moments, squares_in_plane
from undula.analysis.observables.shapes import arc_weights, as_shapes, transverse
from undula.arrays import Array, Shapes


def plane_angle(nodes: Shapes) -> float:
    """Azimuth of the plane through z that holds most of the motion [rad], in (-pi/2, pi/2].

    The principal axis of the 2 x 2 covariance of the transverse node positions about the z axis,
    over all samples and, by arc length, over all nodes. In complex numbers it is half the argument
    of the mean of (x + i y)^2. A motion without a preferred plane returns some angle all the same.

    Parameters
    ----------
    nodes
        Node positions [L], shape ``(m, N + 1, 3)`` or ``(N + 1, 3)``.

    Returns
    -------
    float
        The angle from the x axis.
    """
    difference, product = second_moments(as_shapes(nodes), arc_weights(nodes.shape[-2]))
    return 0.5 * math.atan2(product, difference)


def in_plane(nodes: Array, angle: float) -> tuple[Array, Array]:
    """Transverse positions split into the parts within and across a plane through z [L].

    Parameters
    ----------
    nodes
        Node positions [L], shape ``(..., N + 1, 3)``.
    angle
        Azimuth of the plane [rad].

    Returns
    -------
    tuple of Array
        The part along the plane and the part across it, each of shape ``(..., N + 1)``.
    """
    turned = transverse(nodes) * np.exp(-1j * angle)
    return turned.real, turned.imag


def planarity(nodes: Shapes) -> float:
    """Out-of-plane part of the transverse motion, relative: 0 in one plane, 0.7071 on a circle.

    The RMS distance of the nodes from the best plane through the z axis over their RMS distance
    from that axis: the root of the smaller eigenvalue's share of the 2 x 2 transverse covariance.
    Computed from the distances themselves, so that an exactly planar motion gives zero to rounding.

    Parameters
    ----------
    nodes
        Node positions [L], shape ``(m, N + 1, 3)``, the samples of the window.

    Returns
    -------
    float
        Between 0 and 1/sqrt(2); 0 for a filament that never leaves the axis.
    """
    shapes, weights = as_shapes(nodes), arc_weights(nodes.shape[-2])
    along, across = squares_in_plane(shapes, weights, plane_angle(shapes))
    total = along + across
    return math.sqrt(across / total) if total > 0.0 else 0.0
