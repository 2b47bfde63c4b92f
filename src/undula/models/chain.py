"""The bead-spring chain: the linked rod with a bead and a spring at each end of its links.

It has equal springs K at all joints, a base spring of its own, and beads whose drag is isotropic
unless a drag ratio is asked for. Numbers are in units of L, K and the drag zeta of a bead: forces
in K/L, energies in K, times in zeta L^2/K. One link stays straight whatever pushes it.

Source: Ling, Guo & Kanso (2018), bead-spring model; two links in a plane are those of De Canio,
Lauga & Goldstein (2017).
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np

from undula.arrays import Array, Links
from undula.errors import InputError, is_number
from undula.models.linked_rod import LinkedRod
from undula.models.loads.analytic import Load
from undula.models.rod.tables import (
    FoldingPlanarRod,
    FoldingSpatialRod,
    PlainRod,
    Rod,
    UnwrappedRod,
)
from undula.models.units import Units, chain_units

MOST_LINKS = 1000


@dataclass(frozen=True)
class Chain(LinkedRod):
    """A clamped chain of rigid links with springs at its joints and beads at their ends.

    Attributes
    ----------
    links : int
        Number of links and beads N, 1 to 1000.
    load : Load
        The follower force: `TipLoad` on the last bead, `BeadLoad` on others, or a density.
    drag_ratio : float
        Normal over tangential drag coefficient of a bead, gamma, at least 1.
    base_spring : float
        Stiffness of the spring that clamps the first link [K], positive.
    bead_drag : float or tuple of float
        Drag coefficient of every bead, or of each one from the base on [zeta], positive.
    confined : bool
        Whether the chain is kept in the x-z plane.
    spring : {"angle", "unwrapped"}
        What a joint's energy K psi^2 / 2 takes for psi: the angle between its links, from 0 to pi,
        or that angle followed continuously, beyond pi; the latter for confined chains. A start has
        angles up to pi.

    Raises
    ------
    InputError
        A value is out of its range.
    """

    links: int
    load: Load
    drag_ratio: float = 1.0
    base_spring: float = 1.0
    bead_drag: float | tuple[float, ...] = 1.0
    confined: bool = False
    spring: Literal["angle", "unwrapped"] = "angle"

    def __post_init__(self) -> None:
        """Refuse values that make no chain."""
        whole = isinstance(self.links, int | np.integer) and not isinstance(self.links, bool)
        if not (whole and 1 <= self.links <= MOST_LINKS):
            raise InputError(
                f"links = {self.links!r} makes no chain; give a whole number from 1 to {MOST_LINKS}"
            )
        if not isinstance(self.load, Load):
            raise InputError(f"load = {self.load!r} is no load; give one such as TipLoad(8.0)")
        if not (is_number(self.drag_ratio) and self.drag_ratio >= 1.0):
            raise InputError(
                f"drag_ratio = {self.drag_ratio!r} has to be a finite number, at least 1"
            )
        if not (is_number(self.base_spring) and self.base_spring > 0.0):
            raise InputError(
                f"base_spring = {self.base_spring!r} has to be a positive finite number"
            )
        if not isinstance(self.confined, bool):
            raise InputError(f"confined = {self.confined!r} has to be True or False")
        if self.spring not in ("angle", "unwrapped"):
            raise InputError(f"spring = {self.spring!r} has to be 'angle' or 'unwrapped'")
        if self.spring == "unwrapped" and not self.confined:
            raise InputError(
                "spring = 'unwrapped' has no meaning in space, where no angle exceeds pi; use"
                " confined = True or spring = 'angle'"
            )
        if isinstance(self.bead_drag, Iterable) and not isinstance(self.bead_drag, str):
            object.__setattr__(self, "bead_drag", tuple(self.bead_drag))
        given = self.bead_drag if isinstance(self.bead_drag, tuple) else (self.bead_drag,)
        if not all(is_number(one) and one > 0.0 for one in given):
            raise InputError(f"bead_drag = {self.bead_drag!r} has to be positive finite numbers")
        if isinstance(self.bead_drag, tuple) and len(given) != self.links:
            raise InputError(
                f"bead_drag lists {len(given)} beads, and a chain of {self.links} links has"
                f" {self.links}; give one number for each, or one for all"
            )
        self.load.shares(self.links)

    @cached_property
    def system(self) -> Rod:
        """The tables: equal springs and beads, apart from what is asked for."""
        joint = np.ones(self.links)
        joint[0] = self.base_spring
        weight: Links = np.ones(self.links) * self.bead_drag
        outer_force, inner_force = self.load.shares(self.links)
        rod: type[PlainRod] = FoldingPlanarRod if self.confined else FoldingSpatialRod
        if self.spring == "unwrapped":
            rod = UnwrappedRod
        anisotropy = 1.0 - 1.0 / self.drag_ratio
        return rod(joint, weight, outer_force, inner_force, 1.0 / self.links, anisotropy, math.inf)

    @property
    def units(self) -> Units:
        """Names of the units of its numbers."""
        return chain_units(self.links)

    def linearised(self) -> tuple[Array, Array]:
        """Return stiffness and drag (N, N) of small displacements, the same for either spring."""
        if self.spring == "unwrapped":
            return replace(self, spring="angle").linearised()
        return super().linearised()
