"""Lazily measured quantities of the late window of a run, used for classification."""

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

# Largest out-of-plane share of a planar motion, which allows for a decaying rest of the start.
PLANAR_TOLERANCE = 0.02
# Least sense of rotation of a rotation; below it the motion is an oscillation.
MIN_SENSE_OF_ROTATION = 0.5
# Least number of maxima of the displacement from which a motion without recurrence is irregular:
# with up to ten maxima a period, it would have recurred four times.
MIN_IRREGULAR_MAXIMA = 40
# Largest z component of the direction of a link that points backwards, as a windmilling link does
# at times.
MAX_BACKWARD_HEIGHT = -0.7
# Least factor by which the criteria of a name are met.
MIN_MARGIN = 1.05


@dataclass(frozen=True)
class Name:
    """A name for a motion.

    Attributes
    ----------
    name
        One of the names of `undula.analysis.regimes.names`.
    reason
        The evidence in one sentence.
    margin
        Factor by which the criteria are met, at least 1.
    still_changing
        A change that continues, in words; empty for a motion that has settled.
    """

    name: str
    reason: str
    margin: float
    still_changing: str = ""


@dataclass(frozen=True)
class LateWindow:
    """The late window of a run, with quantities that are measured on first use.

    Attributes
    ----------
    time
        Equally spaced times [T], shape ``(m,)``.
    nodes
        Node positions [L], shape ``(m, N + 1, 3)``.
    seen
        Measurements that need no recurrence.
    axisymmetric
        True if the body has rotational symmetry about z, so that motions are compared up to
        rotations.
    """

    time: Instants
    nodes: Shapes
    seen: Evidence
    axisymmetric: bool = True

    @cached_property
    def recurrence(self) -> Recurrence | None:
        """Recurrence of the shape; None with fewer than four maxima of the displacement."""
        return recurrence(self.time, self.nodes, self.axisymmetric)

    @cached_property
    def sense(self) -> float:
        """Sense of rotation, from -1 to 1."""
        return sense_of_rotation(self.nodes)

    @cached_property
    def backwards(self) -> Indices:
        """Indices of the links that point backwards at some sample."""
        return np.flatnonzero(lowest_direction(self.nodes) <= MAX_BACKWARD_HEIGHT)

    @cached_property
    def link_rotation(self) -> LinkRotation:
        """Rotation of these links about transverse axes."""
        return link_rotation(self.nodes, self.backwards)

    @property
    def plane_turn(self) -> float:
        """Rotation of the plane of the beat in one period of the shape [rad], in [-pi/2, pi/2)."""
        # A rotation by pi is the mirror image of a planar beat, not a rotation of its plane.
        recurrence = self.recurrence
        return (recurrence.turn + 0.5 * np.pi) % np.pi - 0.5 * np.pi if recurrence else 0.0

    @cached_property
    def beat_planarity(self) -> float:
        """Out-of-plane share of the motion in a frame that rotates with the plane of the beat."""
        recurrence = self.recurrence
        if recurrence is None:
            return self.seen.planarity
        turned = -self.plane_turn / recurrence.period * (self.time - self.time[0])
        return planarity(_turned(self.nodes, turned))

    @cached_property
    def bias(self) -> float:
        """Distance of the mean shape from the axis, relative to the RMS displacement."""
        sides, weights = transverse(self.nodes), arc_weights(self.nodes.shape[1])
        mean = hann(len(sides)) @ sides
        rms_displacement = np.sqrt(np.mean(displacement(self.nodes) ** 2))
        return float(np.sqrt(np.sum(weights * np.abs(mean) ** 2)) / rms_displacement)

    @cached_property
    def plane_turns(self) -> tuple[float, float]:
        """Signed turns about z of the plane of the beat in each half of the window."""
        maxima = self.recurrence.maxima if self.recurrence else 1
        angle = plane_angle(self.nodes, maxima) / (2.0 * np.pi)
        middle = len(angle) // 2
        return float(angle[middle] - angle[0]), float(angle[-1] - angle[middle])

    @property
    def irregular(self) -> bool:
        """True if the shape does not recur although the window has enough maxima for it."""
        recurrence = self.recurrence
        if recurrence is None:
            return False
        return recurrence.maxima >= MIN_IRREGULAR_MAXIMA and not recurrence.repeats

    def numbers(self) -> dict[str, float]:
        """Return the numbers measured so far by name, for the record of the run."""
        record = self.seen.numbers()
        if "sense" in self.__dict__:
            record["sense_of_rotation"] = self.sense
        if "bias" in self.__dict__:
            record["bias"] = self.bias
        if "plane_turns" in self.__dict__:
            record["plane_turns"] = sum(self.plane_turns)
        if "link_rotation" in self.__dict__:
            record["winding_coherence"] = float(self.link_rotation.coherence.max())
        if self.__dict__.get("recurrence") is not None and self.recurrence is not None:
            record |= {
                "maxima": float(self.recurrence.maxima),
                "maxima_a_period": float(self.recurrence.every),
                "recurrence_distance": self.recurrence.distance,
                "shape_period": self.recurrence.period,
                "turn_a_period": self.recurrence.turn,
            }
        return record


def below(*criteria: tuple[float, float]) -> float:
    """Return the least factor by which values stay below their limits.

    Parameters
    ----------
    *criteria
        Pairs of a value, at least 0, and its limit, positive.

    Returns
    -------
    float
        The least quotient of limit and value, at most 100.
    """
    return min(limit / max(value, 1e-2 * limit) for value, limit in criteria)


def _turned(nodes: Shapes, angle: Array) -> Shapes:
    """Return nodes (m, N + 1, 3) rotated about z by angles (m,) [rad]."""
    cosine, sine = np.cos(angle)[:, None], np.sin(angle)[:, None]
    x, y, z = nodes[..., 0], nodes[..., 1], nodes[..., 2]
    return np.stack([cosine * x - sine * y, sine * x + cosine * y, z], axis=-1)
