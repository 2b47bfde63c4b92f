"""Natural curvature: how a filament is curved when nothing bends it.

It has a component along each of the two directors across the tangent. A component about the first
director, which is e_x at the clamp, bends the filament in the y-z plane there; one about the
second, e_y, in the x-z plane, towards x where it is positive.
"""

import reprlib
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from undula.arrays import Array, Points
from undula.errors import InputError, is_number

#: Points of a joint's cell at which the curvature is taken: exact for polynomials of degree 9.
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(5)
#: How far from 0 and 1 the ends of a table may be, by the round-off of whoever made it.
_END_ROUND_OFF = 1e-12


@dataclass(frozen=True)
class CurvatureTable:
    """Natural curvature given at arc lengths, linear in between.

    Attributes
    ----------
    s : tuple of float
        Arc lengths [L], at least 2, increasing from 0 to 1; any sequence is taken.
    k1, k2 : tuple of float
        The components about the first and the second director at each of them [1/L].

    Raises
    ------
    InputError
        A value is none, the numbers of values differ, or s does not increase from 0 to 1.
    """

    s: tuple[float, ...]
    k1: tuple[float, ...]
    k2: tuple[float, ...]

    def __post_init__(self) -> None:
        """Refuse values that are no curvature."""
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
        """Return both components (2, n) at arc lengths (n,)."""
        return np.array([np.interp(s, self.s, self.k1), np.interp(s, self.s, self.k2)])


#: A constant (k1, k2), a table, or a function from arc lengths (n,) to (k1, k2), numbers or (n,).
NaturalCurvature = tuple[float, float] | CurvatureTable | Callable[[Points], Any]


def accepted(given: Any) -> NaturalCurvature:
    """Return a natural curvature as a user may give it, a pair as a tuple of floats.

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


def of_pieces(curvature: NaturalCurvature, links: int) -> Array:
    """Return the mean natural curvature (N + 1, 2) of the pieces between clamp, middles and tip.

    Each joint stands for the piece that ends in the middle of the link above it.

    Raises
    ------
    InputError
        A function fails or gives values that are none.
    """
    if isinstance(curvature, tuple):
        return np.full((links + 1, 2), curvature)
    ends = np.concatenate([[0.0], (np.arange(links) + 0.5) / links, [1.0]])
    middle, half = 0.5 * (ends[1:] + ends[:-1]), 0.5 * np.diff(ends)
    s = (middle[:, None] + half[:, None] * _POINTS).ravel()
    values = _values(curvature, s).reshape(2, links + 1, _POINTS.size)
    return np.asarray((0.5 * values @ _WEIGHTS).T)


def refuse_beyond_pi(curvature: NaturalCurvature, links: int, most: int) -> None:
    """Refuse a curvature that turns a joint of so many links by pi or more, where it folds.

    The sentence tells how many links are enough, if that is at most `most`.
    """
    turn = _largest_turn(curvature, links)
    if turn < np.pi:
        return
    enough = links
    while enough <= most and _largest_turn(curvature, enough) >= np.pi:
        # As many as a joint takes that is curved like the one that turns most.
        enough = max(enough + 1, int(enough * _largest_turn(curvature, enough) / np.pi))
    cure = f"use {enough} segments or more" if enough <= most else "give a smaller curvature"
    raise InputError(
        f"natural_curvature = {reprlib.repr(curvature)} turns a joint of {links} segments by"
        f" {turn:.3g} rad, beyond pi; {cure}"
    )


def _largest_turn(curvature: NaturalCurvature, links: int) -> float:
    """Return the largest angle [rad] by which joints turn when nothing bends them."""
    turns = np.linalg.norm(of_pieces(curvature, links)[:-1], axis=1) / links
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
        which, at = np.argwhere(~np.isfinite(values))[0]
        raise InputError(
            f"natural_curvature has k{which + 1} = {values[which, at]} at s = {s[at]:.6g}; {cure}"
        )
    return values


def _numbers(place: str, given: Any) -> tuple[float, ...]:
    """Return a sequence of the user's as floats."""
    if not isinstance(given, Iterable) or isinstance(given, str):
        raise InputError(f"{place} = {reprlib.repr(given)} has to be a sequence of numbers")
    values = given.tolist() if isinstance(given, np.ndarray) else list(given)
    for i, value in enumerate(values):
        if not is_number(value):
            raise InputError(f"{place}[{i}] = {reprlib.repr(value)} has to be a finite number")
    return tuple(float(value) for value in values)
