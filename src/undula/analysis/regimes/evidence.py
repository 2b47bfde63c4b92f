"""What a window of a run shows, each number measured once, and only if a verdict asks for it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from undula.analysis.observables.alignment import Compare, aligned_distance, largest_distance
from undula.analysis.observables.frequency import (
    Frequency,
    turning_frequency,
    whole_motion_frequency,
)
from undula.analysis.observables.harmonic_misfit import misfit
from undula.analysis.observables.linear_mode import LinearMotion, linear_motion
from undula.analysis.observables.planarity import planarity
from undula.analysis.observables.shapes import displacement, envelope, mean_position, transverse
from undula.analysis.observables.spectrum import spectral_peak
from undula.analysis.regimes.stationary_window import drift
from undula.arrays import Instants, Shapes

# Below this RMS displacement [L] the motion is linear to about its square, one per cent.
LINEAR = 0.1
# Largest change of shape of a steady motion, relative: far above integration errors, far below any
# modulation that would deserve another name.
STEADY_SHAPE = 5e-3
# A steady shape must be seen to come round once; in less it could grow or shrink unseen.
MIN_TURNS = 1.0
# Growth by less than this factor over the window is not told from a slow change of amplitude.
GROWTH_FACTOR = 1.2
# The halves differ by more than this share of the change of shape when it drifts (about twice it
# for a steady drift), and by a hundredth of it or less when it swings.
TRANSIENT = 0.2
# The rate in each half of the window agrees with the whole to this share in exponential growth.
RATE_AGREEMENT = 0.3
#: What the record of a run tells, where it was measured.
_NUMBERS = (
    *("displacement", "turns", "shape_change", "shape_drift", "energy_swing", "planarity"),
    *("drift", "periods", "samples_per_period", "misfit"),
)


@dataclass(frozen=True)
class Evidence:
    """A window of a run in which the filament is not straight throughout.

    What is measured on it is relative to the RMS displacement or the mean.

    Attributes
    ----------
    time
        Equally spaced times [T], shape ``(m,)``, m at least 2.
    nodes
        Node positions [L], shape ``(m, N + 1, 3)``.
    bending_energy
        Energy [B/L], shape ``(m,)``.
    rotation_angle
        Integral of the rate of turning about z [rad], shape ``(m,)``.
    compare
        How shapes are compared.
    """

    time: Instants
    nodes: Shapes
    bending_energy: Instants
    rotation_angle: Instants
    compare: Compare = aligned_distance

    @property
    def span(self) -> float:
        """Length of the window [T]."""
        return float(self.time[-1] - self.time[0])

    @cached_property
    def away(self) -> Instants:
        """Distance from straight [L], shape ``(m,)``."""
        return displacement(self.nodes)

    @cached_property
    def displacement(self) -> float:
        """RMS over samples and arc length of the distance from straight [L]."""
        # A window in which the filament is exactly straight has no shape to be relative to.
        return float(np.sqrt(np.mean(self.away**2))) or 1.0

    @cached_property
    def turns(self) -> float:
        """Turns about z over the window, with sign."""
        return float(self.rotation_angle[-1] - self.rotation_angle[0]) / (2.0 * np.pi)

    @cached_property
    def shape_change(self) -> float:
        """Largest distance from the middle sample's shape after the best turn."""
        middle = self.nodes[len(self.nodes) // 2]
        return largest_distance(self.nodes, middle, self.compare) / self.displacement

    @cached_property
    def shape_drift(self) -> float:
        """Distance between the first and the last shape after the best turn."""
        return float(self.compare(self.nodes[0], self.nodes[-1]).distance) / self.displacement

    @cached_property
    def energy_swing(self) -> float:
        """Largest minus smallest bending energy over the mean."""
        energy = envelope(self.bending_energy)
        return (energy.max - energy.min) / energy.mean if energy.mean > 0.0 else 0.0

    @cached_property
    def planarity(self) -> float:
        """Out-of-plane share, 0 to 0.71."""
        return planarity(self.nodes)

    @cached_property
    def drift(self) -> float:
        """Difference between the two halves of the window."""
        return drift(self.away, self.nodes, self.bending_energy)

    @cached_property
    def frequency(self) -> Frequency | None:
        """Frequency of the whole motion, if any, positive; of a turning shape that of its turns."""
        if self.spins:
            return turning_frequency(self.time, self.rotation_angle)
        return whole_motion_frequency(self.time, self.nodes)

    @cached_property
    def periods(self) -> float:
        """Periods of that frequency in the window; 0 when there is none."""
        return self.frequency.value * self.span if self.frequency else 0.0

    @cached_property
    def samples_per_period(self) -> float:
        """Samples a period of the strongest line of the mean position's spectrum.

        That line need not be good for a frequency. As many as there are samples when nothing moves.
        """
        line = abs(spectral_peak(self.time, transverse(mean_position(self.nodes))[:, None]))
        count = len(self.time)
        step = self.span / (count - 1)
        return min(float(count), 1.0 / (line * step)) if line > 0.0 else float(count)

    @cached_property
    def misfit(self) -> float:
        """Share of the whole shape's in-plane motion that is not periodic; 1 without frequency."""
        found = self.frequency
        return misfit(self.time, self.nodes, found.value) if found else 1.0

    @cached_property
    def growth(self) -> LinearMotion | None:
        """The exponential growth from straight, if the window shows one."""
        if float(np.max(self.away)) > LINEAR:
            return None
        motion = linear_motion(self.time, self.nodes)
        if motion is None or motion.rate * self.span < np.log(GROWTH_FACTOR):
            return None
        return motion if motion.rate_error <= RATE_AGREEMENT * motion.rate else None

    @property
    def steady(self) -> bool:
        """Whether the shape does not change."""
        return self.shape_change <= STEADY_SHAPE

    @property
    def spins(self) -> bool:
        """Whether the shape does not change but for turns, and is seen to make one."""
        free = self.compare is aligned_distance
        return free and self.steady and abs(self.turns) >= MIN_TURNS

    @property
    def transient(self) -> bool:
        """Whether the change of shape is a drift, not a swing, and so may end by itself."""
        return self.drift > TRANSIENT * self.shape_change

    def numbers(self) -> dict[str, float]:
        """Return what was measured and is a number, by name, for the record of the run.

        The frequency is always asked for in the end.
        """
        always = {"turns": self.turns, "periods": self.periods}
        record = {"samples": float(len(self.time)), **always}
        record |= {name: self.__dict__[name] for name in _NUMBERS if name in self.__dict__}
        if self.frequency:
            record |= {"frequency": self.frequency.value, "frequency_error": self.frequency.error}
        return record
