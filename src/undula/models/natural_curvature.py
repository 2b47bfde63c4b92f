"""Natural curvature: the curvature of a filament without bending moment.

It has a component along each of the two directors normal to the tangent. A component about the
first director, e_x at the clamp, bends the filament in the y-z plane there, towards -y where it is
positive; a component about the second, e_y, bends it in the x-z plane, towards x.
"""

import reprlib
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from undula.arrays import Array, Points
from undula.errors import InputError, is_number

#: Gauss rule on a joint's cell, exact for polynomials of degree 9.
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(5)
#: Largest distance of the ends of a table from 0 and 1, by round-off.
_END_ROUND_OFF = 1e-12


@dataclass(frozen=True)
class CurvatureTable:
    """Natural curvature given at arc lengths, with linear interpolation.

    Parameters
    ----------
    s : sequence of float, shape (n,)
        Arc lengths [L], at least 2, increasing from 0 to 1; stored as a tuple.
    k1, k2 : sequence of float, shape (n,)
        The components about the first and the second director [1/L]; stored as tuples.

    Raises
    ------
    InputError
        A value is not a finite number, the numbers of values differ, or s does not increase from 0
        to 1.

    Examples
    --------
    >>> import undula as un
    >>> curvature = un.CurvatureTable(s=(0.0, 0.5, 1.0), k1=(6.0, 3.0, 0.0), k2=(0.0, 0.0, 0.0))
    >>> curvature([0.25, 0.75])
    array([[4.5, 1.5],
           [0. , 0. ]])
    >>> curved = un.Filament(20, un.TipLoad(75.0), natural_curvature=curvature)
    """

    s: tuple[float, ...]
    k1: tuple[float, ...]
    k2: tuple[float, ...]

    def __post_init__(self) -> None:
        """Check the values."""
        for name in ("s", "k1", "k2"):
            object.__setattr__(self, name, _numbers(f"CurvatureTable: {name}", getattr(self, name)))
        for name in ("k1", "k2"):
            if len(getattr(self, name)) != len(self.s):
                raise InputError(
                    f"CurvatureTable: {name} has {len(getattr(self, name))} values, where s has"
                    f" {len(self.s)}; give one at each arc length"
                )
        for i, (before, here) in enumerate(pairwise(self.s), start=1):
            if before >= here:
                raise InputError(
                    f"CurvatureTable: s[{i}] = {here} does not exceed s[{i - 1}] = {before};"
                    " give increasing arc lengths, and a jump as two that are close"
                )
        ends = (self.s[0], self.s[-1]) if self.s else (np.nan, np.nan)
        if not (abs(ends[0]) <= _END_ROUND_OFF and abs(ends[1] - 1.0) <= _END_ROUND_OFF):
            raise InputError(
                f"CurvatureTable: s = {reprlib.repr(self.s)} does not cover the filament; give the"
                " curvature from s = 0, the clamp, to s = 1, the tip"
            )

    def __call__(self, s: Points) -> Array:
        """Return both components (2, n) [1/L] at arc lengths s (n,) [L]."""
        return np.array([np.interp(s, self.s, self.k1), np.interp(s, self.s, self.k2)])


#: A constant (k1, k2), a table, or a function from arc lengths (n,) to (k1, k2), numbers or (n,).
NaturalCurvature = tuple[float, float] | CurvatureTable | Callable[[Points], Any]


def validated(given: Any) -> NaturalCurvature:
    """Return a user's natural curvature, a pair as a tuple of floats.

    Parameters
    ----------
    given : NaturalCurvature or sequence of float
        The user's value.

    Returns
    -------
    NaturalCurvature
        The same curvature.

    Raises
    ------
    InputError
        It is neither a pair of finite numbers nor a table nor a function.
    """
    if callable(given):
        return given  # type: ignore[no-any-return]
    pair = _numbers("natural_curvature", given)
    if len(pair) != 2:
        raise InputError(
            f"natural_curvature = {reprlib.repr(given)} has {len(pair)} values; give the pair"
            " (k1, k2), a CurvatureTable, or a function of arc length"
        )
    return pair[0], pair[1]


