"""Principal plane of a motion through the z axis, and distance of the motion from it."""

from __future__ import annotations

import math

import numpy as np

from undula.analysis.observables.shape_sums import second_moments, squares_in_plane
from undula.analysis.observables.shapes import arc_weights, as_shapes, transverse
from undula.arrays import Array, Shapes


def plane_angle(nodes: Shapes) -> float:
    """Return the azimuth of the principal plane of a motion.

    The plane is the principal axis of the 2 x 2 covariance of the transverse node positions about
    the z axis, over all samples and, by arc length, over all nodes. In complex numbers its azimuth
    is half the argument of the mean of (x + i y)^2. For a motion without a preferred plane the
    azimuth has no meaning.

    Parameters
    ----------
    nodes
        Node positions [L], shape ``(m, N + 1, 3)`` or ``(N + 1, 3)``.

    Returns
    -------
    float
        Angle from the x axis [rad], in (-pi/2, pi/2].
    """
    difference, product = second_moments(as_shapes(nodes), arc_weights(nodes.shape[-2]))
    return 0.5 * math.atan2(product, difference)


def in_plane(nodes: Array, angle: float) -> tuple[Array, Array]:
    """Split transverse positions into the parts within and across a plane through z.

    Parameters
    ----------
    nodes
        Node positions [L], shape ``(..., N + 1, 3)``.
    angle
        Azimuth of the plane [rad].

    Returns
    -------
    tuple of Array
        The part within the plane and the part across it [L], each of shape ``(..., N + 1)``.
    """
    turned = transverse(nodes) * np.exp(-1j * angle)
    return turned.real, turned.imag


def planarity(nodes: Shapes) -> float:
    """Return the out-of-plane share of the transverse motion.

    It is the RMS distance of the nodes from the principal plane over their RMS distance from the z
    axis: the square root of the share of the smaller eigenvalue in the 2 x 2 transverse covariance.
    It is computed from the distances, so that a planar motion gives 0 to round-off.

    Parameters
    ----------
    nodes
        Node positions [L], shape ``(m, N + 1, 3)``, the samples of the window.

    Returns
    -------
    float
        From 0 in one plane to 1/sqrt(2) on a circle; 0 for a filament that stays on the axis.
    """
    shapes, weights = as_shapes(nodes), arc_weights(nodes.shape[-2])
    along, across = squares_in_plane(shapes, weights, plane_angle(shapes))
    total = along + across
    return math.sqrt(across / total) if total > 0.0 else 0.0
