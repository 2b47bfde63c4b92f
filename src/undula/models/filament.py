"""The elastic filament: the linked rod with half-cell ends, second-order accurate in 1/segments."""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal, Self

import numpy as np

from undula.errors import InputError, is_number
from undula.models.linked_rod import LinkedRod
from undula.models.loads import DensityLoad
from undula.models.rod import (
    ExtensiblePlanarRod,
    ExtensibleSpatialRod,
    PlanarRod,
    Rod,
    SpatialRod,
)
from undula.models.units import FILAMENT_UNITS, Units

#: EA L^2 / B = 4 (L/a)^2 of a round filament with a/L = 1/100.
TENSILE_STIFFNESS = 4e4
FEWEST_SEGMENTS = 4

_RODS: dict[tuple[str, bool], type[Rod]] = {
    ("exact", False): SpatialRod,
    ("exact", True): PlanarRod,
    ("weak", False): ExtensibleSpatialRod,
    ("weak", True): ExtensiblePlanarRod,
}


@dataclass(frozen=True)
class Filament(LinkedRod):
    """A clamped-free elastic filament in viscous fluid under an axial follower force.

    Attributes
    ----------
    segments : int
        Links that the filament is made of, at least 4. Errors fall as 1/segments^2.
    load : DensityLoad
        The axial follower force, see `undula.models.loads`.
    drag_ratio : float
        Normal over tangential drag coefficient, gamma, at least 1.
    inextensibility : {"exact", "weak"}
        Rigid links, or links that a large tensile stiffness keeps from stretching.
    tensile_stiffness : float
        EA L^2 / B of the weak form, positive; without meaning for the exact one.
    confined : bool
        Whether the filament is kept in the x-z plane.

    Raises
    ------
    InputError
        A value is out of its range.
    """

    segments: int
    load: DensityLoad
    drag_ratio: float = 2.0
    inextensibility: Literal["exact", "weak"] = "exact"
    tensile_stiffness: float = TENSILE_STIFFNESS
    confined: bool = False

    def __post_init__(self) -> None:
        """Refuse values that make no filament."""
        if (
            isinstance(self.segments, bool)
            or not isinstance(self.segments, int | np.integer)
            or self.segments < FEWEST_SEGMENTS
        ):
            raise InputError(
                f"segments = {self.segments!r} makes no filament;"
                f" give a whole number of at least {FEWEST_SEGMENTS}"
            )
        if not isinstance(self.load, DensityLoad):
            raise InputError(
                f"load = {self.load!r} is no load that a filament can bear; give one such as"
                " TipLoad(75.0)"
            )
        if not (is_number(self.drag_ratio) and self.drag_ratio >= 1.0):
            raise InputError(
                f"drag_ratio = {self.drag_ratio!r} has to be a finite number, at least 1"
            )
        if not isinstance(self.confined, bool):
            raise InputError(f"confined = {self.confined!r} has to be True or False")
        if self.inextensibility not in ("exact", "weak"):
            raise InputError(
                f"inextensibility = {self.inextensibility!r} has to be 'exact' or 'weak'"
            )
        if not (is_number(self.tensile_stiffness) and self.tensile_stiffness > 0.0):
            raise InputError(
                f"tensile_stiffness = {self.tensile_stiffness!r} has to be a positive finite number"
            )

    @cached_property
    def system(self) -> Rod:
        """The tables: half cells at both ends make them second-order accurate."""
        n, h = self.segments, 1.0 / self.segments
        joint, weight = np.full(n, 1.0 / h), np.full(n, h)
        joint[0], weight[-1] = 2.0 / h, 0.5 * h
        head, foot = self.load.shares(n)
        tensile = math.inf if self.inextensibility == "exact" else self.tensile_stiffness
        rod = _RODS[self.inextensibility, self.confined]
        return rod(joint, weight, head, foot, h, 1.0 - 1.0 / self.drag_ratio, tensile)

    @property
    def links(self) -> int:
        """Number of links."""
        return self.segments

    @property
    def units(self) -> Units:
        """Names of the units of its numbers."""
        return FILAMENT_UNITS

    @property
    def continuum(self) -> DensityLoad | None:
        """The load of the inextensible filament that rigid links stand for; None for weak ones."""
        return self.load if self.inextensibility == "exact" else None

    def with_links(self, links: int) -> Self | None:
        """Return the same filament made of another number of segments."""
        return replace(self, segments=links)
