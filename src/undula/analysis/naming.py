"""The name of a motion that has settled, from what a late window of it shows.

| name | what it is |
| --- | --- |
| spinning | a shape that is steady but for its rotation about z |
| modulated spinning | goes round the axis while its shape swings |
| planar flapping | to and fro in one plane through z |
| precessing flapping | the same in a plane that turns slowly |
| non-planar flapping | to and fro, but in no plane |
| windmilling | links turn about an axis across z |

All but the first are periodic up to a turn, or on a torus; what comes back to no shape may be
chaotic, which its Lyapunov exponent has to tell. Going round is told from going to and fro by the
sense of rotation (`undula.analysis.turning`): above one half it is the former.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from undula.analysis.evidence import Evidence
from undula.analysis.planes import planarity
from undula.analysis.returns import RECURRENT, STEADY_FACTOR, Recurrence, recurrence
from undula.analysis.turning import Winding, sense_of_rotation, winding
from undula.arrays import Array, Instants, Shapes

# Largest change of shape up to turns in spinning, relative: far above integration errors, far below
# any modulation that would deserve another name.
SHAPE_TOLERANCE = 5e-3
# The same for the energy, which is quadratic in the shape.
ENERGY_TOLERANCE = 1e-2
# A steady shape must be seen to come round once; in less it could grow or shrink unseen.
MIN_TURNS = 1.0
# Share out of the plane below which a motion is planar: a trace of the start that still decays.
PLANAR_TOLERANCE = 0.02
# Share out of the plane below which a beat in a turning plane still is one.
PRECESSING_TOLERANCE = 0.2
# Share of the motion that its harmonics may leave unexplained: the highest ones of a violent
# flapping, and one or two more where few samples a period make them fold together.
PERIODIC_TOLERANCE = 0.05
# Sense of rotation from which a motion goes round rather than to and fro.
GOES_ROUND = 0.5
# Coherence of the turning of a windmilling link: swings stay below 0.3, windmills above 0.7 (their
# axis turns while they are watched).
WINDMILLS = 0.6
# A windmilling link points backwards at times: its direction has this z component or less.
BACKWARDS = -0.7
# Fewer maxima of the energy than this do not show that a motion is irregular.
MANY_MAXIMA = 60
# A criterion met by less than this factor does not decide between two names.
THIN = 1.05


@dataclass(frozen=True)
class Name:
    """A name with the factor by which its criteria are met, at least 1, and one sentence."""

    name: str
    reason: str
    margin: float


@dataclass(frozen=True)
class Late:
    """The late window of a run, with what is measured only where it is asked for.

    Attributes
    ----------
    time
        Equally spaced times [T], shape ``(m,)``.
    nodes
        Node positions [L], shape ``(m, N + 1, 3)``.
    bending_energy
        Bending energy, shape ``(m,)``.
    seen
        What every window is measured for.
    """

    time: Instants
    nodes: Shapes
    bending_energy: Instants
    seen: Evidence

    @cached_property
    def back(self) -> Recurrence | None:
        """How the shape comes back."""
        return recurrence(self.time, self.nodes, self.bending_energy)

    @cached_property
    def sense(self) -> float:
        """Sense of rotation, from -1 to 1."""
        return sense_of_rotation(self.nodes)

    @cached_property
    def winding(self) -> Winding:
        """Turning of the links about axes across z."""
        return winding(self.nodes)

    @cached_property
    def beat_planarity(self) -> float:
        """Share out of the plane of the beat when the slow turning of that plane is taken back."""
        back = self.back
        if back is None:
            return self.seen.planarity
        # A half-turn is the mirror image of a beat in a plane, not a turning of the plane.
        turn = (back.turn + 0.5 * np.pi) % np.pi - 0.5 * np.pi
        return planarity(_turned(self.nodes, -turn / back.period * (self.time - self.time[0])))

    @property
    def irregular(self) -> bool:
        """Whether so many maxima are seen that the shape ought to have come back, and has not."""
        return self.back is not None and self.back.maxima >= MANY_MAXIMA and not self.back.repeats

    def numbers(self) -> dict[str, float]:
        """All that is a number, by name, for the record of the run."""
        record = self.seen.numbers()
        if "sense" in self.__dict__:
            record["sense_of_rotation"] = self.sense
        if "winding" in self.__dict__:
            record["winding_coherence"] = float(self.winding.coherence.max())
        if self.__dict__.get("back") is not None and self.back is not None:
            record |= {
                "energy_maxima": float(self.back.maxima),
                "maxima_a_period": float(self.back.every),
                "recurrence_distance": self.back.distance,
                "shape_period": self.back.period,
                "turn_a_period": self.back.turn,
            }
        return record


def steady(seen: Evidence) -> bool:
    """Whether the shape does not change, up to turns."""
    return seen.shape_change <= SHAPE_TOLERANCE and seen.energy_swing <= ENERGY_TOLERANCE


def spins(late: Late) -> Name | None:
    """Return the name of a steady shape that is seen to turn."""
    seen = late.seen
    if not steady(seen) or abs(seen.turns) < MIN_TURNS:
        return None
    change = f"its shape changes by {seen.shape_change:.2g} of itself"
    return Name(
        "spinning",
        f"rotates steadily: over {seen.turns:.3g} turns {change}",
        min(_below((seen.shape_change, SHAPE_TOLERANCE)), abs(seen.turns) / MIN_TURNS),
    )


def windmills(late: Late) -> Name | None:
    """Return the name of a motion in which links turn about an axis across z."""
    if late.nodes[..., 2].min() >= 0.0 and np.diff(late.nodes[..., 2], axis=1).min() >= 0.0:
        return None  # no link ever points backwards: the whole measure can be saved
    round_it = late.winding
    turning = (round_it.coherence >= WINDMILLS) & (round_it.lowest <= BACKWARDS)
    if not turning.any():
        return None
    links = np.flatnonzero(turning) + 1
    which = f"link {links[0]}" if len(links) == 1 else f"links {links[0]} to {links[-1]}"
    return Name(
        "windmilling",
        f"{which} of {len(turning)} turn about an axis across z,"
        f" {round_it.turns[turning].max():.3g} times in the window",
        float(round_it.coherence[turning].max()) / WINDMILLS,
    )


def flaps(late: Late, stationary: float) -> Name | None:
    """Return the name of a motion in a plane with one frequency."""
    seen = late.seen
    repeats = seen.misfit <= PERIODIC_TOLERANCE and seen.drift <= stationary
    if not (repeats and seen.planarity <= PLANAR_TOLERANCE):
        return None
    if seen.energy_swing <= ENERGY_TOLERANCE:
        return None
    plane = f"{seen.planarity:.2g} of the motion out of its plane"
    return Name(
        "planar flapping",
        f"periodic over {seen.periods:.3g} periods with {plane}",
        _below((seen.planarity, PLANAR_TOLERANCE), (seen.misfit, PERIODIC_TOLERANCE)),
    )


def returning(late: Late) -> Name | None:
    """Return the name of a motion whose shape comes back up to a turn."""
    back = late.back
    if back is None or not back.repeats or back.growth > STEADY_FACTOR:
        return None
    turn = np.degrees(back.turn)
    manner = (
        f"its shape comes back every {back.period:.4g} T to {back.distance:.1g} of itself, turned"
        f" by {turn:.3g} degrees"
    )
    return _kinematic(late, manner, _below((back.distance, RECURRENT)))


def wandering(late: Late) -> Name:
    """Return the name of a motion on a torus: its shape never comes back, nor does it diverge."""
    return _kinematic(late, "quasi-periodic: its shape never quite comes back", 1e2)


def _kinematic(late: Late, manner: str, margin: float) -> Name:
    """Name a motion by how it moves."""
    planar, sense = late.seen.planarity, abs(late.sense)
    if planar <= PLANAR_TOLERANCE:
        margin = min(margin, _below((planar, PLANAR_TOLERANCE)))
        return Name("planar flapping", f"{manner}, {planar:.2g} of it out of its plane", margin)
    if sense >= GOES_ROUND:
        margin = min(margin, sense / GOES_ROUND)
        return Name("modulated spinning", f"{manner}; it goes round the axis", margin)
    margin = min(margin, _below((sense, GOES_ROUND)))
    beat = late.beat_planarity
    if beat <= PRECESSING_TOLERANCE:
        margin = min(margin, _below((beat, PRECESSING_TOLERANCE)))
        return Name("precessing flapping", f"{manner}; each beat is {beat:.2g} off a plane", margin)
    margin = min(margin, beat / PRECESSING_TOLERANCE)
    return Name("non-planar flapping", f"{manner}; each beat is {beat:.2g} off a plane", margin)


def _below(*criteria: tuple[float, float]) -> float:
    """Return the least factor by which values stay below their limits, at most a hundred."""
    return min(limit / max(value, 1e-2 * limit) for value, limit in criteria)


def _turned(nodes: Shapes, angle: Array) -> Shapes:
    """Return nodes (m, N + 1, 3) turned about z by angles (m,) [rad]."""
    cosine, sine = np.cos(angle)[:, None], np.sin(angle)[:, None]
    x, y, z = nodes[..., 0], nodes[..., 1], nodes[..., 2]
    return np.stack([cosine * x - sine * y, sine * x + cosine * y, z], axis=-1)
