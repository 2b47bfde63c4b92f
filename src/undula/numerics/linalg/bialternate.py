"""All parameters at which eigenvalues of a small pencil cancel or meet, at once.

For the pencil K(p) + sigma M with K(p) = K0 + p K1 consider antisymmetric matrices T.

- Crossings. T -> K T M' + M T K' is singular exactly where sigma_i + sigma_j = 0 for some pair:
  at a complex pair on the imaginary axis, or at two real ones of opposite sign. It is linear in p,
  so that 1/p are the eigenvalues of one matrix of size n (n - 1) / 2.
- Coalescences. With A = -M^-1 K, T -> A^2 T + T A'^2 - 2 A T A' has the eigenvalues
  (sigma_i - sigma_j)^2, so that it is singular exactly where two eigenvalues meet. It is quadratic
  in p, which doubles the size.

Nothing is scanned and nothing can be stepped over; what limits the answer is how well n functions
stand for the whole problem, so it serves as a start for `undula.numerics.linalg.critical_points`.

Source: the bialternate product, Fuller (1968), J. Math. Anal. Appl. 23, 71; Govaerts (2000),
Numerical Methods for Bifurcations of Dynamical Equilibria, chapter 4.
"""

from typing import Any

import numpy as np

from undula.arrays import Array, ComplexArray
from undula.numerics.linalg.pencil import LinearPencil, eigenvalues

# Round-off splits a root off the real axis by about the root of the machine precision at worst.
_REAL = 1e-6
# It splits two that meet by the root of the error of p, which their ill-conditioned map enlarges.
_TOGETHER = 0.1


def crossings(pencil: LinearPencil) -> list[tuple[float, float]]:
    """Return (p, omega), p > 0 rising, wherever a pair +- i omega lies on the imaginary axis."""
    if pencil.mass.shape[0] < 2:
        return []
    base = _wedge(pencil.base, pencil.mass)
    change = _wedge(pencil.change, pencil.mass)
    found = []
    for p in _positive_real(np.linalg.eigvals(-np.linalg.solve(base, change))):
        values = eigenvalues(pencil.stiffness(p), pencil.mass)
        swinging = values[values.imag > 0.0]
        if swinging.size:
            nearest = swinging[np.argmin(np.abs(swinging.real) / np.abs(swinging))]
            if abs(nearest.real) < _REAL * abs(nearest):
                found.append((p, float(nearest.imag)))
    return found


def coalescences(pencil: LinearPencil) -> list[tuple[float, float]]:
    """Return (p, sigma), p > 0 rising, wherever two real eigenvalues meet at sigma."""
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
    found = [
        (p, _meeting(eigenvalues(pencil.stiffness(p), pencil.mass)))
        for p in _positive_real(np.linalg.eigvals(companion))
    ]
    return [(p, sigma) for p, sigma in found if sigma is not None]


def _rates(mass: Array, stiffness: Array) -> Array:
    return -np.asarray(np.linalg.solve(mass, stiffness), dtype=np.float64)


def _wedge(a: Array, b: Array) -> Array:
    """Return T -> A T B' + B T A' on antisymmetric matrices."""
    i, j = np.triu_indices(a.shape[0], 1)

    def minors(p: Array, q: Array) -> Array:
        return p[np.ix_(i, i)] * q[np.ix_(j, j)] - p[np.ix_(i, j)] * q[np.ix_(j, i)]

    return np.asarray(minors(a, b) + minors(b, a))


def _difference_squared(a: Array, b: Array) -> Array:
    """Return the bilinear form whose square is T -> A^2 T + T A'^2 - 2 A T A'."""
    one = np.eye(a.shape[0])
    return 0.5 * _wedge(a @ b + b @ a, one) - _wedge(a, b)


def _positive_real(inverse: Any) -> list[float]:
    """Return the parameters p > 0, rising, of real inverse ones."""
    sizeable = np.abs(inverse) > inverse.size * np.finfo(float).eps * np.abs(inverse).max()
    real = sizeable & (np.abs(inverse.imag) < _REAL * np.abs(inverse)) & (inverse.real > 0.0)
    return sorted(float(p) for p in 1.0 / inverse.real[real])


def _meeting(values: ComplexArray) -> float | None:
    """Return the middle of the two that differ least for their size; None if none are near."""
    i, j = np.triu_indices(values.size, 1)
    middle, half = 0.5 * (values[i] + values[j]), 0.5 * np.abs(values[i] - values[j])
    near = (middle.imag == 0.0) & (half < _TOGETHER * np.abs(middle))
    if not near.any():
        return None
    closest = np.argmin(half[near] / np.abs(middle[near]))
    return float(middle[near][closest].real)
