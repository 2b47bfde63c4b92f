"""What a window of a run shows, measured once for every verdict to lean on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from undula.analysis.alignment import Compare, aligned_distance
from undula.analysis.decay import LinearMotion, linear_motion
from undula.analysis.frequency import Frequency, whole_motion_frequency
from undula.analysis.observables import displacement, envelope, mean_position, transverse
from undula.analysis.periodicity import misfit
from undula.analysis.planes import planarity
from undula.analysis.spectral import spectral_peak
from undula.analysis.window import drift
from undula.arrays import Instants, Shapes

# Below this RMS displacement [L] the motion is linear to about its square, one per cent.
LINEAR = 0.1
# Largest change of shape of a steady motion, relative: far above integration errors, far below any
# modulation that would deserve another name.
STEADY_SHAPE = 5e-3
# Growth by less than this factor over the window is not told from a slow change of amplitude.
GROWTH_FACTOR = 1.2
# The halves differ by more than this share of the change of shape when it drifts (about twice it
# for a steady drift), and by a hundredth of it or less when it swings.
TRANSIENT = 0.2
# The rate in each half of the window agrees with the whole to this share in exponential growth.
RATE_AGREEMENT = 0.3


@dataclass(frozen=True)
class Evidence:
    """Measurements on one window; shares are relative to the RMS displacement or the mean.

    Attributes
    ----------
    samples
        Samples in the window.
    displacement
        RMS over samples and arc length of the distance from straight [L].
    turns
        Turns about z over the window, with sign.
    shape_change
        Largest distance from the middle sample's shape after the best turn, relative.
    shape_drift
        Distance between the first and the last shape after the best turn, relative.
    energy_swing
        Largest minus smallest bending energy over the mean.
    planarity
        Out-of-plane share, 0 to 0.71.
    drift
        Difference between the two halves of the window, relative.
    frequency
        Frequency of the whole motion, if there is one.
    periods
        Periods of that frequency in the window; 0 when there is none.
    samples_per_period
        Samples a period of the strongest line of the mean position's spectrum, whether or not that
        line was good for a frequency; as many as there are samples when nothing moves.
    misfit
        Share of the whole shape's in-plane motion that is not periodic; 1 without a frequency.
    growth
        The exponential growth from straight, if the window shows one.
    """

    samples: float
    displacement: float
    turns: float
    shape_change: float
    shape_drift: float
    energy_swing: float
    planarity: float
    drift: float
    frequency: Frequency | None
    periods: float
    samples_per_period: float
    misfit: float
    growth: LinearMotion | None

    @property
    def steady(self) -> bool:
        """Whether the shape does not change."""
        return self.shape_change <= STEADY_SHAPE

    @property
    def transient(self) -> bool:
        """Whether the change of shape is a drift, not a swing, and so may end by itself."""
        return self.drift > TRANSIENT * self.shape_change

    def numbers(self) -> dict[str, float]:
        """All that is a number, by name, for the record of the run."""
        record = {name: value for name, value in vars(self).items() if isinstance(value, float)}
        if self.frequency:
            record |= {"frequency": self.frequency.value, "frequency_error": self.frequency.error}
        return record


def measure(
    time: Instants,
    nodes: Shapes,
    bending_energy: Instants,
    rotation_angle: Instants,
    compare: Compare = aligned_distance,
) -> Evidence:
    """Measure a window of a run in which the filament is not straight throughout.

    Parameters
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

    Returns
    -------
    Evidence
    """
    # A window in which the filament is exactly straight has no shape to be relative to.
    size = float(np.sqrt(np.mean(displacement(nodes) ** 2))) or 1.0
    frequency = whole_motion_frequency(time, nodes)
    span = float(time[-1] - time[0])
    energy = envelope(bending_energy)
    middle = nodes[len(nodes) // 2]
    return Evidence(
        samples=float(len(time)),
        displacement=size,
        turns=float(rotation_angle[-1] - rotation_angle[0]) / (2.0 * np.pi),
        shape_change=float(np.max(compare(nodes, middle).distance)) / size,
        shape_drift=float(compare(nodes[0], nodes[-1]).distance) / size,
        energy_swing=(energy.max - energy.min) / energy.mean if energy.mean > 0.0 else 0.0,
        planarity=planarity(nodes),
        drift=drift(nodes, bending_energy),
        frequency=frequency,
        periods=abs(frequency.value) * span if frequency else 0.0,
        samples_per_period=_samples_per_period(time, nodes),
        misfit=misfit(time, nodes, abs(frequency.value)) if frequency else 1.0,
        growth=_growth(time, nodes),
    )


def _samples_per_period(time: Instants, nodes: Shapes) -> float:
    line = abs(spectral_peak(time, transverse(mean_position(nodes))[:, None]))
    step = float(time[-1] - time[0]) / (len(time) - 1)
    return min(float(len(time)), 1.0 / (line * step)) if line > 0.0 else float(len(time))


def _growth(time: Instants, nodes: Shapes) -> LinearMotion | None:
    if float(np.max(displacement(nodes))) > LINEAR:
        return None
    motion = linear_motion(time, nodes)
    if motion is None or motion.rate * float(time[-1] - time[0]) < np.log(GROWTH_FACTOR):
        return None
    return motion if motion.rate_error <= RATE_AGREEMENT * motion.rate else None
