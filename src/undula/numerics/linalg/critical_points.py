"""Newton's method on parameters at which a pencil is singular in a prescribed way.

The matrix A = K(p) + sigma M, bordered by two vectors,

    [ A   b ] [ c ]   [ 0 ]
    [ l'  0 ] [ g ] = [ 1 ]

is regular where A is singular with a simple null vector, and g vanishes exactly there. Derivatives
of g follow from the same factors: with w the solution of the adjoint system, g_x = -w' A_x c. The
borders are turned towards the null vectors as these become known.

Source: Griewank & Reddien (1983), IMA J. Numer. Anal. 3, 295; Govaerts (2000), Numerical Methods
for Bifurcations of Dynamical Equilibria, chapter 3.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.linalg as sl

from undula.arrays import Array, ComplexArray
from undula.numerics.linalg.pencil import Pencil

_MOST_STEPS = 40
# Quadratic convergence: a step this small, relative to the unknown, leaves nothing but round-off.
_SMALL_STEP = 1e-9
# The borders are turned this often before the first step: without, a guess that is 5 per cent off
# is often too far; with more it makes no difference.
_FIRST_TURNS = 2


@dataclass(frozen=True)
class CriticalPair:
    """A complex pair +- i omega of a pencil, at the parameter at which it crosses the axis.

    Attributes
    ----------
    p, omega : float
        Parameter and imaginary part.
    slope : float
        Change of the real part with the parameter.
    vector : ndarray of shape (n,)
        Null vector c of K(p) + i omega M.
    round_off : float
        Bound on the error of p by round-off.
    """

    p: float
    omega: float
    slope: float
    vector: ComplexArray
    round_off: float


@dataclass(frozen=True)
class Coalescence:
    """Two real eigenvalues of a pencil that meet at sigma, at the parameter p."""

    p: float
    sigma: float
    round_off: float


def refine_crossing(pencil: Pencil, p: float, omega: float) -> CriticalPair | None:
    """Return the crossing near a guess; None if Newton's method finds none with p, omega > 0."""
    mass = pencil.mass
    border = None
    for _ in range(_MOST_STEPS):
        stiffness, slope = pencil.stiffness(p), pencil.slope(p)
        if not np.isfinite(stiffness + slope).all():
            return None
        matrix = stiffness + 1j * omega * mass
        border = border or _Border(matrix)
        bordered = border.around(matrix)
        by_p, by_omega = bordered.change(slope), bordered.change(1j * mass)
        jacobian = np.array([[by_p.real, by_omega.real], [by_p.imag, by_omega.imag]])
        step = _newton_step(jacobian, np.array([bordered.g.real, bordered.g.imag]))
        p, omega = p + float(step[0]), omega + float(step[1])
        if not (p > 0.0 and omega > 0.0 and np.isfinite(p + omega)):
            return None
        by_sigma = bordered.change(mass)
        rate_by_p = -by_p / by_sigma
        noise = bordered.noise(np.abs(stiffness) + omega * np.abs(mass)) / abs(by_sigma)
        spread = float(noise / abs(rate_by_p.real))
        # Of a stiff pencil round-off may leave less than a small step asks for.
        small = abs(step[0]) < max(_SMALL_STEP * p, spread)
        if small and abs(step[1]) < max(_SMALL_STEP * omega, noise):
            return CriticalPair(p, omega, float(rate_by_p.real), bordered.c, spread)
    return None


def refine_coalescence(pencil: Pencil, p: float, sigma: float) -> Coalescence | None:
    """Return the coalescence near a guess; None if Newton's method finds none with p > 0."""
    mass = pencil.mass
    border = None
    for _ in range(_MOST_STEPS):
        stiffness, slope = pencil.stiffness(p), pencil.slope(p)
        if not np.isfinite(stiffness + slope).all():
            return None
        matrix = stiffness + sigma * mass
        border = border or _Border(matrix)
        bordered = border.around(matrix)
        by_p, by_sigma = bordered.change(slope), bordered.change(mass)
        c_by_p, c_by_sigma = bordered.answer(slope), bordered.answer(mass)
        twice = 2.0 * bordered.product(mass @ c_by_sigma)
        mixed = bordered.product(mass @ c_by_p + slope @ c_by_sigma)
        jacobian = np.real([[by_p, by_sigma], [mixed, twice]])
        step = _newton_step(jacobian, np.real([bordered.g, by_sigma]))
        p, sigma = p + float(step[0]), sigma + float(step[1])
        if not (p > 0.0 and np.isfinite(p + sigma)):
            return None
        if abs(step[0]) < _SMALL_STEP * p and abs(step[1]) < _SMALL_STEP * abs(sigma):
            noise = bordered.noise(np.abs(stiffness) + abs(sigma) * np.abs(mass))
            return Coalescence(p, sigma, float(noise / abs(by_p)))
    return None


def _newton_step(jacobian: Array, values: Array) -> Array:
    """Return the step to where the values vanish; NaN where they do not change."""
    try:
        return np.asarray(np.linalg.solve(jacobian, -values))
    except np.linalg.LinAlgError:
        return np.full(values.shape, np.nan)


class _Border:
    """The two border vectors, turned towards the null vectors from one step to the next."""

    def __init__(self, matrix: Any) -> None:
        size = matrix.shape[0]
        # Any vectors that are not orthogonal to the null vectors will do; these hardly ever are.
        self.column: Any = np.cos(np.arange(size)) / np.sqrt(size)
        self.row: Any = np.sin(1.0 + np.arange(size)) / np.sqrt(size)
        for _ in range(_FIRST_TURNS):
            self.around(matrix)

    def around(self, matrix: Any) -> _Bordered:
        bordered = _Bordered(matrix, self.column, self.row)
        self.row = bordered.c / np.linalg.norm(bordered.c)
        self.column = bordered.w / np.linalg.norm(bordered.w)
        return bordered


class _Bordered:
    """A factored bordered matrix with its two solutions c, g and w."""

    def __init__(self, matrix: Any, column: Any, row: Any) -> None:
        size = matrix.shape[0]
        whole = np.zeros((size + 1, size + 1), dtype=np.result_type(matrix, column, row))
        whole[:size, :size], whole[:size, size], whole[size, :size] = matrix, column, row.conj()
        self._factors = sl.lu_factor(whole)
        last = np.zeros(size + 1)
        last[size] = 1.0
        right = sl.lu_solve(self._factors, last)
        left = sl.lu_solve(self._factors, last, trans=2)
        self.c, self.g, self.w = right[:size], right[size], left[:size]

    def product(self, vector: Any) -> Any:
        """Return the derivative of g that belongs to a change A_x c of the equations."""
        return -np.vdot(self.w, vector)

    def change(self, matrix: Any) -> Any:
        """Return the derivative of g if A changes by `matrix`."""
        return self.product(matrix @ self.c)

    def answer(self, matrix: Any) -> Any:
        """Return the derivative of c if A changes by `matrix`."""
        return sl.lu_solve(self._factors, np.append(-(matrix @ self.c), 0.0))[:-1]

    def noise(self, sizes: Array) -> float:
        """Return by how much g may be off if entries of these sizes are rounded."""
        spread = np.abs(self.w) @ sizes @ np.abs(self.c)
        return float(np.finfo(float).eps * spread)
