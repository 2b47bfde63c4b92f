"""Newton's method for parameters at which eigenvalues of a pencil cross the axis or coalesce.

The matrix A = K(p) + sigma M, bordered by two vectors,

    [ A   b ] [ c ]   [ 0 ]
    [ l'  0 ] [ g ] = [ 1 ]

is regular where A is singular with a simple null vector, and g vanishes exactly there. Derivatives
of g follow from the same factors: with w the solution of the adjoint system, g_x = -w' A_x c. The
border (b, l) is updated to the approximate null vectors in each step. A pair of eigenvalues crosses
the axis where g = 0 for sigma = i omega; two coalesce where g = 0 and g_sigma = 0 for a real sigma.

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

_MAX_STEPS = 40
# Relative step after which quadratic convergence leaves only round-off.
_STEP_TOLERANCE = 1e-9
# Updates of the border before the first step. Without them the method often fails from a guess
# with an error of 5 per cent; more of them make no difference.
_INITIAL_UPDATES = 2


@dataclass(frozen=True)
class CriticalPair:
    """A complex pair +- i omega of a pencil on the imaginary axis.

    Attributes
    ----------
    p, omega : float
        Parameter of the crossing, and imaginary part.
    slope : float
        Derivative of the real part by the parameter.
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
    """Two real eigenvalues of a pencil that coalesce.

    Attributes
    ----------
    p, sigma : float
        Parameter, and double eigenvalue.
    round_off : float
        Bound on the error of p by round-off.
    """

    p: float
    sigma: float
    round_off: float


def refine_crossing(pencil: Pencil, p: float, omega: float) -> CriticalPair | None:
    """Return the crossing near a guess.

    Parameters
    ----------
    pencil : Pencil
        The pencil.
    p, omega : float
        Guess of parameter and imaginary part, above 0.

    Returns
    -------
    CriticalPair or None
        The crossing; None if Newton's method does not converge to p, omega > 0.
    """
    mass = pencil.mass
    border = None
    for _ in range(_MAX_STEPS):
        stiffness, stiffness_by_p = pencil.stiffness(p), pencil.slope(p)
        if not np.isfinite(stiffness + stiffness_by_p).all():
            return None
        matrix = stiffness + 1j * omega * mass
        border = border or _Border(matrix)
        bordered = border.factored(matrix)
        by_p, by_omega = bordered.change(stiffness_by_p), bordered.change(1j * mass)
        jacobian = np.array([[by_p.real, by_omega.real], [by_p.imag, by_omega.imag]])
        step = _newton_step(jacobian, np.array([bordered.g.real, bordered.g.imag]))
        p, omega = p + float(step[0]), omega + float(step[1])
        if not (p > 0.0 and omega > 0.0 and np.isfinite(p + omega)):
            return None
        by_sigma = bordered.change(mass)
        rate_by_p = -by_p / by_sigma
        round_off = bordered.round_off(np.abs(stiffness) + omega * np.abs(mass)) / abs(by_sigma)
        p_error = float(round_off / abs(rate_by_p.real))
        # The round-off of a stiff pencil may exceed the tolerance of the step.
        small = abs(step[0]) < max(_STEP_TOLERANCE * p, p_error)
        if small and abs(step[1]) < max(_STEP_TOLERANCE * omega, round_off):
            return CriticalPair(p, omega, float(rate_by_p.real), bordered.c, p_error)
    return None


