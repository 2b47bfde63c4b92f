"""A settled motion: kind, start, period and remaining change."""

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class Settled:
    """A motion that repeats itself.

    Attributes
    ----------
    kind : {"at rest", "still", "steady", "periodic"}
        Straight; bent and at rest; rotating with a steady shape; or recurring up to rotations.
    since : float
        Time from which on the motion repeats itself to the tolerance [T].
    remaining : float
        Estimate of the remaining change, relative to the displacement.
    period : float or None
        Period of the shape up to rotation and reflection [T]; None for a steady shape.
    turn : float or None
        Time of one turn about the axis [T]; None without rotation.
    """

    kind: Literal["at rest", "still", "steady", "periodic"]
    since: float
    remaining: float
    period: float | None
    turn: float | None
