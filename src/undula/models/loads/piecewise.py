"""How a force is spread by a density that is a piecewise polynomial, and how one is found.

A piecewise polynomial is one Chebyshev series a piece, in x from -1 to 1. The force G(s) below s is
its antiderivative, and the first moment is s G(s) minus the antiderivative of G, by parts. For a
function, pieces are halved until each series of degree 15 follows it to round-off.
"""

from collections.abc import Callable
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike

from undula.arrays import Array, Points
from undula.errors import InputError

#: A total below this part of the largest density is what round-off leaves of one that cancels.
_CANCELLED = 1e-12
#: Greatest departure of a series from a function, relative to the function's largest value.
_TOLERANCE = 1e-13
_MOST_PIECES = 200
#: A density that needs shorter pieces has a kink, a jump or a singularity there.
_SHORTEST_PIECE = 2.0**-20

_DEGREE = 15
_NODES = chebyshev.chebpts1(_DEGREE + 1)
#: From values at the nodes to the series: discrete orthogonality, whose first row counts half.
_TO_SERIES = chebyshev.chebvander(_NODES, _DEGREE).T * 2.0 / _NODES.size
_TO_SERIES[0] *= 0.5
#: Where a series is checked: no node is among these points, and they reach nearer to the ends.
_BETWEEN = chebyshev.chebpts1(2 * _DEGREE + 3)
#: Points that no piece chooses, so that no feature wider than 1/500 hides between those above:
#: multiples of the golden section spread evenly and fall on no round number.
_LOOKS = np.arange(1, 1001) * (0.5 * np.sqrt(5.0) - 0.5) % 1.0

#: A density: values of shape (n,) at arc lengths of shape (n,).
Density = Callable[[Points], Any]


class PiecewiseDensity(NamedTuple):
    """How a force of 1 is spread: Chebyshev series (degree + 1, m) on pieces between `edges`.

    `force` is the force below s, `area` the integral of that.
    """

    edges: Array
    force: Array
    area: Array

    def force_below(self, s: Points) -> Points:
        """Return the force below s."""
        return self._at(s, self.force)

    def moment_below(self, s: Points) -> Points:
        """Return the first moment below s."""
        return s * self._at(s, self.force) - self._at(s, self.area)

    def _at(self, s: Points, series: Array) -> Points:
        piece = np.searchsorted(self.edges, s, side="right") - 1
        piece = np.clip(piece, 0, self.edges.size - 2)
        start, end = self.edges[piece], self.edges[piece + 1]
        x = ((s - start) - (end - s)) / (end - start)
        return np.asarray(chebyshev.chebval(x, series[:, piece], tensor=False))


def spread_of(load: str, edges: Array, series: Array, largest: float) -> PiecewiseDensity:
    """Return how a density spreads a force.

    Parameters
    ----------
    load : str
        Name of the kind of load, for the complaint.
    edges : ndarray of shape (m + 1,)
        Ends of the pieces, from 0 to 1.
    series : ndarray of shape (degree + 1, m)
        Chebyshev series of the density on each piece, relative to its largest modulus.
    largest : float
        That modulus, in the user's unit.

    Raises
    ------
    InputError
        The total is not positive.
    """
    half = 0.5 * np.diff(edges)
    force = _integral(series, half)
    total = float(force[:, -1].sum())
    if total <= _CANCELLED:
        raise InputError(
            f"{load}: density adds up to {total * largest:.3g}; a follower force that pushes has to"
            " have a positive total"
        )
    force /= total
    return PiecewiseDensity(edges, force, _integral(force, half))


def followed(density: Density, kinks: tuple[float, ...]) -> tuple[Array, Array, float]:
    """Return the piecewise polynomial that follows a function, as `spread_of` takes it.

    Parameters
    ----------
    density : callable
        The user's: arc lengths (n,) to values (n,).
    kinks : tuple of float
        Where it may jump or have a kink, increasing, inside (0, 1).

    Raises
    ------
    InputError
        The function fails, gives values that are none, or is not smooth somewhere.
    """
    waiting = list(pairwise((0.0, *kinks, 1.0)))[::-1]
    looks = np.concatenate([_LOOKS, *(_inside(a, b, _BETWEEN) for a, b in waiting)])
    seen = _values(density, looks)
    largest = largest_of(seen)
    edges, found = [0.0], []
    while waiting:
        a, b = waiting.pop()
        values = _values(density, _inside(a, b, np.append(_NODES, _BETWEEN))) / largest
        series = _TO_SERIES @ values[: _NODES.size]
        here = (looks > a) & (looks < b)
        x = np.append(_BETWEEN, ((looks - a) - (b - looks))[here] / (b - a))
        wanted = np.append(values[_NODES.size :], seen[here] / largest)
        if np.abs(chebyshev.chebval(x, series) - wanted).max() <= _TOLERANCE:
            edges.append(b)
            found.append(series)
        elif b - a < _SHORTEST_PIECE or len(found) + len(waiting) + 2 > _MOST_PIECES:
            raise InputError(
                f"ProfileLoad: density is not smooth near s = {0.5 * (a + b):.6g}; give the arc"
                " length of a jump or a kink there in kinks, and smooth anything else"
            )
        else:
            middle = 0.5 * (a + b)
            waiting += [(middle, b), (a, middle)]
    return np.array(edges), np.stack(found, axis=-1), largest


def largest_of(values: ArrayLike) -> float:
    """Return the largest modulus, or 1 if all are 0."""
    return float(np.abs(values).max()) or 1.0


def _inside(a: float, b: float, x: Points) -> Points:
    """Return the arc lengths at x, from -1 to 1, between a and b."""
    return 0.5 * (a + b) + 0.5 * (b - a) * x


def _integral(series: Array, half: Array) -> Array:
    """Return the series of the integral from the clamp; `half` is half the length of each piece."""
    integral = half * chebyshev.chebint(series, lbnd=-1)
    # At the end of a piece every Chebyshev polynomial is 1.
    integral[0, 1:] += np.cumsum(integral.sum(axis=0))[:-1]
    return integral


def _values(density: Density, s: Points) -> Points:
    """Return the values of a function that the user gave, or tell what is wrong with them."""
    cure = "it has to take an array of arc lengths and return a finite number for each"
    try:
        # A copy: whatever the function does to its argument stays its own.
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
        at = wrong[0]
        raise InputError(f"ProfileLoad: density is {values[at]} at s = {s[at]:.6g}; {cure}")
    return values.astype(float)
