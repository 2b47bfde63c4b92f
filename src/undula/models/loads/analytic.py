"""Axial follower forces: how much of the total force each link carries, and where.

A load has a total compressive force F and a density f_a(s) along the filament, s in [0, 1], acting
against the tangent: f = -f_a t. The densities of this module are nowhere negative; one that the
user gives (`undula.models.loads.user_density`) may be, where it pulls. On a chain of links each
link carries the integral of f_a over it, shared by its two nodes so that the first moment is exact
as well. A concentrated force is shared linearly by the two links whose midpoints enclose it, so
that its direction, too, is accurate to second order; beyond the last midpoint the last link carries
it alone.

Source of the profiles: Ling, Guo & Kanso (2018), equations for linear, concentrated and power-law
forces.
"""

import math
from abc import abstractmethod
from dataclasses import dataclass, field

import numpy as np

from undula.arrays import Links, Points
from undula.errors import InputError, is_number

#: Up to this exponent a single polynomial of degree 20 resolves s^(p+1), or is it.
_STEEP_FROM = 18.0
#: Beyond it s^p is nearly exp(-d) at the depth d/p below the tip: on a piece between two of these
#: depths it falls by no more than degree 20 follows, and below the last it is lost to round-off.
_LAYER = (40.0, 20.0, 8.0)
#: A shorter piece at the clamp would do nothing but spoil the conditioning of whoever uses it.
_SHORTEST_FIRST_PIECE = 0.1
#: From this exponent on the singularity of s^(p+1) at s = 0 is lost to round-off at degree 20.
_SINGULAR_BELOW = 8.0
#: Graded towards that singularity: the farther pieces do not see it, and on the first it is small.
_NEAR_CLAMP = (0.1, 0.33)


@dataclass(frozen=True)
class Load:
    """An axial follower force.

    Attributes
    ----------
    force : float
        Total compressive force F in the model's unit of force, finite, at least 0.
    """

    force: float

    def __post_init__(self) -> None:
        """Refuse values that are no load."""
        require(self, "force", 0.0, np.inf, "a finite number, at least 0")

    @abstractmethod
    def shares(self, links: int) -> tuple[Links, Links]:
        """Return the forces (head, foot) that each link puts on its outer and its inner node.

        Both have shape (links,) and act along minus the link's tangent.
        """


@dataclass(frozen=True)
class DensityLoad(Load):
    """A force with a density f_a(s): one that a continuous filament can bear."""

    @property
    def breaks(self) -> tuple[float, ...]:
        """Arc lengths inside (0, 1), increasing, that part the filament into smooth pieces.

        On each piece a polynomial of degree about 20 gives `force_below` to round-off, but for a
        weak singularity at the end of a piece.
        """
        return ()

    @abstractmethod
    def force_below(self, s: Points) -> Points:
        """Return the force carried by [0, s], the integral of f_a."""

    @abstractmethod
    def moment_below(self, s: Points) -> Points:
        """Return the first moment about the base carried by [0, s], the integral of s f_a."""

    def shares(self, links: int) -> tuple[Links, Links]:
        """Return what each link carries, parted so that the first moment is exact."""
        s = np.linspace(0.0, 1.0, links + 1)
        force = np.diff(self.force_below(s))
        outer_force = (np.diff(self.moment_below(s)) - s[:-1] * force) * links
        return outer_force, force - outer_force


@dataclass(frozen=True)
class PointLoad(DensityLoad):
    """A force concentrated at arc length `position` in (0, 1] [L]."""

    position: float = 1.0

    def __post_init__(self) -> None:
        """Refuse values that are no load."""
        super().__post_init__()
        require(self, "position", math.ulp(0.0), 1.0, "a number in (0, 1]")

    @property
    def breaks(self) -> tuple[float, ...]:
        """The position, unless it is the tip."""
        return (self.position,) if self.position < 1.0 else ()

    def force_below(self, s: Points) -> Points:
        """Return F beyond the position, 0 before it."""
        return np.where(s >= self.position, self.force, 0.0)

    def moment_below(self, s: Points) -> Points:
        """Return F s_a beyond the position, 0 before it."""
        return self.position * self.force_below(s)

    def shares(self, links: int) -> tuple[Links, Links]:
        """Share the force between the links whose midpoints enclose it."""
        outer_force, inner_force = np.zeros(links), np.zeros(links)
        place = self.position * links - 0.5  # in links, from the first midpoint
        if 0.0 < place < links - 1.0:
            lower = int(place)
            for link, part in ((lower, 1.0 - (place - lower)), (lower + 1, place - lower)):
                outer_force[link] = inner_force[link] = 0.5 * part * self.force
        else:
            link = 0 if place <= 0.0 else links - 1
            outer_force[link] = (self.position * links - link) * self.force
            inner_force[link] = self.force - outer_force[link]
        return outer_force, inner_force


@dataclass(frozen=True)
class TipLoad(PointLoad):
    """A force concentrated at the free end: a point load at s = 1."""

    position: float = field(default=1.0, init=False, repr=False)


@dataclass(frozen=True)
class LinearLoad(DensityLoad):
    """A density F [1 + slope (2 s - 1)], with slope in [-1, 1]."""

    slope: float = 0.0

    def __post_init__(self) -> None:
        """Refuse values that are no load."""
        super().__post_init__()
        require(self, "slope", -1.0, 1.0, "a number in [-1, 1]")

    def force_below(self, s: Points) -> Points:
        """Return F [s + slope (s^2 - s)]."""
        return self.force * (s + self.slope * (s * s - s))

    def moment_below(self, s: Points) -> Points:
        """Return F [s^2 / 2 + slope (2 s^3 / 3 - s^2 / 2)]."""
        return self.force * (0.5 * s**2 + self.slope * (2.0 / 3.0 * s**3 - 0.5 * s**2))


@dataclass(frozen=True)
class PowerLoad(DensityLoad):
    """A density F (p + 1) s^p, with exponent p at least 0."""

    exponent: float = 1.0

    def __post_init__(self) -> None:
        """Refuse values that are no load."""
        super().__post_init__()
        require(self, "exponent", 0.0, np.inf, "a finite number, at least 0")

    @property
    def breaks(self) -> tuple[float, ...]:
        """Short pieces where s^(p+1) is singular at the clamp, or steep near the tip."""
        p = self.exponent
        if p > _STEEP_FROM:
            layer = {1.0 - depth / p for depth in _LAYER}
            return tuple(sorted(s for s in layer if _SHORTEST_FIRST_PIECE <= s < 1.0))
        return _NEAR_CLAMP if p < _SINGULAR_BELOW and p % 1.0 else ()

    # Far below the tip a steep load is 0 to all digits.
    @np.errstate(under="ignore")
    def force_below(self, s: Points) -> Points:
        """Return F s^(p+1)."""
        return self.force * s ** (self.exponent + 1.0)

    @np.errstate(under="ignore")
    def moment_below(self, s: Points) -> Points:
        """Return F (p + 1) / (p + 2) s^(p+2)."""
        p = self.exponent
        return self.force * (p + 1.0) / (p + 2.0) * s ** (p + 2.0)


def require(load: Load, name: str, lowest: float, highest: float, wanted: str) -> None:
    """Refuse a load whose number is out of its range."""
    value = getattr(load, name)
    if not (is_number(value) and lowest <= value <= highest):
        raise InputError(f"{type(load).__name__}: {name} = {value!r} has to be {wanted}")
