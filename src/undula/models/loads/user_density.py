"""Axial follower forces with a density of the user, as a table or as a function.

A density is scaled to the total force, so that its unit is arbitrary. It is stored as a piecewise
polynomial: linear between the points of a table, and fitted to round-off for a function
(`undula.models.loads.piecewise`).
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
from undula.models.loads.piecewise import (
    Density,
    PiecewiseDensity,
    fitted_pieces,
    largest_of,
    piecewise_density,
)

#: Largest distance of the ends of a table from 0 and 1, by round-off.
_END_ROUND_OFF = 1e-12
#: Largest deviation from a line, relative to the largest density, that counts as round-off.
_KINK_ROUND_OFF = 1e-13


class _GivenLoad(DensityLoad):
    """A load with a piecewise polynomial density."""

    @property
    @abstractmethod
    def _piecewise(self) -> PiecewiseDensity:
        """The density for a total force of 1."""

    def force_below(self, s: Points) -> Points:
        """Return the integral of the density over [0, s]."""
        return self.force * self._piecewise.force_below(s)

    def moment_below(self, s: Points) -> Points:
        """Return the integral of s times the density over [0, s]."""
        return self.force * self._piecewise.moment_below(s)


@dataclass(frozen=True)
class TableLoad(_GivenLoad):
    """A follower force with a density given at arc lengths, with linear interpolation.

    Parameters
    ----------
    force : float
        Total force F [B/L^2 for a filament, K/L for a chain], finite, at least 0.
    s : sequence of float, shape (n,)
        Arc lengths [L], at least 2, increasing from 0 to 1; stored as a tuple.
    density : sequence of float, shape (n,)
        The density at these arc lengths, in any unit; it may be negative in places, but not in
        total. Stored as a tuple.

    Raises
    ------
    InputError
        A value is not a finite number, the lengths differ, s does not increase from 0 to 1, or the
        total is not positive.

    Examples
    --------
    >>> import undula as un
    >>> load = un.TableLoad(100.0, s=(0.0, 0.5, 1.0), density=(0.0, 1.0, 1.0))
    >>> f"{load.force_below(0.5):.4f}"
    '33.3333'
    """

    s: tuple[float, ...]
    density: tuple[float, ...]

    def __post_init__(self) -> None:
        """Check the values."""
        super().__post_init__()
        s, density = _numbers(self, "s"), _numbers(self, "density")
        if len(s) != len(density):
            raise InputError(
                f"TableLoad: density has {len(density)} values, where s has {len(s)};"
                " give one at each arc length"
            )
        object.__setattr__(self, "s", _arc_lengths(s))
        object.__setattr__(self, "density", density)
        _ = self._piecewise  # raises InputError for a total that is not positive

    @property
    def breaks(self) -> tuple[float, ...]:
        """The inner arc lengths [L] at which the slope of the density changes."""
        s, density = np.array(self.s), self._relative_density
        along = (s[1:-1] - s[:-2]) / (s[2:] - s[:-2])
        straight = density[:-2] + along * (density[2:] - density[:-2])
        return tuple(s[1:-1][np.abs(density[1:-1] - straight) > _KINK_ROUND_OFF].tolist())

    @cached_property
    def _piecewise(self) -> PiecewiseDensity:
        f = self._relative_density
        lines = np.array([0.5 * (f[:-1] + f[1:]), 0.5 * (f[1:] - f[:-1])])
        return piecewise_density("TableLoad", np.array(self.s), lines, largest_of(self.density))

    @property
    def _relative_density(self) -> Array:
        """The density over its largest modulus, whose sums cannot overflow."""
        return np.array(self.density) / largest_of(self.density)


@dataclass(frozen=True)
class _FittedDensity:
    """A density function with its piecewise polynomial, fitted once for all forces."""

    function: Density
    kinks: tuple[float, ...]
    piecewise: PiecewiseDensity = field(compare=False)

    def __call__(self, s: Points) -> Any:
        return self.function(s)

    def __repr__(self) -> str:
        return getattr(self.function, "__name__", None) or repr(self.function)


@dataclass(frozen=True)
class ProfileLoad(_GivenLoad):
    """A follower force with a density given as a function of arc length.

    Parameters
    ----------
    force : float
        Total force F [B/L^2 for a filament, K/L for a chain], finite, at least 0.
    density : callable
        Takes arc lengths [L] as an array of shape (n,), returns the density at each of them, in
        any unit; it may be negative in places, but not in total. A feature narrower than 1/500 of
        the length may be missed unless it is enclosed by kinks.
    kinks : sequence of float
        Arc lengths inside (0, 1) [L] at which the density jumps or has a kink; stored as a tuple.

    Raises
    ------
    InputError
        The function fails, returns values that are not finite numbers, or is not smooth at a place
        that is not in `kinks`; a kink is not inside (0, 1), or the total is not positive.

    Examples
    --------
    >>> import numpy as np
    >>> import undula as un
    >>> load = un.ProfileLoad(75.0, lambda s: np.where(s < 0.8, 0.0, 1.0), kinks=(0.8,))
    >>> f"{load.force_below(0.9):.4f}"
    '37.5000'
    """

    density: Density
    kinks: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        """Check the values and fit the density."""
        super().__post_init__()
        kinks = _numbers(self, "kinks")
        for i, kink in enumerate(kinks):
            if not 0.0 < kink < 1.0:
                raise InputError(
                    f"ProfileLoad: kinks[{i}] = {kink} has to be an arc length inside (0, 1)"
                )
        object.__setattr__(self, "kinks", tuple(sorted(set(kinks))))
        # The density of a load with another force, by `dataclasses.replace`, is fitted already.
        fitted = self.density if isinstance(self.density, _FittedDensity) else None
        function = self.density if fitted is None else fitted.function
        if not callable(function):
            raise InputError(
                f"ProfileLoad: density is of type {type(function).__name__}; give a function of"
                " arc length, or the points of a TableLoad"
            )
        if fitted is None or fitted.kinks != self.kinks:
            piecewise = piecewise_density("ProfileLoad", *fitted_pieces(function, self.kinks))
            object.__setattr__(self, "density", _FittedDensity(function, self.kinks, piecewise))

    @property
    def breaks(self) -> tuple[float, ...]:
        """The inner ends [L] of the pieces of the fitted density."""
        return tuple(self._piecewise.edges[1:-1].tolist())

    @property
    def _piecewise(self) -> PiecewiseDensity:
        assert isinstance(self.density, _FittedDensity)
        return self.density.piecewise


def _numbers(load: DensityLoad, name: str) -> tuple[float, ...]:
    """Return a user's sequence as floats."""
    given, place = getattr(load, name), f"{type(load).__name__}: {name}"
    if not isinstance(given, Iterable):
        raise InputError(f"{place} = {reprlib.repr(given)} has to be a sequence of numbers")
    values = given.tolist() if isinstance(given, np.ndarray) else list(given)
    for i, value in enumerate(values):
        if not is_number(value):
            text = value if isinstance(value, Real) else reprlib.repr(value)
            raise InputError(f"{place}[{i}] = {text} has to be a finite number")
    return tuple(float(value) for value in values)


def _arc_lengths(given: tuple[float, ...]) -> tuple[float, ...]:
    """Return the arc lengths of a table, checked and with ends of exactly 0 and 1."""
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
    """Return s, or the end if s differs from it by round-off."""
    return end if abs(s - end) <= _END_ROUND_OFF else s