def mean_over_pieces(curvature: NaturalCurvature, links: int) -> Array:
    """Return the mean natural curvature of the pieces between clamp, middles of links and tip.

    Each joint represents the piece that ends at the middle of the link above it.

    Parameters
    ----------
    curvature : NaturalCurvature
        The curvature.
    links : int
        Number of links N.

    Returns
    -------
    ndarray, shape (N + 1, 2)
        Means over the pieces [1/L].

    Raises
    ------
    InputError
        A function fails or returns values that are not finite numbers.
    """
    if isinstance(curvature, tuple):
        return np.full((links + 1, 2), curvature)
    ends = np.concatenate([[0.0], (np.arange(links) + 0.5) / links, [1.0]])
    middle, half = 0.5 * (ends[1:] + ends[:-1]), 0.5 * np.diff(ends)
    s = (middle[:, None] + half[:, None] * _POINTS).ravel()
    values = _values(curvature, s).reshape(2, links + 1, _POINTS.size)
    # In the order of the arrays of pairs, for which kernels are compiled already.
    return np.ascontiguousarray((0.5 * values @ _WEIGHTS).T)


def require_below_pi(curvature: NaturalCurvature, links: int, most: int) -> None:
    """Raise InputError for a curvature that gives a joint a natural angle of pi or more.

    The message states a sufficient number of links, if that is at most `most`.

    Parameters
    ----------
    curvature : NaturalCurvature
        The curvature.
    links : int
        Number of links.
    most : int
        Largest number of links.

    Raises
    ------
    InputError
        A joint would fold.
    """
    turn = _largest_turn(curvature, links)
    if turn < np.pi:
        return
    sufficient = links
    while sufficient <= most and _largest_turn(curvature, sufficient) >= np.pi:
        # The number of links at which the most curved joint would have an angle of pi.
        sufficient = max(
            sufficient + 1, int(sufficient * _largest_turn(curvature, sufficient) / np.pi)
        )
    cure = (
        f"use {sufficient} segments or more" if sufficient <= most else "give a smaller curvature"
    )
    raise InputError(
        f"natural_curvature = {reprlib.repr(curvature)} turns a joint of {links} segments by"
        f" {turn:.3g} rad, beyond pi; {cure}"
    )


def _largest_turn(curvature: NaturalCurvature, links: int) -> float:
    """Return the largest natural angle of a joint [rad]."""
    turns = np.linalg.norm(mean_over_pieces(curvature, links)[:-1], axis=1) / links
    turns[0] *= 0.5  # the clamp's piece ends in the middle of the first link
    return float(turns.max())


def _values(curvature: Callable[[Points], Any], s: Points) -> Array:
    cure = "it has to take an array of arc lengths and return finite numbers k1 and k2 for each"
    try:
        k1, k2 = curvature(s.copy())
        values = np.array([np.broadcast_to(np.asarray(k, dtype=float), s.shape) for k in (k1, k2)])
    except Exception as error:
        reason = " ".join(f"{type(error).__name__}: {error}".split())
        raise InputError(f"natural_curvature fails ({reason}); {cure}") from error
    if not np.isfinite(values).all():
        component, k = np.argwhere(~np.isfinite(values))[0]
        raise InputError(
            f"natural_curvature has k{component + 1} = {values[component, k]}"
            f" at s = {s[k]:.6g}; {cure}"
        )
    return values


def _numbers(place: str, given: Any) -> tuple[float, ...]:
    """Return a user's sequence as floats."""
    if not isinstance(given, Iterable) or isinstance(given, str):
        raise InputError(f"{place} = {reprlib.repr(given)} has to be a sequence of numbers")
    values = given.tolist() if isinstance(given, np.ndarray) else list(given)
    for i, value in enumerate(values):
        if not is_number(value):
            raise InputError(f"{place}[{i}] = {reprlib.repr(value)} has to be a finite number")
    return tuple(float(value) for value in values)
