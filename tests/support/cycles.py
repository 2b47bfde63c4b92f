"""Systems with exactly known periodic orbits, as `flows` has them.

Row of Stuart & Landau's oscillators z_i, each drawn to its neighbours, unknowns (Re z, Im z):

    z_i' = (m - |z_i|^2) z_i + i (W + b |z_i|^2) z_i + k sum (z_neighbour - z_i);

together they run as z = sqrt(m) exp(i (W + b m) t), and their multipliers are exp(-k e_j T) and
exp(-(2 m + k e_j) T) with the eigenvalues e_j of the row's Laplacian.

Globe, a point on the unit sphere drawn to a circle of latitude, unknowns (x, y, z, l):

    x' = W (1 + a x) e_z x x + c (z0 - z) (e_z - z x) + K x + l x,    |x| = 1;

it runs around z = z0, l = -K in T = 2 pi / (W sqrt(1 - a^2 r^2)), r^2 = 1 - z0^2, with the
multiplier exp(-c r^2 T).

Carousel, Stuart & Landau's oscillator z = (r - 3) + i h in cylindrical coordinates (r, angle, h):

    angle' = W + a (r - 3);

it repeats itself after the oscillator's period T, turned about the axis by W T.
"""

from dataclasses import dataclass

import numpy as np

from flows import Written
from undula.arrays import Array


@dataclass(frozen=True)
class Row(Written):
    """A row of `count` oscillators, with half-bandwidth 2."""

    growth: float = 1.0  # m
    turning: float = 2.0  # W
    twist: float = 0.5  # b
    pull: float = 0.3  # k
    count: int = 1

    @property
    def size(self) -> int:  # type: ignore[override]
        return 2 * self.count

    @property
    def half_bandwidth(self) -> int:
        return 1 if self.count == 1 else 2

    @property
    def laplacian(self) -> Array:
        apart = np.diff(np.eye(self.count), axis=0)
        return apart.T @ apart

    @property
    def period(self) -> float:
        return 2.0 * np.pi / (self.turning + self.twist * self.growth)

    @property
    def rates(self) -> Array:
        """The exact logarithms of the multipliers over T but for the trivial one, falling."""
        pulls = self.pull * np.linalg.eigvalsh(self.laplacian)
        return np.sort(np.concatenate([-pulls[1:], -2.0 * self.growth - pulls]))[::-1]

    def on_orbit(self) -> Array:
        return np.tile([np.sqrt(self.growth), 0.0], self.count)

    def residual(self, y: Array, w: Array) -> Array:
        z = y[::2] + 1j * y[1::2]
        square = np.abs(z) ** 2
        rate = (self.growth - square + 1j * (self.turning + self.twist * square)) * z
        rate = rate - self.pull * self.laplacian @ z
        return w - np.stack([rate.real, rate.imag], axis=1).ravel()

    def slope(self, y: Array) -> Array:
        slope = self.pull * np.kron(self.laplacian, np.eye(2))
        for i, z in enumerate(y.reshape(-1, 2)):
            square = z @ z
            turn = np.array([[0.0, -1.0], [1.0, 0.0]])
            here = (self.growth - square) * np.eye(2) + (self.turning + self.twist * square) * turn
            here += np.outer(2.0 * (self.twist * turn @ z - z), z)
            slope[2 * i : 2 * i + 2, 2 * i : 2 * i + 2] -= here
        return slope


@dataclass(frozen=True)
class Globe(Written):
    latitude: float = 0.6  # z0
    turning: float = 1.5  # W
    unevenness: float = 0.7  # a
    draw: float = 0.4  # c
    stiffness: float = 20.0  # K
    multipliers = (3,)
    size = 4

    @property
    def radius(self) -> float:
        return float(np.sqrt(1.0 - self.latitude**2))

    @property
    def period(self) -> float:
        return 2.0 * np.pi / (self.turning * np.sqrt(1.0 - (self.unevenness * self.radius) ** 2))

    @property
    def rate(self) -> float:
        return -self.draw * self.radius**2

    def on_orbit(self) -> Array:
        return np.array([self.radius, 0.0, self.latitude, -self.stiffness])

    def residual(self, y: Array, w: Array) -> Array:
        x, up = y[:3], np.array([0.0, 0.0, 1.0])
        rate = self.turning * (1.0 + self.unevenness * x[0]) * np.cross(up, x)
        rate += self.draw * (self.latitude - x[2]) * (up - x[2] * x) + (self.stiffness + y[3]) * x
        return np.append(w[:3] - rate, 0.5 * (x @ x - 1.0))

    def slope(self, y: Array) -> Array:
        x, up = y[:3], np.array([0.0, 0.0, 1.0])
        turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
        slope = np.zeros((4, 4))
        change = self.turning * (1.0 + self.unevenness * x[0]) * turn
        change += self.turning * self.unevenness * np.outer(turn @ x, [1.0, 0.0, 0.0])
        change -= self.draw * np.outer(up - x[2] * x, up)
        change -= self.draw * (self.latitude - x[2]) * (x[2] * np.eye(3) + np.outer(x, up))
        change += (self.stiffness + y[3]) * np.eye(3)
        slope[:3, :3], slope[:3, 3], slope[3, :3] = -change, -x, x
        return slope

    def displacements(self, y: Array) -> Array:
        basis = np.zeros((4, 2))
        basis[:3] = np.linalg.svd(y[None, :3])[2][1:].T
        return basis


@dataclass(frozen=True)
class Carousel(Written):
    turning: float = 0.9  # W
    shear: float = 0.4  # a
    oscillator: Row = Row()
    size = 3

    @property
    def period(self) -> float:
        return self.oscillator.period

    def on_orbit(self) -> Array:
        return np.array([3.0 + np.sqrt(self.oscillator.growth), 0.0, 0.0])

    def residual(self, y: Array, w: Array) -> Array:
        return w - self._rate(y)

    def _rate(self, y: Array) -> Array:
        r = np.hypot(y[0], y[1])
        shape = -self.oscillator.residual(np.array([r - 3.0, y[2]]), np.zeros(2))
        out, around = np.array([y[0], y[1]]) / r, np.array([-y[1], y[0]])
        return np.append(
            shape[0] * out + (self.turning + self.shear * (r - 3.0)) * around, shape[1]
        )

    def slope(self, y: Array) -> Array:
        r = np.hypot(y[0], y[1])
        shape = -self.oscillator.residual(np.array([r - 3.0, y[2]]), np.zeros(2))
        slope = -self.oscillator.slope(np.array([r - 3.0, y[2]]))
        out, around = np.array([y[0], y[1]]) / r, np.array([-y[1], y[0]])
        change = np.zeros((3, 3))
        bent = (np.eye(2) - np.outer(out, out)) / r
        change[:2, :2] = slope[0, 0] * np.outer(out, out) + shape[0] * bent
        change[:2, :2] += self.shear * np.outer(around, out)
        change[:2, :2] += (self.turning + self.shear * (r - 3.0)) * np.array([[0, -1], [1, 0]])
        change[:2, 2] = slope[0, 1] * out
        change[2, :2], change[2, 2] = slope[1, 0] * out, slope[1, 1]
        return -change


def turned(y: Array, angle: float) -> Array:
    """Return y turned about the third axis."""
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.array([cosine * y[0] - sine * y[1], sine * y[0] + cosine * y[1], *y[2:]])


def turning(y: Array) -> Array:
    """Return the derivative of y turned by an angle."""
    return np.array([-y[1], y[0], *np.zeros(y.size - 2)])
