"""Evidence in a window of a run, each number measured on first use."""

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

# Largest RMS displacement of a linear motion [L]; the error is about its square, one per cent.
MAX_LINEAR_DISPLACEMENT = 0.1
# Largest change of shape of a steady motion, relative to the displacement: far above integration
# errors, far below a modulation with a name of its own.
MAX_STEADY_CHANGE = 5e-3
# Least number of turns of a steady shape in the window; in fewer, slow growth is undetected.
MIN_TURNS = 1.0
# Least factor of growth over the window; a slow change of amplitude may grow by less.
MIN_GROWTH_FACTOR = 1.2
# Least difference of the halves of the window, relative to the change of shape, that shows a drift:
# a steady drift has about 2, an oscillation at most 0.01.
MIN_TRANSIENT_DRIFT = 0.2
# Largest difference of the rates in the halves of the window, relative to the rate, at which growth
# counts as exponential.
MAX_RATE_DIFFERENCE = 0.3
#: Numbers in the record of a run, where they were measured.
_NUMBERS = (
    *("displacement", "turns", "shape_change", "shape_drift", "energy_swing", "planarity"),
    *("drift", "periods", "samples_per_period", "misfit"),
)


@dataclass(frozen=True)
class Evidence:
    """A window of a run in which the filament is not straight throughout.

    The measured quantities are relative to the RMS displacement or to the mean.

    Attributes
    ----------
    time
        Equally spaced times [T], shape ``(m,)``, m at least 2.
    nodes
        Node positions [L], shape ``(m, N + 1, 3)``.
    bending_energy
        Energy [B/L], shape ``(m,)``.
    rotation_angle
        Integral of the rate of rotation about z [rad], shape ``(m,)``.
    compare
        Distance between shapes, up to rotations or without them.
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
        """Largest distance from the shape of the middle sample after the best rotation."""
        middle = self.nodes[len(self.nodes) // 2]
        return largest_distance(self.nodes, middle, self.compare) / self.displacement

    @cached_property
    def shape_drift(self) -> float:
        """Distance between the first and the last shape after the best rotation."""
        return float(self.compare(self.nodes[0], self.nodes[-1]).distance) / self.displacement

    @cached_property
    def energy_swing(self) -> float:
        """Largest minus smallest bending energy over the mean."""
        energy = envelope(self.bending_energy)
        return (energy.max - energy.min) / energy.mean if energy.mean > 0.0 else 0.0

    @cached_property
    def planarity(self) -> float:
        """Out-of-plane share of the motion, from 0 to 0.71."""
        return planarity(self.nodes)

    @cached_property
    def drift(self) -> float:
        """Difference between the two halves of the window, see `stationary_window.drift`."""
        return drift(self.away, self.nodes, self.bending_energy)

    @cached_property
    def frequency(self) -> Frequency | None:
        """Positive frequency of the motion, for a spinning shape that of its rotation, or None."""
        if self.spinning:
            return turning_frequency(self.time, self.rotation_angle)
        return whole_motion_frequency(self.time, self.nodes)

    @cached_property
    def periods(self) -> float:
        """Number of periods of `frequency` in the window; 0 without a frequency."""
        return self.frequency.value * self.span if self.frequency else 0.0

    @cached_property
    def samples_per_period(self) -> float:
        """Samples in a period of the strongest spectral line of the mean position.

        The line need not be clear enough for a frequency. Without motion, the number of samples.
        """
        line = abs(spectral_peak(self.time, transverse(mean_position(self.nodes))[:, None]))
        count = len(self.time)
        step = self.span / (count - 1)
        return min(float(count), 1.0 / (line * step)) if line > 0.0 else float(count)

    @cached_property
    def misfit(self) -> float:
        """Share of the in-plane motion of all nodes that is not periodic; 1 without frequency."""
        frequency = self.frequency
        return misfit(self.time, self.nodes, frequency.value) if frequency else 1.0

    @cached_property
    def growth(self) -> LinearMotion | None:
        """Exponential growth from straight; None if the window does not show it."""
        if float(np.max(self.away)) > MAX_LINEAR_DISPLACEMENT:
            return None
        motion = linear_motion(self.time, self.nodes)
        if motion is None or motion.rate * self.span < np.log(MIN_GROWTH_FACTOR):
            return None
        return motion if motion.rate_error <= MAX_RATE_DIFFERENCE * motion.rate else None

    @property
    def steady(self) -> bool:
        """True if the shape does not change."""
        return self.shape_change <= MAX_STEADY_CHANGE

    @property
    def spinning(self) -> bool:
        """True if the shape changes by rotation alone, and by at least one turn."""
        axisymmetric = self.compare is aligned_distance
        return axisymmetric and self.steady and abs(self.turns) >= MIN_TURNS

    @property
    def transient(self) -> bool:
        """True if the change of shape is a drift, which may end, not an oscillation."""
        return self.drift > MIN_TRANSIENT_DRIFT * self.shape_change

    def numbers(self) -> dict[str, float]:
        """Return the numbers measured so far by name, with the frequency, for the record."""
        always = {"turns": self.turns, "periods": self.periods}
        record = {"samples": float(len(self.time)), **always}
        record |= {name: self.__dict__[name] for name in _NUMBERS if name in self.__dict__}
        if self.frequency:
            record |= {"frequency": self.frequency.value, "frequency_error": self.frequency.error}
        return record
