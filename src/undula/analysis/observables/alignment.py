"""Distance between shapes, up to rotations about z for bodies with rotational symmetry."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from undula.analysis.observables.shape_sums import align, largest_aligned_distance
from undula.analysis.observables.shapes import arc_weights, as_shapes
from undula.arrays import Array


@dataclass(frozen=True)
class Alignment:
    """Distance between two shapes after the best rotation about z.

    Attributes
    ----------
    distance
        RMS over the arc length of the distance between the nodes [L].
    angle
        Rotation of the second shape that minimises the distance [rad], in (-pi, pi].
    """

    distance: Array
    angle: Array


def aligned_distance(shape_a: Array, shape_b: Array) -> Alignment:
    """Return the least distance between two shapes over all rotations of the second about z.

    With a and b the transverse positions as complex numbers, the sum of |a - exp(i angle) b|^2 is
    least at the argument of the sum of a times the conjugate of b; a rotation leaves the heights
    unchanged. If that sum vanishes, all rotations give the same distance and the angle is 0.

    Parameters
    ----------
    shape_a, shape_b
        Node positions [L], shapes ``(..., N + 1, 3)`` that broadcast against each other: one shape
        against one, or a trajectory against one.

    Returns
    -------
    Alignment
        Distance and angle, each of the broadcast shape ``(...)``.
    """
    pairs = np.broadcast_shapes(shape_a.shape[:-2], shape_b.shape[:-2])
    a, b = (_paired_shapes(shape, pairs) for shape in (shape_a, shape_b))
    distance, angle = np.empty(math.prod(pairs)), np.empty(math.prod(pairs))
    align(a, b, arc_weights(shape_a.shape[-2]), distance, angle)
    return Alignment(distance.reshape(pairs), angle.reshape(pairs))


def _paired_shapes(shape: Array, pairs: tuple[int, ...]) -> Array:
    """Return one shape for each pair, in order, or a single shape common to all pairs."""
    if shape.ndim > 2 and shape.shape[:-2] != pairs:
        shape = np.broadcast_to(shape, (*pairs, *shape.shape[-2:]))
    return as_shapes(shape)


def fixed_distance(shape_a: Array, shape_b: Array) -> Alignment:
    """Return the distance between two shapes without a rotation.

    For bodies without rotational symmetry.

    Parameters
    ----------
    shape_a, shape_b
        As in `aligned_distance`.

    Returns
    -------
    Alignment
        As in `aligned_distance`, with the angle 0.
    """
    weights = arc_weights(shape_a.shape[-2])
    square = np.sum(weights * np.sum((shape_a - shape_b) ** 2, axis=-1), axis=-1)
    return Alignment(distance=np.asarray(np.sqrt(square)), angle=np.zeros(square.shape))


#: Type of `aligned_distance` and `fixed_distance`.
Compare = Callable[[Array, Array], Alignment]


def largest_distance(shapes: Array, shape: Array, compare: Compare) -> float:
    """Return the largest distance of shapes from one shape.

    Distances without angles take half the time, which counts in sweeps.

    Parameters
    ----------
    shapes
        Node positions [L], shape ``(m, N + 1, 3)``.
    shape
        Node positions [L], shape ``(N + 1, 3)``.
    compare
        `aligned_distance` or `fixed_distance`.

    Returns
    -------
    float
        At least 0 [L].
    """
    if compare is aligned_distance:
        reference = np.ascontiguousarray(shape)
        return float(
            largest_aligned_distance(as_shapes(shapes), reference, arc_weights(len(shape)))
        )
    return float(np.max(compare(shapes, shape).distance))


def comparison(*, axisymmetric: bool) -> Compare:
    """Return the distance that suits a body.

    Parameters
    ----------
    axisymmetric
        True if rotations about z map motions of the body to motions of the body.

    Returns
    -------
    Compare
        `aligned_distance` for such a body, `fixed_distance` for others.
    """
    return aligned_distance if axisymmetric else fixed_distance
