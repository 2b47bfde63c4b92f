"""How the end of a motion is brought back to its start: the symmetry of a (relative) orbit.

A motion repeats itself up to a symmetry if, after a time T,

    Q x(T) = x(0),    Q y = fixed(rotate(y, -angle)),

with a linear map that is known, such as a reflection after half a period, and perhaps a rotation by
an unknown angle, by which the motion has turned during T.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from undula.arrays import Array


@dataclass(frozen=True)
class Rotation:
    """A continuous symmetry.

    Attributes
    ----------
    rotate : function of y (n,) and an angle [rad]
        Returns y turned by the angle, shape (n,).
    generator : function of y (n,)
        Returns S y, the derivative of y turned by an angle, at angle 0.
    """

    rotate: Callable[[Array, float], Array]
    generator: Callable[[Array], Array]


def same(y: Array) -> Array:
    """Return y itself: a motion that repeats itself exactly."""
    return y


@dataclass(frozen=True)
class OrbitSymmetry:
    """The symmetry that brings the end of a motion back to its start.

    Attributes
    ----------
    fixed : function of y (n,)
        A linear map that is known and commutes with the flow, and with the rotation.
    rotation : Rotation or None
        A rotation by an unknown angle; None if there is none.
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
        """Return S y (n,), the velocity of a unit rate of turning; 0 without a rotation."""
        return np.zeros(y.size) if self.rotation is None else self.rotation.generator(y)

    def by_angle(self, y: Array, angle: float) -> Array:
        """Return the derivative of Q y (n,) by the angle; 0 without a rotation."""
        return -self.turning(self.apply(y, angle))
