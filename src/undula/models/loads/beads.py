"""Follower forces on single beads of a chain, each opposite to the tangent of the link below it."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from undula.arrays import Links
from undula.errors import InputError
from undula.models.loads.analytic import Load


@dataclass(frozen=True)
class BeadLoad(Load):
    """A follower force divided equally among some beads of a chain, or among all.

    Parameters
    ----------
    force : float
        Total force F [K/L], finite, at least 0.
    beads : iterable of int or "all"
        Numbers of the beads, counted from 1 at the base; stored as a sorted tuple.

    Raises
    ------
    InputError
        The force is out of its range, or the numbers of beads are not different and at least 1.

    Examples
    --------
    >>> import undula as un
    >>> un.BeadLoad(8.0, (4, 2))
    BeadLoad(force=8.0, beads=(2, 4))
    >>> model = un.Chain(4, un.BeadLoad(8.0, "all"))
    """

    beads: tuple[int, ...] | Literal["all"] = "all"

    def __post_init__(self) -> None:
        """Check the values."""
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
        """Return the force of each link on its outer bead, and zeros for the inner bead."""
        loaded = range(1, links + 1) if self.beads == "all" else self.beads
        if max(loaded) > links:
            raise InputError(
                f"BeadLoad: beads = {self.beads!r} asks for bead {max(loaded)} of a chain of"
                f" {links} links; give numbers from 1 to {links}"
            )
        outer_force = np.zeros(links)
        outer_force[np.array(loaded) - 1] = self.force / len(loaded)
        return outer_force, np.zeros(links)
