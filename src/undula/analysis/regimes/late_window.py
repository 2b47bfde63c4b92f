"""The late window of a run, as what names its motion looks at it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from undula.analysis.observables.planarity import planarity
from undula.analysis.observables.precession import plane_angle
from undula.analysis.observables.rotation import (
    LinkRotation,
    link_rotation,
    lowest_direction,
    sense_of_rotation,
)
from undula.analysis.observables.shapes import arc_weights, displacement, transverse
from undula.analysis.observables.spectrum import hann
from undula.analysis.regimes.evidence import Evidence
from undula.analysis.regimes.recurrence import Recurrence, recurrence
from undula.arrays import Array, Indices, Instants, Shapes

# Share out of the plane below which a motion is planar: a trace of the start that still decays.
PLANAR_TOLERANCE = 0.02
# Sense of rotation from which a motion goes round rather than to and fro.
GOES_ROUND = 0.5
# Fewer maxima than this do not show that a motion is irregular: with up to ten a period it would
# have come back four times.
MANY_MAXIMA = 40
# A windmilling link points backwards at times: its direction has this z component or less.
BACKWARDS = -0.7
# A criterion met by less than this factor does not decide between two names.
THIN = 1.05


@dataclass(frozen=True)
class Name:
    """A name with one sentence and the factor by which its criteria are met, at least 1.

    `still_changing` tells what still changes, if the motion only looks settled.
    """

    name: str
    reason: str
    margin: float
    still_changing: str = ""


@dataclass(frozen=True)
class LateWindow:
    """The late window of a run, with what is measured only where it is asked for.

    Attributes
    ----------
    time
        Equally spaced times [T], shape ``(m,)``.
    nodes
        Node positions [L], shape ``(m, N + 1, 3)``.
    seen
        What windows are measured for before anything comes back.
    axisymmetric
        Whether motions that differ by a turn are the same, as no direction across z is singled out.
    """

    time: Instants
    nodes: Shapes
    seen: Evidence
    axisymmetric: bool = True

    @cached_property
    def back(self) -> Recurrence | None:
        """How the shape comes back."""
        return recurrence(self.time, self.nodes, self.axisymmetric)

    @cached_property
    def sense(self) -> float:
        """Sense of rotation, from -1 to 1."""
        return sense_of_rotation(self.nodes)

    @cached_property
    def backwards(self) -> Indices:
        """Indices of the links that point backwards at times."""
        return np.flatnonzero(lowest_direction(self.nodes) <= BACKWARDS)

    @cached_property
    def winding(self) -> LinkRotation:
        """Turning of these links about axes across z."""
        return link_rotation(self.nodes, self.backwards)

    @property
    def plane_turn(self) -> float:
        """Angle by which the plane of the beat turns until the shape comes back [rad]."""
        # A half-turn is the mirror image of a beat in a plane, not a turning of the plane.
        return (self.back.turn + 0.5 * np.pi) % np.pi - 0.5 * np.pi if self.back else 0.0

    @cached_property
    def beat_planarity(self) -> float:
        """Share out of the plane of the beat when the slow turning of that plane is taken back."""
        back = self.back
        if back is None:
            return self.seen.planarity
        turned = -self.plane_turn / back.period * (self.time - self.time[0])
        return planarity(_turned(self.nodes, turned))

    @cached_property
    def bias(self) -> float:
        """How far the mean of the motion is from the axis, relative to the displacement."""
        sides, weights = transverse(self.nodes), arc_weights(self.nodes.shape[1])
        mean = hann(len(sides)) @ sides
        size = np.sqrt(np.mean(displacement(self.nodes) ** 2))
        return float(np.sqrt(np.sum(weights * np.abs(mean) ** 2)) / size)

    @cached_property
    def plane_turns(self) -> tuple[float, float]:
        """Turns about z of the plane of the beat in each half of the window, with sign."""
        angle = plane_angle(self.nodes, self.back.maxima if self.back else 1) / (2.0 * np.pi)
        middle = len(angle) // 2
        return float(angle[middle] - angle[0]), float(angle[-1] - angle[middle])

    @property
    def irregular(self) -> bool:
        """Whether so many maxima are seen that the shape ought to have come back, and has not."""
        return self.back is not None and self.back.maxima >= MANY_MAXIMA and not self.back.repeats

    def numbers(self) -> dict[str, float]:
        """All that is a number, by name, for the record of the run."""
        record = self.seen.numbers()
        if "sense" in self.__dict__:
            record["sense_of_rotation"] = self.sense
        if "bias" in self.__dict__:
            record["bias"] = self.bias
        if "plane_turns" in self.__dict__:
            record["plane_turns"] = sum(self.plane_turns)
        if "winding" in self.__dict__:
            record["winding_coherence"] = float(self.winding.coherence.max())
        if self.__dict__.get("back") is not None and self.back is not None:
            record |= {
                "maxima": float(self.back.maxima),
                "maxima_a_period": float(self.back.every),
                "recurrence_distance": self.back.distance,
                "shape_period": self.back.period,
                "turn_a_period": self.back.turn,
            }
        return record


def below(*criteria: tuple[float, float]) -> float:
    """Return the least factor by which values stay below their limits, at most a hundred."""
    return min(limit / max(value, 1e-2 * limit) for value, limit in criteria)


def _turned(nodes: Shapes, angle: Array) -> Shapes:
    """Return nodes (m, N + 1, 3) turned about z by angles (m,) [rad]."""
    cosine, sine = np.cos(angle)[:, None], np.sin(angle)[:, None]
    x, y, z = nodes[..., 0], nodes[..., 1], nodes[..., 2]
    return np.stack([cosine * x - sine * y, sine * x + cosine * y, z], axis=-1)
