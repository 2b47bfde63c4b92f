"""Eigenvalues of the straight filament, found in ways that the package does not use."""

from collections.abc import Callable

import numpy as np
import scipy.linalg as sl
from numpy.polynomial import Polynomial, legendre
from numpy.polynomial.chebyshev import Chebyshev
from scipy.integrate import solve_ivp

from undula.arrays import Array, ComplexArray
from undula.models.loads.analytic import Load
from undula.numerics.linalg.pencil import eigenvalues


def zero(function: Callable[[float, float], complex], start: tuple[float, float]) -> Array:
    """Return where a complex function of two numbers vanishes, by Newton's method."""
    x = np.array(start)
    for _ in range(8):
        by = []
        for change in np.diag(1e-7 * x):
            difference = function(*(x + change)) - function(*(x - change))
            by.append(difference / (2.0 * change.sum()))
        jacobian = np.array([[d.real for d in by], [d.imag for d in by]])
        value = function(*x)
        x = x - np.linalg.solve(jacobian, [value.real, value.imag])
    return x


def tip_determinant(force: float, sigma: complex) -> complex:
    """Return what vanishes if sigma is an eigenvalue under a tip load, where Lambda = -F.

    With the roots +-k, +-l of k^4 + F k^2 + sigma = 0 the clamp leaves cosh ks - cosh ls and
    (sinh ks) / k - (sinh ls) / l; this is the determinant of their y'' and y''' at s = 1.
    """
    root = np.sqrt(force**2 - 4.0 * sigma + 0j)
    k, q = np.sqrt(0.5 * (-force + root)), np.sqrt(0.5 * (-force - root))
    waves = 2.0 * sigma * np.cosh(k) * np.cosh(q) + force * k * q * np.sinh(k) * np.sinh(q)
    return complex(force**2 - 2.0 * sigma - waves)


def point_determinant(force: float, sigma: complex, position: float) -> complex:
    """Return the like for a point load; y, y', y'', y''' are continuous at its place."""

    def across(tension: float, length: float) -> ComplexArray:
        matrix = np.diag(np.ones(3, dtype=complex), 1)
        matrix[3, 0], matrix[3, 2] = -sigma, tension
        return np.asarray(sl.expm(length * matrix))

    whole = across(0.0, 1.0 - position) @ across(-force, position)
    return complex(np.linalg.det(whole[2:, 2:]))


def uniform_determinant(force: float, sigma: complex) -> complex:
    """Return the like for a uniform load, by integration from the clamp to the tip."""

    def along(s: float, y: ComplexArray) -> ComplexArray:
        y, y1, y2, y3 = y.reshape(4, 2)
        return np.concatenate([y1, y2, y3, -force * (1.0 - s) * y2 - sigma * y])

    start = np.eye(4, dtype=complex)[:, 2:].ravel()
    solved = solve_ivp(along, (0.0, 1.0), start, method="DOP853", rtol=1e-12, atol=1e-13)
    return complex(np.linalg.det(solved.y[:, -1].reshape(4, 2)[2:]))


def by_integral_equation(load: Load, count: int = 30) -> ComplexArray:
    """Return the eigenvalues under a load, by falling real part, from an integral equation.

    u = y'' obeys u'' = Lambda u - sigma y with u(1) = u'(1) = 0. With S, the integral from 0, and
    T, the integral up to 1: u = T T (Lambda u - sigma S S u). Both are taken exactly of the
    polynomials through Gauss points on each piece of the load.
    """
    x, weight = legendre.leggauss(count)
    lagrange = np.linalg.inv(legendre.legvander(x, count - 1))
    within = legendre.legval(x, legendre.legint(lagrange, lbnd=-1)).T
    edges = np.array([0.0, *load.breaks, 1.0])
    half = 0.5 * np.diff(edges)
    s = (edges[:-1, None] + half[:, None] * (x + 1.0)).ravel()
    whole = np.tile((half[:, None] * weight).ravel(), (s.size, 1))
    earlier = np.kron(np.tri(half.size, k=-1), np.ones((count, count)))
    below = np.kron(np.diag(half), within) + earlier * whole
    beyond = whole - below
    tension = load.force_below(s) - load.force
    mass = beyond @ beyond @ below @ below
    # Shifted by 1, as a strongly pulled tip has an eigenvalue that is nearly 0.
    shifted = np.eye(s.size) - beyond @ beyond * tension + mass
    inverse = np.linalg.eigvals(np.linalg.solve(shifted, mass))
    values = 1.0 - 1.0 / inverse[np.abs(inverse) > 1e-13 * np.abs(inverse).max()]
    return np.asarray(values[np.lexsort((-values.imag, -values.real))])


def of_the_curvature(tension: Array, *, printed: bool) -> ComplexArray:
    """Return eigenvalues of the equation for the curvature, by collocation.

    kappa'''' - (Lambda kappa)'' + sigma kappa = 0, or as printed with Lambda kappa'' in the middle;
    Lambda is a polynomial (tension). kappa = kappa' = 0 at the tip; at the clamp y'''' = Lambda y''
    and its derivative, as y = y' = 0.
    """
    size = 28
    stretch = Polynomial(tension)
    points = 0.5 + 0.5 * np.cos(np.pi * (np.arange(size - 4) + 0.5) / (size - 4))
    stiffness, mass = np.zeros((2, size, size))
    for k in range(size):
        kappa = Chebyshev.basis(k, domain=[0.0, 1.0])
        loaded = stretch * kappa.convert(kind=Polynomial)
        at = points
        middle = stretch(at) * kappa.deriv(2)(at) if printed else loaded.deriv(2)(at)
        clamp = [kappa.deriv(2 + m)(0.0) - (loaded.deriv(m) if m else loaded)(0.0) for m in (0, 1)]
        stiffness[:, k] = [*(kappa.deriv(4)(at) - middle), kappa(1.0), kappa.deriv(1)(1.0), *clamp]
        mass[: size - 4, k] = kappa(at)
    values = eigenvalues(stiffness, mass)
    # Conditions at the ends have no mass: their eigenvalues are infinite but for round-off.
    return values[np.abs(values) < 1e8]