def refine_coalescence(pencil: Pencil, p: float, sigma: float) -> Coalescence | None:
    """Return the coalescence near a guess.

    Parameters
    ----------
    pencil : Pencil
        The pencil.
    p, sigma : float
        Guess of parameter, above 0, and double eigenvalue.

    Returns
    -------
    Coalescence or None
        The coalescence; None if Newton's method does not converge to p > 0.
    """
    mass = pencil.mass
    border = None
    for _ in range(_MAX_STEPS):
        stiffness, stiffness_by_p = pencil.stiffness(p), pencil.slope(p)
        if not np.isfinite(stiffness + stiffness_by_p).all():
            return None
        matrix = stiffness + sigma * mass
        border = border or _Border(matrix)
        bordered = border.factored(matrix)
        by_p, by_sigma = bordered.change(stiffness_by_p), bordered.change(mass)
        c_by_p = bordered.null_vector_change(stiffness_by_p)
        c_by_sigma = bordered.null_vector_change(mass)
        by_sigma_p = bordered.product(mass @ c_by_p + stiffness_by_p @ c_by_sigma)
        by_sigma_sigma = 2.0 * bordered.product(mass @ c_by_sigma)
        jacobian = np.real([[by_p, by_sigma], [by_sigma_p, by_sigma_sigma]])
        step = _newton_step(jacobian, np.real([bordered.g, by_sigma]))
        p, sigma = p + float(step[0]), sigma + float(step[1])
        if not (p > 0.0 and np.isfinite(p + sigma)):
            return None
        if abs(step[0]) < _STEP_TOLERANCE * p and abs(step[1]) < _STEP_TOLERANCE * abs(sigma):
            round_off = bordered.round_off(np.abs(stiffness) + abs(sigma) * np.abs(mass))
            return Coalescence(p, sigma, float(round_off / abs(by_p)))
    return None


def _newton_step(jacobian: Array, values: Array) -> Array:
    """Return Newton's step; NaN for a singular Jacobian."""
    try:
        return np.asarray(np.linalg.solve(jacobian, -values))
    except np.linalg.LinAlgError:
        return np.full(values.shape, np.nan)


class _Border:
    """The two border vectors, updated to the approximate null vectors in each step."""

    def __init__(self, matrix: Any) -> None:
        size = matrix.shape[0]
        # Any vectors work that are not orthogonal to the null vectors.
        self.column: Any = np.cos(np.arange(size)) / np.sqrt(size)
        self.row: Any = np.sin(1.0 + np.arange(size)) / np.sqrt(size)
        for _ in range(_INITIAL_UPDATES):
            self.factored(matrix)

    def factored(self, matrix: Any) -> _BorderedMatrix:
        """Return the factored bordered matrix; its null vectors are the next border."""
        bordered = _BorderedMatrix(matrix, self.column, self.row)
        self.row = bordered.c / np.linalg.norm(bordered.c)
        self.column = bordered.w / np.linalg.norm(bordered.w)
        return bordered


class _BorderedMatrix:
    """A factored bordered matrix with c and g, and the adjoint solution w."""

    def __init__(self, matrix: Any, column: Any, row: Any) -> None:
        size = matrix.shape[0]
        extended = np.zeros((size + 1, size + 1), dtype=np.result_type(matrix, column, row))
        extended[:size, :size], extended[:size, size] = matrix, column
        extended[size, :size] = row.conj()
        self._factors = sl.lu_factor(extended)
        last = np.zeros(size + 1)
        last[size] = 1.0
        right = sl.lu_solve(self._factors, last)
        left = sl.lu_solve(self._factors, last, trans=2)
        self.c, self.g, self.w = right[:size], right[size], left[:size]

    def product(self, vector: Any) -> Any:
        """Return the derivative of g for a change A_x c (n,) of the equations."""
        return -np.vdot(self.w, vector)

    def change(self, matrix: Any) -> Any:
        """Return the derivative of g for a change of A by `matrix`."""
        return self.product(matrix @ self.c)

    def null_vector_change(self, matrix: Any) -> Any:
        """Return the derivative of c for a change of A by `matrix`."""
        return sl.lu_solve(self._factors, np.append(-(matrix @ self.c), 0.0))[:-1]

    def round_off(self, sizes: Array) -> float:
        """Return a bound on the error of g by round-off of entries of these sizes (n, n)."""
        bound = np.abs(self.w) @ sizes @ np.abs(self.c)
        return float(np.finfo(float).eps * bound)
