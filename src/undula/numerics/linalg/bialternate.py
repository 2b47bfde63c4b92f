"""All parameters at which eigenvalues of a small pencil cancel or coalesce, in one computation.

For the pencil K(p) + sigma M with K(p) = K0 + p K1 consider antisymmetric matrices T.

- Crossings. T -> K T M' + M T K' is singular exactly where sigma_i + sigma_j = 0 for some pair: a
  complex pair on the imaginary axis, or two real eigenvalues of opposite sign. It is linear in p,
  so that the values 1/p are the eigenvalues of one matrix of size n (n - 1) / 2.
- Coalescences. With A = -M^-1 K, T -> A^2 T + T A'^2 - 2 A T A' has the eigenvalues
  (sigma_i - sigma_j)^2, so that it is singular exactly where two eigenvalues coalesce. It is
  quadratic in p, which doubles the size.

No range of p is scanned, so that no parameter is missed. The error is that of the reduction to n
functions; the results are starting points for `undula.numerics.linalg.critical_points`.

Source: the bialternate product, Fuller (1968), J. Math. Anal. Appl. 23, 71; Govaerts (2000),
Numerical Methods for Bifurcations of Dynamical Equilibria, chapter 4.
"""

from typing import Any

import numpy as np

from undula.arrays import Array, ComplexArray
from undula.numerics.linalg.pencil import LinearPencil, eigenvalues

# Largest imaginary part, relative, of a real root: round-off leaves the root of the precision.
_REAL_TOLERANCE = 1e-6
# Largest relative distance of two coalescing eigenvalues: they differ by the root of the error of
# p, and their map is ill-conditioned.
_PAIR_TOLERANCE = 0.1


def crossings(pencil: LinearPencil) -> list[tuple[float, float]]:
    """Return all parameters at which a pair +- i omega lies on the imaginary axis.

    Parameters
    ----------
    pencil : LinearPencil
        A pencil of small size n; the cost is of order n^6.

    Returns
    -------
    list of (float, float)
        (p, omega), p > 0 ascending.
    """
    if pencil.mass.shape[0] < 2:
        return []
    base = _bialternate_product(pencil.base, pencil.mass)
    change = _bialternate_product(pencil.change, pencil.mass)
    pairs = []
    for p in _positive_real(np.linalg.eigvals(-np.linalg.solve(base, change))):
        values = eigenvalues(pencil.stiffness(p), pencil.mass)
        oscillatory = values[values.imag > 0.0]
        if oscillatory.size:
            nearest = oscillatory[np.argmin(np.abs(oscillatory.real) / np.abs(oscillatory))]
            if abs(nearest.real) < _REAL_TOLERANCE * abs(nearest):
                pairs.append((p, float(nearest.imag)))
    return pairs


def coalescences(pencil: LinearPencil) -> list[tuple[float, float]]:
    """Return all parameters at which two real eigenvalues coalesce.

    Parameters
    ----------
    pencil : LinearPencil
        A pencil of small size n; the cost is of order n^6.

    Returns
    -------
    list of (float, float)
        (p, sigma), p > 0 ascending, with the double eigenvalue sigma.
    """
    if pencil.mass.shape[0] < 2:
        return []
    rates = _rates(pencil.mass, pencil.base)
    change = _rates(pencil.mass, pencil.change)
    constant = _difference_squared(rates, rates)
    linear = 2.0 * _difference_squared(rates, change)
    quadratic = _difference_squared(change, change)
    size = constant.shape[0]
    companion = np.eye(2 * size, k=-size)
    companion[:size] = -np.linalg.solve(constant, np.hstack([linear, quadratic]))
    pairs = [
        (p, _closest_midpoint(eigenvalues(pencil.stiffness(p), pencil.mass)))
        for p in _positive_real(np.linalg.eigvals(companion))
    ]
    return [(p, sigma) for p, sigma in pairs if sigma is not None]


def _rates(mass: Array, stiffness: Array) -> Array:
    return -np.asarray(np.linalg.solve(mass, stiffness), dtype=np.float64)


def _bialternate_product(a: Array, b: Array) -> Array:
    """Return the matrix of T -> A T B' + B T A' on antisymmetric matrices."""
    i, j = np.triu_indices(a.shape[0], 1)

    def minors(p: Array, q: Array) -> Array:
        return p[np.ix_(i, i)] * q[np.ix_(j, j)] - p[np.ix_(i, j)] * q[np.ix_(j, i)]

    return np.asarray(minors(a, b) + minors(b, a))


def _difference_squared(a: Array, b: Array) -> Array:
    """Return the bilinear form in A, B that is T -> A^2 T + T A'^2 - 2 A T A' for B = A."""
    identity = np.eye(a.shape[0])
    return 0.5 * _bialternate_product(a @ b + b @ a, identity) - _bialternate_product(a, b)


def _positive_real(inverse: Any) -> list[float]:
    """Return the parameters p > 0, ascending, that belong to real values of 1/p."""
    resolved = np.abs(inverse) > inverse.size * np.finfo(float).eps * np.abs(inverse).max()
    real = (
        resolved & (np.abs(inverse.imag) < _REAL_TOLERANCE * np.abs(inverse)) & (inverse.real > 0.0)
    )
    return sorted(float(p) for p in 1.0 / inverse.real[real])


def _closest_midpoint(values: ComplexArray) -> float | None:
    """Return the mean of the two closest eigenvalues, relatively; None if no two are close."""
    i, j = np.triu_indices(values.size, 1)
    middle, half = 0.5 * (values[i] + values[j]), 0.5 * np.abs(values[i] - values[j])
    near = (middle.imag == 0.0) & (half < _PAIR_TOLERANCE * np.abs(middle))
    if not near.any():
        return None
    closest = np.argmin(half[near] / np.abs(middle[near]))
    return float(middle[near][closest].real)
