"""Gauss quadrature and Legendre polynomials, with their integrals, piecewise on [0, 1]."""

from itertools import pairwise

import numpy as np
from numpy.polynomial import legendre

from undula.arrays import Array, Points


def gauss(edges: Points, count: int) -> tuple[Points, Points]:
    """Return the composite Gauss rule.

    Parameters
    ----------
    edges : ndarray of shape (k + 1,)
        Ends of the pieces, ascending.
    count : int
        Number of points on each piece, at least 1.

    Returns
    -------
    points, weights : ndarray of shape (k count,)
        The rule, exact for piecewise polynomials of degree 2 count - 1.
    """
    x, weight = legendre.leggauss(count)
    half = 0.5 * np.diff(edges)[:, None]
    middle = 0.5 * (edges[1:] + edges[:-1])[:, None]
    return (middle + half * x).ravel(), (half * weight).ravel()


def legendre_elements(edges: Points, degree: int, s: Points) -> tuple[Array, Array]:
    """Return orthonormal Legendre polynomials on elements, and their double integrals from 0.

    Parameters
    ----------
    edges : ndarray of shape (k + 1,)
        Ends of the elements, from 0 to 1.
    degree : int
        Highest degree on each.
    s : ndarray of shape (m,)
        Points in [0, 1], not on an inner edge.

    Returns
    -------
    functions, integrals : ndarray of shape (m, k (degree + 1))
        The polynomials, 0 outside their element, and their integrals taken twice from s = 0.
    """
    functions, integrals = [], []
    for left, right in pairwise(edges):
        h = right - left
        x = 2.0 * (s - left) / h - 1.0
        inside, beyond = (s > left) & (s < right), s >= right
        scale = np.sqrt((2.0 * np.arange(degree + 1) + 1.0) / h)
        p, first, second = _with_integrals(np.where(inside, x, 1.0), degree)
        functions.append(np.where(inside[:, None], scale * p, 0.0))
        # Beyond the element the second integral grows linearly.
        growth = np.where(beyond, s - right, 0.0)[:, None] * first * h / 2.0
        integral = second * h**2 / 4.0 + growth
        integrals.append(np.where((inside | beyond)[:, None], scale * integral, 0.0))
    return np.hstack(functions), np.hstack(integrals)


def _with_integrals(x: Points, degree: int) -> tuple[Array, Array, Array]:
    """Return P_0 .. P_degree at x with their first and second integrals from -1.

    They follow from (2 k + 1) P_k = (P_{k+1} - P_{k-1})', whose bracket vanishes at -1 for k > 0.
    """
    odd = 2.0 * np.arange(degree + 2) + 1.0
    p = np.asarray(legendre.legvander(x, degree + 2), dtype=np.float64)
    first = np.empty((x.size, degree + 2))
    first[:, 0] = x + 1.0
    first[:, 1:] = (p[:, 2:] - p[:, :-2]) / odd[1:]
    second = np.empty((x.size, degree + 1))
    second[:, 0] = 0.5 * (x + 1.0) ** 2
    second[:, 1:] = (first[:, 2:] - first[:, :-2]) / odd[1:-1]
    return p[:, : degree + 1], first[:, : degree + 1], second
