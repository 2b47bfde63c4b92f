"""Axial follower forces with analytic distributions, and their shares on links.

A load has a total compressive force F and a density f_a(s) along the filament, s in [0, 1], acting
against the tangent: f = -f_a t. The densities of this module are nowhere negative; a density of the
user (`undula.models.loads.user_density`) may be negative, where it pulls. Each link carries the
integral of f_a over it, divided between its two nodes so that the first moment is exact as well. A
concentrated force is divided linearly between the two links whose midpoints enclose it, so that its
direction is also accurate to second order; beyond the last midpoint the last link carries it alone.

Source of the profiles: Ling, Guo & Kanso (2018), equations for linear, concentrated and power-law
forces.
"""

import math
from abc import abstractmethod
from dataclasses import dataclass, field

import numpy as np

from undula.arrays import Links, Points
from undula.errors import InputError, is_number


@dataclass(frozen=True)
class Load:
    """An axial follower force, the base class of all loads.

    Parameters
    ----------
    force : float
        Total compressive force F [B/L^2 for a filament, K/L for a chain], finite, at least 0.

    Raises
    ------
    InputError
        The force is out of its range.

    Examples
    --------
    >>> import undula as un
    >>> isinstance(un.TipLoad(75.0), un.Load)
    True
    """

    force: float

    def __post_init__(self) -> None:
        """Check the values."""
        require(self, "force", 0.0, np.inf, "a finite number, at least 0")

    @abstractmethod
    def shares(self, links: int) -> tuple[Links, Links]:
        """Return the forces of each link on its outer and on its inner node.

        Parameters
        ----------
        links : int
            Number of links.

        Returns
        -------
        outer_force, inner_force : ndarray, shape (links,)
            Forces opposite to the link's tangent, in the unit of `force`.
        """


@dataclass(frozen=True)
class DensityLoad(Load):
    """A follower force with a density f_a(s), as on a continuous filament.

    Parameters
    ----------
    force : float
        Total compressive force F [B/L^2 for a filament, K/L for a chain], finite, at least 0.
    """

    @property
    def breaks(self) -> tuple[float, ...]:
        """Arc lengths inside (0, 1) [L], increasing, that divide the density into smooth pieces.

        On each piece a polynomial of degree about 20 represents `force_below` to round-off, except
        for a weak singularity at the end of a piece.
        """
        return ()

    @abstractmethod
    def force_below(self, s: Points) -> Points:
        """Return the integral of f_a over [0, s], for arc lengths s of any shape [L]."""

    @abstractmethod
    def moment_below(self, s: Points) -> Points:
        """Return the integral of s f_a over [0, s], for arc lengths s of any shape [L]."""

    def shares(self, links: int) -> tuple[Links, Links]:
        """Return the integrals over links, divided so that the first moment is exact."""
        s = np.linspace(0.0, 1.0, links + 1)
        force = np.diff(self.force_below(s))
        outer_force = (np.diff(self.moment_below(s)) - s[:-1] * force) * links
        return outer_force, force - outer_force


@dataclass(frozen=True)
class PointLoad(DensityLoad):
    """A follower force concentrated at one arc length.

    Parameters
    ----------
    force : float
        Force F [B/L^2 for a filament, K/L for a chain], finite, at least 0.
    position : float
        Arc length [L], in (0, 1].

    Raises
    ------
    InputError
        A value is out of its range.

    References
    ----------
    Ling, Guo & Kanso (2018), J. R. Soc. Interface 15.

    Examples
    --------
    >>> import undula as un
    >>> model = un.Filament(20, un.PointLoad(75.0, position=0.7))
    >>> model.load.breaks
    (0.7,)
    """

    position: float = 1.0

    def __post_init__(self) -> None:
        """Check the values."""
        super().__post_init__()
        require(self, "position", math.ulp(0.0), 1.0, "a number in (0, 1]")

    @property
    def breaks(self) -> tuple[float, ...]:
        """The position [L]; empty for the tip."""
        return (self.position,) if self.position < 1.0 else ()

    def force_below(self, s: Points) -> Points:
        """Return F beyond the position, 0 before it."""
        return np.where(s >= self.position, self.force, 0.0)

    def moment_below(self, s: Points) -> Points:
        """Return F times the position beyond it, 0 before it."""
        return self.position * self.force_below(s)

    def shares(self, links: int) -> tuple[Links, Links]:
        """Return the shares of the links whose midpoints enclose the position."""
        outer_force, inner_force = np.zeros(links), np.zeros(links)
        distance = self.position * links - 0.5  # from the first midpoint, in links
        if 0.0 < distance < links - 1.0:
            lower = int(distance)
            for link, part in ((lower, 1.0 - (distance - lower)), (lower + 1, distance - lower)):
                outer_force[link] = inner_force[link] = 0.5 * part * self.force
        else:
            link = 0 if distance <= 0.0 else links - 1
            outer_force[link] = (self.position * links - link) * self.force
            inner_force[link] = self.force - outer_force[link]
        return outer_force, inner_force


@dataclass(frozen=True)
class TipLoad(PointLoad):
    """A follower force at the free end: a point load at s = 1.

    Parameters
    ----------
    force : float
        Force F [B/L^2 for a filament, K/L for a chain], finite, at least 0.

    Raises
    ------
    InputError
        The force is out of its range.

    Examples
    --------
    >>> import undula as un
    >>> un.TipLoad(75.0)
    TipLoad(force=75.0)
    """

    position: float = field(default=1.0, init=False, repr=False)


@dataclass(frozen=True)
class LinearLoad(DensityLoad):
    """A follower force with the density F [1 + slope (2 s - 1)].

    Parameters
    ----------
    force : float
        Total force F [B/L^2 for a filament, K/L for a chain], finite, at least 0.
    slope : float
        Slope in [-1, 1]: 0 for a uniform density, 1 for a density that vanishes at the clamp.

    Raises
    ------
    InputError
        A value is out of its range.

    References
    ----------
    Ling, Guo & Kanso (2018), J. R. Soc. Interface 15.

    Examples
    --------
    >>> import undula as un
    >>> print(un.LinearLoad(100.0, slope=1.0).force_below(0.5))
    25.0
    """

    slope: float = 0.0

    def __post_init__(self) -> None:
        """Check the values."""
        super().__post_init__()
        require(self, "slope", -1.0, 1.0, "a number in [-1, 1]")

    def force_below(self, s: Points) -> Points:
        """Return F [s + slope (s^2 - s)]."""
        return self.force * (s + self.slope * (s * s - s))

    def moment_below(self, s: Points) -> Points:
        """Return F [s^2 / 2 + slope (2 s^3 / 3 - s^2 / 2)]."""
        return self.force * (0.5 * s**2 + self.slope * (2.0 / 3.0 * s**3 - 0.5 * s**2))


def require(load: Load, name: str, lowest: float, highest: float, wanted: str) -> None:
    """Check that a number of a load is in its range.

    Parameters
    ----------
    load : Load
        The load.
    name : str
        Name of the attribute.
    lowest, highest : float
        Ends of the range, both included.
    wanted : str
        The range in words, for the message.

    Raises
    ------
    InputError
        The value is not a finite number in the range.
    """
    value = getattr(load, name)
    if not (is_number(value) and lowest <= value <= highest):
        raise InputError(f"{type(load).__name__}: {name} = {value!r} has to be {wanted}")
