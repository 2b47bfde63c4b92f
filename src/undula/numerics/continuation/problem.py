"""Protocols of a problem r(u; p) = 0, its linearisation, and a constrained differential equation.

They state all that Newton's method, continuation and periodic orbits use. A problem returns its
residual together with its linearisation, which solves systems bordered by one column and one row,

    [ J      column ] [ x ]   [ right ]
    [ row'   corner ] [ y ] = [ last  ],

accurately even where J itself is singular, as at a fold.
"""

from dataclasses import dataclass
from typing import Any, Protocol, Self

import numpy as np

from undula.arrays import Array


class Linear(Protocol):
    """The linearisation of a problem at a point."""

    def solve(
        self, column: Array, row: Array, corner: float, right: Array, last: float
    ) -> tuple[Array, float]:
        """Return x (m,) and y of the bordered system."""


@dataclass(frozen=True)
class Evaluation:
    """A problem at a point (u, p).

    Attributes
    ----------
    residual : ndarray of shape (m,)
        The value r(u; p).
    linear : Linear
        Its derivative by u.
    by_parameter : ndarray of shape (m,)
        Its derivative by p.
    """

    residual: Array
    linear: Linear
    by_parameter: Array


class Problem(Protocol):
    """Equations r(u; p) = 0 in m unknowns and one parameter."""

    @property
    def weights(self) -> Array:
        """Weights (m,) of the norm: a sum of squares that is about 1 for a large change of u."""

    def evaluate(self, u: Array, p: float) -> Evaluation:
        """Return residual and derivatives at (u, p)."""

    def with_reference(self, u: Array) -> Self:
        """Return the problem with the phases of its symmetries fixed by the solution u."""


@dataclass(frozen=True)
class DenseLinear:
    """A linearisation as a dense matrix (m, m)."""

    matrix: Array

    def solve(
        self, column: Array, row: Array, corner: float, right: Array, last: float
    ) -> tuple[Array, float]:
        """Return x (m,) and y of the bordered system."""
        bordered = np.block([[self.matrix, column[:, None]], [row[None, :], np.array([[corner]])]])
        solution = np.linalg.solve(bordered, np.append(right, last))
        return solution[:-1], float(solution[-1])


class Equations(Protocol):
    """A differential equation with constraints, R(x) dx/dt = f(x, z), 0 = g(x, z), y = (x, z).

    See `undula.numerics.integration.system`; positions x and multipliers z are interleaved in y
    (n,).
    """

    @property
    def half_bandwidth(self) -> int:
        """Half-bandwidth b of the matrices."""

    @property
    def differential(self) -> Any:
        """True at positions and differential rows, False at multipliers and constraints, (n,)."""

    def residual(self, y: Array, w: Array) -> Array:
        """Return R(x) w - f(x, z) and g(x, z), shape (n,), for velocities w (n,)."""

    def parts(self, y: Array, w: Array, turn: float) -> tuple[Array, Array]:
        """Return bands (n, 2 b + 1) of d residual / dy and of R.

        The first is taken at fixed w, plus `turn` R S, with the generator S of the rotation, for a
        w that rotates with the system. Rows of R that belong to constraints are 0. Layout:
        band[i, j - i + b] = matrix[i, j].
        """

    def displacements(self, y: Array) -> Array:
        """Return an orthonormal basis (n, k) of small displacements that the constraints allow."""
