"""The symmetry of a (relative) periodic orbit, which maps its end back to its start.

A motion repeats itself up to a symmetry if, after a time T,

    Q x(T) = x(0),    Q y = map(rotate(y, -angle)),

with a given linear map, such as a reflection after half a period, and, optionally, the rotation by
an unknown angle that the motion makes in the time T.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from undula.arrays import Array


@dataclass(frozen=True)
class Rotation:
    """A rotational symmetry.

    Attributes
    ----------
    rotate : function of y (n,) and an angle [rad]
        Returns y rotated by the angle, shape (n,).
    generator : function of y (n,)
        Returns S y, the derivative of the rotated y by the angle, at angle 0.
    """

    rotate: Callable[[Array, float], Array]
    generator: Callable[[Array], Array]


def same(y: Array) -> Array:
    """Return y itself, the map of a motion that repeats itself exactly."""
    return y


@dataclass(frozen=True)
class OrbitSymmetry:
    """The symmetry that maps the end of a motion back to its start.

    Attributes
    ----------
    map : function of y (n,)
        A linear map that commutes with the flow and with the rotation.
    rotation : Rotation or None
        The rotation by an unknown angle; None without a rotation.
    """

    map: Callable[[Array], Array] = same
    rotation: Rotation | None = None

    def apply(self, vectors: Array, angle: float) -> Array:
        """Return Q applied to a vector (n,), or to each column of (n, k)."""
        if vectors.ndim == 2:
            columns = [self.apply(column, angle) for column in vectors.T]
            return np.stack(columns, axis=1) if columns else vectors
        turned = vectors if self.rotation is None else self.rotation.rotate(vectors, -angle)
        return self.map(turned)

    def turning(self, y: Array) -> Array:
        """Return S y (n,), the velocity of a unit rate of rotation; 0 without a rotation."""
        return np.zeros(y.size) if self.rotation is None else self.rotation.generator(y)

    def by_angle(self, y: Array, angle: float) -> Array:
        """Return the derivative of Q y (n,) by the angle; 0 without a rotation."""
        return -self.turning(self.apply(y, angle))
