"""Matrix pencils that depend on a parameter, and their eigenvalues.

    K(p) c = -sigma M c

Eigenvalues sigma are computed as s - 1/mu from the eigenvalues mu of the shift-inverted matrix
(K + s M)^-1 M with a shift s. The slow eigenvalues, which decide on stability, then have the
largest |mu|, and are accurate even where M is compact and most of its own spectrum is lost in
round-off. Without a shift, an eigenvalue close to 0 would spoil the accuracy of all others.
"""

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
import scipy.linalg as sl

from undula.arrays import Array, ComplexArray

# A slow rate that is not likely to be an eigenvalue.
_SHIFT = 0.8414709848078965


class Pencil(Protocol):
    """A real pencil K(p) + sigma M; all matrices are of shape (n, n)."""

    @property
    def mass(self) -> Array:
        """The matrix M."""

    def stiffness(self, p: float) -> Array:
        """Return K(p)."""

    def slope(self, p: float) -> Array:
        """Return dK/dp."""


@dataclass(frozen=True)
class LinearPencil:
    """A pencil whose stiffness K(p) = base + p change is linear in the parameter.

    Attributes
    ----------
    base, change, mass : ndarray of shape (n, n)
        The three matrices.
    """

    base: Array
    change: Array
    mass: Array

    def stiffness(self, p: float) -> Array:
        """Return K(p)."""
        return self.base + p * self.change

    def slope(self, p: float) -> Array:  # noqa: ARG002
        """Return dK/dp, which is constant."""
        return self.change


def eigenvalues(stiffness: Array, mass: Array) -> ComplexArray:
    """Return the eigenvalues of K c = -sigma M c that are resolved from round-off.

    Parameters
    ----------
    stiffness, mass : ndarray of shape (n, n)
        K and M.

    Returns
    -------
    ndarray of shape (m,)
        The values sigma, by descending real part, m <= n.
    """
    mu = np.asarray(np.linalg.eigvals(_shift_inverted(stiffness, mass)), dtype=complex)
    values = _SHIFT - 1.0 / mu[_are_resolved(mu)]
    return np.asarray(values[_by_rate(values)])


def eigenpairs(stiffness: Array, mass: Array) -> tuple[ComplexArray, ComplexArray]:
    """Return the eigenvalues that are resolved from round-off, with their vectors.

    Parameters
    ----------
    stiffness, mass : ndarray of shape (n, n)
        K and M.

    Returns
    -------
    values : ndarray of shape (m,)
        As `eigenvalues` returns.
    vectors : ndarray of shape (n, m)
        Their vectors c as columns.
    """
    mu, vectors = np.linalg.eig(_shift_inverted(stiffness, mass))
    mu, vectors = np.asarray(mu, dtype=complex), np.asarray(vectors, dtype=complex)
    kept = _are_resolved(mu)
    values, vectors = _SHIFT - 1.0 / mu[kept], vectors[:, kept]
    order = _by_rate(values)
    return values[order], vectors[:, order]


def reduced(pencil: Pencil, size: int) -> LinearPencil:
    """Return the projection of a pencil on its slowest eigenvectors at p = 0.

    A stiffness that is not linear in p is replaced by its tangent at p = 0.

    Parameters
    ----------
    pencil : Pencil
        The pencil.
    size : int
        Number of eigenvectors.

    Returns
    -------
    LinearPencil
        Matrices of shape (size, size).
    """
    base, change, mass = pencil.stiffness(0.0), pencil.slope(0.0), pencil.mass
    right, left = _slowest(base, mass, size), _slowest(base.T, mass.T, size)
    return LinearPencil(left.T @ base @ right, left.T @ change @ right, left.T @ mass @ right)


def _slowest(stiffness: Array, mass: Array, size: int) -> Array:
    """Return a real orthonormal basis of the slowest eigenvectors, shape (n, size)."""
    values, vectors = eigenpairs(stiffness, mass)
    slow = vectors[:, np.argsort(np.abs(values))[:size]]
    return np.asarray(sl.orth(np.hstack([slow.real, slow.imag]))[:, :size])


def _shift_inverted(stiffness: Array, mass: Array) -> Any:
    """Return (K + s M)^-1 M."""
    return np.linalg.solve(stiffness + _SHIFT * mass, mass)


def _are_resolved(mu: ComplexArray) -> Any:
    """Return True for each eigenvalue that exceeds round-off."""
    return np.abs(mu) > mu.size * np.finfo(float).eps * np.abs(mu).max()


def _by_rate(values: ComplexArray) -> Any:
    """Return the order by descending real part, then by descending imaginary part."""
    return np.lexsort((-values.imag, -values.real))
