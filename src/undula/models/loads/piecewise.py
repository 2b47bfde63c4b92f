"""Piecewise polynomial densities, and their fit to a function.

A piecewise polynomial is a Chebyshev series on each piece, in x from -1 to 1. The force G(s) below
s is its antiderivative, and the first moment is s G(s) minus the antiderivative of G, by parts. For
a function, pieces are halved until a series of degree 15 represents it to round-off on each.
"""

from collections.abc import Callable
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike

from undula.arrays import Array, Points
from undula.errors import InputError

#: Smallest total, relative to the largest density, that is not round-off of a total of 0.
_MIN_TOTAL = 1e-12
#: Largest error of a series, relative to the largest value of the function.
_TOLERANCE = 1e-13
_MAX_PIECES = 200
#: Shortest piece [L]; a density that needs shorter ones has a kink, a jump or a singularity.
_MIN_PIECE = 2.0**-20

_DEGREE = 15
_NODES = chebyshev.chebpts1(_DEGREE + 1)
#: Matrix from values at the nodes to the series, by discrete orthogonality.
_TO_SERIES = chebyshev.chebvander(_NODES, _DEGREE).T * 2.0 / _NODES.size
_TO_SERIES[0] *= 0.5
#: Points at which a series is checked: different from the nodes, and closer to the ends.
_TEST_NODES = chebyshev.chebpts1(2 * _DEGREE + 3)
#: Further points for the check, independent of the pieces, so that no feature wider than 1/500 is
#: missed: multiples of the golden section are evenly distributed, without round numbers.
_CHECK_POINTS = np.arange(1, 1001) * (0.5 * np.sqrt(5.0) - 0.5) % 1.0

#: A density: values of shape (n,) at arc lengths of shape (n,).
Density = Callable[[Points], Any]


class PiecewiseDensity(NamedTuple):
    """A density with a total of 1, on m pieces.

    Attributes
    ----------
    edges : ndarray, shape (m + 1,)
        Ends of the pieces [L], from 0 to 1.
    force : ndarray, shape (degree + 2, m)
        Chebyshev series of the force below s.
    area : ndarray, shape (degree + 3, m)
        Chebyshev series of the integral of `force`.
    """

    edges: Array
    force: Array
    area: Array

    def force_below(self, s: Points) -> Points:
        """Return the force below arc lengths s (n,) [L]."""
        return self._evaluate(s, self.force)

    def moment_below(self, s: Points) -> Points:
        """Return the first moment of the force below arc lengths s (n,) [L]."""
        return s * self._evaluate(s, self.force) - self._evaluate(s, self.area)

    def _evaluate(self, s: Points, series: Array) -> Points:
        piece = np.searchsorted(self.edges, s, side="right") - 1
        piece = np.clip(piece, 0, self.edges.size - 2)
        start, end = self.edges[piece], self.edges[piece + 1]
        x = ((s - start) - (end - s)) / (end - start)
        return np.asarray(chebyshev.chebval(x, series[:, piece], tensor=False))


def piecewise_density(load: str, edges: Array, series: Array, largest: float) -> PiecewiseDensity:
    """Return a density, normalised to a total of 1.

    Parameters
    ----------
    load : str
        Name of the kind of load, for the message.
    edges : ndarray of shape (m + 1,)
        Ends of the pieces [L], from 0 to 1.
    series : ndarray of shape (degree + 1, m)
        Chebyshev series of the density on each piece, relative to its largest modulus.
    largest : float
        That modulus, in the user's unit.

    Returns
    -------
    PiecewiseDensity
        The density.

    Raises
    ------
    InputError
        The total is not positive.
    """
    half = 0.5 * np.diff(edges)
    force = _integral(series, half)
    total = float(force[:, -1].sum())
    if total <= _MIN_TOTAL:
        raise InputError(
            f"{load}: density adds up to {total * largest:.3g}; a follower force that pushes has to"
            " have a positive total"
        )
    force /= total
    return PiecewiseDensity(edges, force, _integral(force, half))


def fitted_pieces(density: Density, kinks: tuple[float, ...]) -> tuple[Array, Array, float]:
    """Fit a piecewise polynomial to a function.

    Parameters
    ----------
    density : callable
        The user's function, from arc lengths (n,) [L] to values (n,).
    kinks : tuple of float
        Arc lengths [L] of jumps and kinks, increasing, inside (0, 1).

    Returns
    -------
    edges, series, largest
        As `piecewise_density` takes them.

    Raises
    ------
    InputError
        The function fails, returns values that are not finite numbers, or is not smooth elsewhere.
    """
    pending = list(pairwise((0.0, *kinks, 1.0)))[::-1]
    check_points = np.concatenate(
        [_CHECK_POINTS, *(_inside(a, b, _TEST_NODES) for a, b in pending)]
    )
    checked_values = _values(density, check_points)
    largest = largest_of(checked_values)
    edges, fitted = [0.0], []
    while pending:
        a, b = pending.pop()
        values = _values(density, _inside(a, b, np.append(_NODES, _TEST_NODES))) / largest
        series = _TO_SERIES @ values[: _NODES.size]
        inside = (check_points > a) & (check_points < b)
        x = np.append(_TEST_NODES, ((check_points - a) - (b - check_points))[inside] / (b - a))
        wanted = np.append(values[_NODES.size :], checked_values[inside] / largest)
        if np.abs(chebyshev.chebval(x, series) - wanted).max() <= _TOLERANCE:
            edges.append(b)
            fitted.append(series)
        elif b - a < _MIN_PIECE or len(fitted) + len(pending) + 2 > _MAX_PIECES:
            raise InputError(
                f"ProfileLoad: density is not smooth near s = {0.5 * (a + b):.6g}; give the arc"
                " length of a jump or a kink there in kinks, and smooth anything else"
            )
        else:
            middle = 0.5 * (a + b)
            pending += [(middle, b), (a, middle)]
    return np.array(edges), np.stack(fitted, axis=-1), largest


def largest_of(values: ArrayLike) -> float:
    """Return the largest modulus of values, or 1 if all are 0."""
    return float(np.abs(values).max()) or 1.0


def _inside(a: float, b: float, x: Points) -> Points:
    """Return the arc lengths at x, from -1 to 1, between a and b."""
    return 0.5 * (a + b) + 0.5 * (b - a) * x


def _integral(series: Array, half: Array) -> Array:
    """Return the series of the integral from the clamp, for pieces of half-lengths `half` (m,)."""
    integral = half * chebyshev.chebint(series, lbnd=-1)
    # At the end of a piece every Chebyshev polynomial is 1.
    integral[0, 1:] += np.cumsum(integral.sum(axis=0))[:-1]
    return integral


def _values(density: Density, s: Points) -> Points:
    """Return the values of a user's function; InputError states what is wrong with them."""
    cure = "it has to take an array of arc lengths and return a finite number for each"
    try:
        # A copy, as the function may change its argument.
        values = np.asarray(density(s.copy()))
    except Exception as error:
        reason = " ".join(f"{type(error).__name__}: {error}".split())
        raise InputError(f"ProfileLoad: density fails ({reason}); {cure}") from error
    if values.shape != s.shape or values.dtype.kind not in "fiub":
        raise InputError(
            f"ProfileLoad: density gives {values.dtype} of shape {values.shape} at arc lengths of"
            f" shape {s.shape}; {cure}"
        )
    wrong = np.flatnonzero(~np.isfinite(values))
    if wrong.size:
        k = wrong[0]
        raise InputError(f"ProfileLoad: density is {values[k]} at s = {s[k]:.6g}; {cure}")
    return values.astype(float)
