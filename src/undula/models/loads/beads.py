"""Follower forces on single beads of a chain, each against the tangent of the link it ends."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from undula.arrays import Links
from undula.errors import InputError
from undula.models.loads.analytic import Load


@dataclass(frozen=True)
class BeadLoad(Load):
    """A total force shared equally by some beads, or by all.

    Attributes
    ----------
    force : float
        Total force F, finite, at least 0.
    beads : tuple of int or "all"
        Numbers of the beads, counted from 1 at the base; any iterable is taken.

    Raises
    ------
    InputError
        There is no bead, one twice, or one with no number from 1 on.
    """

    beads: tuple[int, ...] | Literal["all"] = "all"

    def __post_init__(self) -> None:
        """Refuse what is no list of beads."""
        super().__post_init__()
        if self.beads == "all":
            return
        given = tuple(self.beads) if isinstance(self.beads, Iterable) else (self.beads,)
        whole = all(isinstance(b, int | np.integer) and not isinstance(b, bool) for b in given)
        if not (whole and given and min(given) >= 1 and len(set(given)) == len(given)):
            raise InputError(
                f"BeadLoad: beads = {self.beads!r} has to be 'all' or different whole numbers,"
                " counted from 1 at the base"
            )
        object.__setattr__(self, "beads", tuple(sorted(map(int, given))))

    def shares(self, links: int) -> tuple[Links, Links]:
        """Return what each link puts on its outer bead; nothing acts on the inner one."""
        loaded = range(1, links + 1) if self.beads == "all" else self.beads
        if max(loaded) > links:
            raise InputError(
                f"BeadLoad: beads = {self.beads!r} asks for bead {max(loaded)} of a chain of"
                f" {links} links; give numbers from 1 to {links}"
            )
        outer_force = np.zeros(links)
        outer_force[np.array(loaded) - 1] = self.force / len(loaded)
        return outer_force, np.zeros(links)
