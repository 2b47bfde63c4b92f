"""Equations for solvers of states with exact solutions, in plain numpy.

Follower (Prothero & Robinson), unknowns (u, s):

    u' = -K (u - cos s) - sin s,    s' = 1;    u = cos t.

Bead drawn along the unit circle after a moving point, unknowns (x, y, l, s), with p = sin s:

    x' = K (cos p, sin p) + (cos s) J x + l x,    |x| = 1,    s' = 1;    x = (cos p, sin p), l = -K.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np

from undula.arrays import Array


def banded(matrix: Array, half: int) -> Array:
    """Return the bands (n, 2 half + 1) of a matrix (n, n), which must have none beyond."""
    n = matrix.shape[0]
    band = np.zeros((n, 2 * half + 1))
    for i in range(n):
        for j in range(n):
            if abs(j - i) <= half:
                band[i, j - i + half] = matrix[i, j]
            else:
                assert matrix[i, j] == 0.0
    return band


class Written(ABC):
    """What systems have in common that give a residual w - f and its derivative by y, `slope`."""

    multipliers: tuple[int, ...] = ()
    size = 2

    @abstractmethod
    def residual(self, y: Array, w: Array) -> Array:
        """Return w - f and the constraints."""

    @abstractmethod
    def slope(self, y: Array) -> Array:
        """Return the derivative of the residual by y."""

    @property
    def drag(self) -> Array:
        return np.diag(self.differential.astype(float))

    @property
    def half_bandwidth(self) -> int:
        return self.size - 1

    @property
    def differential(self) -> Array:
        moving = np.ones(self.size, dtype=bool)
        moving[list(self.multipliers)] = False
        return moving

    def parts(self, y: Array, w: Array, turn: float) -> tuple[Array, Array]:
        assert turn == 0.0
        assert w.shape == y.shape
        half = self.half_bandwidth
        return banded(self.slope(y), half), banded(self.drag, half)

    def displacements(self, y: Array) -> Array:
        return np.eye(y.size)


@dataclass(frozen=True)
class Follower(Written):
    stiffness: float

    def residual(self, y: Array, w: Array) -> Array:
        u, s = y
        return w - np.array([-self.stiffness * (u - np.cos(s)) - np.sin(s), 1.0])

    def slope(self, y: Array) -> Array:
        stiffness, s = self.stiffness, y[1]
        return np.array([[stiffness, stiffness * np.sin(s) + np.cos(s)], [0.0, 0.0]])


@dataclass(frozen=True)
class Bead(Written):
    stiffness: float
    multipliers = (2,)
    size = 4

    def residual(self, y: Array, w: Array) -> Array:
        a, b, pull, s = y
        p, speed = np.sin(s), np.cos(s)
        draw = self.stiffness * np.array([np.cos(p), np.sin(p)])
        return np.array(
            [
                w[0] - (draw[0] - speed * b + pull * a),
                w[1] - (draw[1] + speed * a + pull * b),
                0.5 * (a * a + b * b - 1.0),
                w[3] - 1.0,
            ]
        )

    def slope(self, y: Array) -> Array:
        a, b, pull, s = y
        p, speed = np.sin(s), np.cos(s)
        draw = self.stiffness * np.array([np.cos(p), np.sin(p)])
        slope = [
            [-pull, speed, -a, draw[1] * speed - np.sin(s) * b],
            [-speed, -pull, -b, -draw[0] * speed + np.sin(s) * a],
            [a, b, 0.0, 0.0],
            [0.0, 0.0, 0.0, 0.0],
        ]
        return np.array(slope)

    def displacements(self, y: Array) -> Array:
        along = np.array([-y[1], y[0], 0.0, 0.0]) / np.hypot(y[0], y[1])
        return np.stack([along, [0.0, 0.0, 0.0, 1.0]], axis=1)


@dataclass(frozen=True)
class VanDerPol(Written):
    """x'' - mu (1 - x^2) x' + x = 0."""

    mu: float

    def residual(self, y: Array, w: Array) -> Array:
        return w - np.array([y[1], self.mu * (1.0 - y[0] ** 2) * y[1] - y[0]])

    def slope(self, y: Array) -> Array:
        x, v = y
        slope = [[0.0, 1.0], [-2.0 * self.mu * x * v - 1.0, self.mu * (1.0 - x * x)]]
        return -np.array(slope)


@dataclass(frozen=True)
class Weighed:
    """The same motion from equations whose differential rows have a weight 2 + sin y_0."""

    plain: Written

    @property
    def half_bandwidth(self) -> int:
        return self.plain.half_bandwidth

    @property
    def differential(self) -> Array:
        return self.plain.differential

    def displacements(self, y: Array) -> Array:
        return self.plain.displacements(y)

    def _weights(self, y: Array) -> Array:
        return np.where(self.differential, 2.0 + np.sin(y[0]), 1.0)

    def residual(self, y: Array, w: Array) -> Array:
        return self._weights(y) * self.plain.residual(y, w)

    def parts(self, y: Array, w: Array, turn: float) -> tuple[Array, Array]:
        assert turn == 0.0
        weights, steeper = self._weights(y)[:, None], np.where(self.differential, np.cos(y[0]), 0.0)
        slope = weights * self.plain.slope(y)
        slope[:, 0] += steeper * self.plain.residual(y, w)
        half = self.half_bandwidth
        return banded(slope, half), banded(weights * self.plain.drag, half)
