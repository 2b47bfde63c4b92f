"""Coefficients of the collocation methods Radau IIA.

On a step of length h from t the solution is the polynomial of degree s through the value Y_0 at t
and values Y_1, ..., Y_s at t + c_i h, which satisfies the equations at these times. With its
derivatives

    h Y'(t + c_i h) = sum_{j=0..s} D_ij Y_j,    i = 1, ..., s,

a method is the table of its nodes c and of D. The nodes are those of Radau's quadrature with the
end, c_s = 1: roots of P_s(2 c - 1) = P_{s-1}(2 c - 1). The order is 2 s - 1, and is kept by the
positions of a system with constraints (index 2), where multipliers have the order s. The methods
are L-stable and satisfy the constraints at the end of a step, which is a stage.

Source: Hairer, Lubich & Roche (1989), The Numerical Solution of Differential-Algebraic Systems by
Runge-Kutta Methods; Hairer & Wanner (1996), Solving Ordinary Differential Equations II, sections
IV.5 and VII.4.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.polynomial import Legendre

from undula.arrays import Array


@dataclass(frozen=True, eq=False)
class Radau:
    """Table of a method.

    Attributes
    ----------
    nodes : ndarray of shape (s,)
        Nodes c, ascending, the last one 1.
    differentiation : ndarray of shape (s, s + 1)
        The matrix D.
    """

    nodes: Array
    differentiation: Array

    @property
    def stages(self) -> int:
        """Number of stages s."""
        return self.nodes.size

    @property
    def order(self) -> int:
        """Order of the positions."""
        return 2 * self.stages - 1

    @property
    def grid(self) -> Array:
        """The start and the nodes, shape (s + 1,)."""
        return np.append(0.0, self.nodes)

    def times(self, intervals: int) -> Array:
        """Return the times (intervals, s) of all stages as fractions of the whole time."""
        return np.asarray((np.arange(intervals)[:, None] + self.nodes) / intervals)


@cache
def radau(stages: int) -> Radau:
    """Return the method of order 2 s - 1.

    Parameters
    ----------
    stages : int
        Number of stages s, at least 1.

    Returns
    -------
    Radau
        Its table.
    """
    difference = Legendre.basis(stages, domain=[0.0, 1.0]) - Legendre.basis(
        stages - 1, domain=[0.0, 1.0]
    )
    nodes = np.sort(difference.roots().real)
    nodes -= difference(nodes) / difference.deriv()(nodes)  # one Newton step, to round-off
    nodes[-1] = 1.0
    return Radau(nodes, _derivatives(np.append(0.0, nodes))[1:])


def interpolation(grid: Array, points: Array) -> Array:
    """Return the matrix that evaluates the interpolating polynomial of values on a grid.

    Parameters
    ----------
    grid : ndarray of shape (k,)
        Different points at which values are given.
    points : ndarray of shape (m,)
        Points at which the polynomial is evaluated.

    Returns
    -------
    ndarray of shape (m, k)
        The matrix.
    """
    others = ~np.eye(grid.size, dtype=bool)
    columns = [
        np.prod((points[:, None] - grid[rest]) / (grid[j] - grid[rest]), axis=1)
        for j, rest in enumerate(others)
    ]
    return np.stack(columns, axis=1)


def _derivatives(grid: Array) -> Array:
    """Return the differentiation matrix (k, k) of the interpolating polynomial on a grid (k,)."""
    differences = grid[:, None] - grid + np.eye(grid.size)
    product = np.prod(differences, axis=1)
    matrix = product[:, None] / product / differences
    np.fill_diagonal(matrix, 0.0)
    # The derivative of a constant is zero.
    np.fill_diagonal(matrix, -matrix.sum(axis=1))
    return np.asarray(matrix)
