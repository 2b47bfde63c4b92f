"""The distance between two shapes when a turn about z does not count."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from undula.analysis.observables.shape_sums import align, largest_turned
from undula.analysis.observables.shapes import arc_weights, as_shapes
from undula.arrays import Array


@dataclass(frozen=True)
class Alignment:
    """How far apart two shapes are after the best turn about z.

    Attributes
    ----------
    distance
        RMS over the arc length of the distance between the nodes [L].
    angle
        The turn of the second shape that brings it nearest to the first [rad], in (-pi, pi].
    """

    distance: Array
    angle: Array


def aligned_distance(shape_a: Array, shape_b: Array) -> Alignment:
    """Least distance between two shapes over all turns of the second about the z axis.

    With a and b the transverse positions as complex numbers, the sum of |a - exp(i angle) b|^2 is
    least at the argument of the sum of a times the conjugate of b; heights do not turn. If that sum
    vanishes every turn is as good as any other, and the angle is 0.

    Parameters
    ----------
    shape_a, shape_b
        Node positions [L], shapes ``(..., N + 1, 3)`` that broadcast against each other: one shape
        against one, or a trajectory against one.

    Returns
    -------
    Alignment
        Each part of the shape that is left of ``...``.
    """
    pairs = np.broadcast_shapes(shape_a.shape[:-2], shape_b.shape[:-2])
    a, b = (_whole_or_one(shape, pairs) for shape in (shape_a, shape_b))
    distance, angle = np.empty(math.prod(pairs)), np.empty(math.prod(pairs))
    align(a, b, arc_weights(shape_a.shape[-2]), distance, angle)
    return Alignment(distance.reshape(pairs), angle.reshape(pairs))


def _whole_or_one(shape: Array, pairs: tuple[int, ...]) -> Array:
    """Return all that belong to the pairs, in their order, or the one that belongs to each."""
    if shape.ndim > 2 and shape.shape[:-2] != pairs:
        shape = np.broadcast_to(shape, (*pairs, *shape.shape[-2:]))
    return as_shapes(shape)


def fixed_distance(shape_a: Array, shape_b: Array) -> Alignment:
    """Distance between two shapes as they are, for bodies that no turn takes to themselves.

    Parameters and what is returned are those of `aligned_distance`; the angle is 0.
    """
    weights = arc_weights(shape_a.shape[-2])
    square = np.sum(weights * np.sum((shape_a - shape_b) ** 2, axis=-1), axis=-1)
    return Alignment(distance=np.asarray(np.sqrt(square)), angle=np.zeros(square.shape))


#: How two shapes are compared.
Compare = Callable[[Array, Array], Alignment]


def largest_distance(shapes: Array, shape: Array, compare: Compare) -> float:
    """Return the largest distance of shapes (m, N + 1, 3) from one (N + 1, 3) [L].

    At the points of a study this is asked often: distances alone take half as long as with angles.
    """
    if compare is aligned_distance:
        place = np.ascontiguousarray(shape)
        return float(largest_turned(as_shapes(shapes), place, arc_weights(len(shape))))
    return float(np.max(compare(shapes, shape).distance))


def comparison(*, axisymmetric: bool) -> Compare:
    """Return how shapes of a body are compared: up to turns if these take its motions to others."""
    return aligned_distance if axisymmetric else fixed_distance
