"""The bead-spring chain: a linked rod with a spring at the base and a bead at the end of each link.

It has equal springs K at all joints, except for the base spring, and beads with isotropic drag
unless a drag ratio is given. Numbers are in units of L, K and the drag zeta of a bead: forces in
K/L, energies in K, times in zeta L^2/K. A chain of one link is stable under any force.

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

MAX_LINKS = 1000


@dataclass(frozen=True)
class Chain(LinkedRod):
    """A clamped chain of rigid links with springs at its joints and beads at their ends.

    Parameters
    ----------
    links : int
        Number of links and beads N, 1 to 1000.
    load : Load
        The follower force [K/L]: `TipLoad` on the last bead, `BeadLoad` on others, or a density.
    drag_ratio : float
        Normal over tangential drag coefficient of a bead, gamma, at least 1.
    base_spring : float
        Stiffness of the spring that clamps the first link [K], positive.
    bead_drag : float or tuple of float
        Drag coefficient of all beads, or of each bead from the base on [zeta], positive.
    confined : bool
        Confine the motion to the x-z plane.
    spring : {"angle", "unwrapped"}
        The angle psi in a joint's energy K psi^2 / 2: the angle between its links, from 0 to pi, or
        the unwrapped angle, which is continuous beyond pi, for confined chains. Initial angles are
        at most pi.

    Raises
    ------
    InputError
        A value is out of its range, or two values exclude each other.

    References
    ----------
    Ling, Guo & Kanso (2018), J. R. Soc. Interface 15: the bead-spring model.

    Examples
    --------
    >>> import undula as un
    >>> model = un.Chain(links=2, load=un.TipLoad(8.0))
    >>> model.links, model.units.force
    (2, 'K/L')
    >>> f"{un.onset(model).force:.6f}"  # K0 + 4 + w1/w2 in closed form
    '6.000000'
    """

    links: int
    load: Load
    drag_ratio: float = 1.0
    base_spring: float = 1.0
    bead_drag: float | tuple[float, ...] = 1.0
    confined: bool = False
    spring: Literal["angle", "unwrapped"] = "angle"

    def __post_init__(self) -> None:
        """Check the values."""
        whole = isinstance(self.links, int | np.integer) and not isinstance(self.links, bool)
        if not (whole and 1 <= self.links <= MAX_LINKS):
            raise InputError(
                f"links = {self.links!r} makes no chain; give a whole number from 1 to {MAX_LINKS}"
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
        drags = self.bead_drag if isinstance(self.bead_drag, tuple) else (self.bead_drag,)
        if not all(is_number(drag) and drag > 0.0 for drag in drags):
            raise InputError(f"bead_drag = {self.bead_drag!r} has to be positive finite numbers")
        if isinstance(self.bead_drag, tuple) and len(drags) != self.links:
            raise InputError(
                f"bead_drag lists {len(drags)} beads, and a chain of {self.links} links has"
                f" {self.links}; give one number for each, or one for all"
            )
        self.load.shares(self.links)

    @cached_property
    def system(self) -> Rod:
        """The tables, with equal springs and beads by default."""
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
        """Units of the model's numbers."""
        return chain_units(self.links)

    def linearised(self) -> tuple[Array, Array]:
        """Return stiffness and drag (N, N) of small displacements, the same for either spring."""
        if self.spring == "unwrapped":
            return replace(self, spring="angle").linearised()
        return super().linearised()
