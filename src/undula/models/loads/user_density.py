"""Axial follower forces whose density the user gives: as a table, or as a function.

The shape of the density is what counts; it is scaled to the total force. Both are held as a
piecewise polynomial: straight lines between the points of a table, and for a function whatever
follows it to round-off (`undula.models.loads.piecewise`).
"""

import reprlib
from abc import abstractmethod
from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from numbers import Real
from typing import Any

import numpy as np

from undula.arrays import Array, Points
from undula.errors import InputError, is_number
from undula.models.loads.analytic import DensityLoad
from undula.models.loads.piecewise import Density, PiecewiseDensity, followed, largest_of, spread_of

#: How far from 0 and 1 the ends of a table may be, by the round-off of whoever made it.
_END_ROUND_OFF = 1e-12
#: A change of slope that moves no point by more, relative to the largest density, is round-off.
_KINK_ROUND_OFF = 1e-13


class _GivenLoad(DensityLoad):
    """A load whose density is a piecewise polynomial."""

    @property
    @abstractmethod
    def _spread(self) -> PiecewiseDensity:
        """How a force of 1 would be spread."""

    def force_below(self, s: Points) -> Points:
        """Return the integral of the density over [0, s]."""
        return self.force * self._spread.force_below(s)

    def moment_below(self, s: Points) -> Points:
        """Return the integral of s times the density over [0, s]."""
        return self.force * self._spread.moment_below(s)


@dataclass(frozen=True)
class TableLoad(_GivenLoad):
    """A density given at arc lengths, linear in between, scaled to the total force.

    Attributes
    ----------
    s : tuple of float
        Arc lengths [L], at least 2, increasing from 0 to 1; any sequence is taken.
    density : tuple of float
        The density at each of them, in any unit; it may be negative in places, but not in total.

    Raises
    ------
    InputError
        A value is none, the lengths differ, s does not increase from 0 to 1, or the total is not
        positive.
    """

    s: tuple[float, ...]
    density: tuple[float, ...]

    def __post_init__(self) -> None:
        """Refuse values that are no load."""
        super().__post_init__()
        s, density = _numbers(self, "s"), _numbers(self, "density")
        if len(s) != len(density):
            raise InputError(
                f"TableLoad: density has {len(density)} values, where s has {len(s)};"
                " give one at each arc length"
            )
        object.__setattr__(self, "s", _covering(s))
        object.__setattr__(self, "density", density)
        _ = self._spread  # refuses a total that does not push

    @property
    def breaks(self) -> tuple[float, ...]:
        """The inner arc lengths at which the slope of the density changes."""
        s, density = np.array(self.s), self._relative_density
        along = (s[1:-1] - s[:-2]) / (s[2:] - s[:-2])
        straight = density[:-2] + along * (density[2:] - density[:-2])
        return tuple(s[1:-1][np.abs(density[1:-1] - straight) > _KINK_ROUND_OFF].tolist())

    @cached_property
    def _spread(self) -> PiecewiseDensity:
        at = self._relative_density
        lines = np.array([0.5 * (at[:-1] + at[1:]), 0.5 * (at[1:] - at[:-1])])
        return spread_of("TableLoad", np.array(self.s), lines, largest_of(self.density))

    @property
    def _relative_density(self) -> Array:
        """The density over its largest modulus, whose sums cannot overflow."""
        return np.array(self.density) / largest_of(self.density)


@dataclass(frozen=True)
class _Resolved:
    """A density function, beside how a force is spread by it: found once, for every force."""

    function: Density
    kinks: tuple[float, ...]
    spread: PiecewiseDensity = field(compare=False)

    def __call__(self, s: Points) -> Any:
        return self.function(s)

    def __repr__(self) -> str:
        return getattr(self.function, "__name__", None) or repr(self.function)


@dataclass(frozen=True)
class ProfileLoad(_GivenLoad):
    """A density given as a function of arc length, scaled to the total force.

    Attributes
    ----------
    density : callable
        Takes arc lengths [L] as an array of shape (n,), returns the density at each of them, in
        any unit; it may be negative in places, but not in total. A feature narrower than 1/500 of
        the length may be overlooked unless kinks stand beside it.
    kinks : tuple of float
        Arc lengths inside (0, 1) at which the density jumps or has a kink; any sequence is taken.

    Raises
    ------
    InputError
        The function fails, gives values that are none, or is not smooth at a place that `kinks`
        does not name; a kink is not inside (0, 1), or the total is not positive.
    """

    density: Density
    kinks: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        """Refuse what is no load, and resolve the density unless that has been done."""
        super().__post_init__()
        kinks = _numbers(self, "kinks")
        for i, kink in enumerate(kinks):
            if not 0.0 < kink < 1.0:
                raise InputError(
                    f"ProfileLoad: kinks[{i}] = {kink} has to be an arc length inside (0, 1)"
                )
        object.__setattr__(self, "kinks", tuple(sorted(set(kinks))))
        known = self.density
        function = known.function if isinstance(known, _Resolved) else known
        if not callable(function):
            raise InputError(
                f"ProfileLoad: density is of type {type(function).__name__}; give a function of"
                " arc length, or the points of a TableLoad"
            )
        if not (isinstance(known, _Resolved) and known.kinks == self.kinks):
            spread = spread_of("ProfileLoad", *followed(function, self.kinks))
            object.__setattr__(self, "density", _Resolved(function, self.kinks, spread))

    @property
    def breaks(self) -> tuple[float, ...]:
        """The inner ends of the pieces on which a polynomial follows the density."""
        return tuple(self._spread.edges[1:-1].tolist())

    @property
    def _spread(self) -> PiecewiseDensity:
        assert isinstance(self.density, _Resolved)
        return self.density.spread


def _numbers(load: DensityLoad, name: str) -> tuple[float, ...]:
    """Return a sequence of the user's as floats."""
    given, place = getattr(load, name), f"{type(load).__name__}: {name}"
    if not isinstance(given, Iterable):
        raise InputError(f"{place} = {reprlib.repr(given)} has to be a sequence of numbers")
    values = given.tolist() if isinstance(given, np.ndarray) else list(given)
    for i, value in enumerate(values):
        if not is_number(value):
            shown = value if isinstance(value, Real) else reprlib.repr(value)
            raise InputError(f"{place}[{i}] = {shown} has to be a finite number")
    return tuple(float(value) for value in values)


def _covering(given: tuple[float, ...]) -> tuple[float, ...]:
    """Return the arc lengths of a table, its ends freed from round-off; refuse what is no table."""
    if len(given) < 2:
        number = f"{len(given)} value{'s' * (len(given) != 1)}"
        raise InputError(f"TableLoad: s has {number}; give at least 2, from 0 to 1")
    s = (_snapped(given[0], 0.0), *given[1:-1], _snapped(given[-1], 1.0))
    for i, (before, here) in enumerate(pairwise(s), start=1):
        if before >= here:
            raise InputError(
                f"TableLoad: s[{i}] = {here} does not exceed s[{i - 1}] = {before};"
                " give increasing arc lengths, and a jump as two that are close"
            )
    if (s[0], s[-1]) != (0.0, 1.0):
        raise InputError(
            f"TableLoad: s runs from {s[0]} to {s[-1]}; give the density from s = 0, the clamp,"
            " to s = 1, the tip"
        )
    return s


def _snapped(s: float, end: float) -> float:
    return end if abs(s - end) <= _END_ROUND_OFF else s
