"""Relaxation of a run to the straight state: how far, how steadily, monotone or ringing."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from undula.analysis.observables.linear_mode import MIN_SAMPLES, LinearMotion, linear_motion
from undula.analysis.observables.sample_sums import largest_ahead
from undula.arrays import Instants, Shapes

# Share of the peak displacement below which integration errors dominate the motion.
MIN_REMAINING_SHARE = 1e-4
# Least factors by which the displacement has fallen from its peak, and over the later half of the
# time since (a single exponential that just meets the first gives its square root).
MIN_DECAY_FACTOR = 10.0
MIN_LATE_FACTOR = 3.0
# Least factor of a fall over the later half; a slow change of amplitude may fall by less.
MIN_FALLING_FACTOR = 1.2
# Largest relative difference of the rates in the two halves of the later part: a decay that levels
# off at a small motion, or accelerates, differs by more.
MAX_RATE_DIFFERENCE = 0.3
# Least share of the run after the peak; in a shorter one the fall may be part of an oscillation.
MIN_SHARE_AFTER_PEAK = 0.25
# Share of the run that counts as its end: a single sample may be at an extreme of an oscillation.
END_SHARE = 0.1


@dataclass(frozen=True)
class Relaxation:
    """The decay of the displacement from its peak.

    Attributes
    ----------
    factor
        Peak displacement over the largest displacement in the last tenth of the run, at least 1.
    late_factor
        The same over the later half of the time from the peak to the end (or to 1e-4 of the peak).
    start
        Index of the first sample of that later half.
    time, nodes
        Times [T] and nodes [L] of that later half; empty if the peak is in the last quarter of the
        run.
    """

    factor: float
    late_factor: float
    start: int
    time: Instants
    nodes: Shapes

    @cached_property
    def motion(self) -> LinearMotion | None:
        """Linear motion fitted to the later half; None for too few samples."""
        return linear_motion(self.time, self.nodes) if len(self.time) >= MIN_SAMPLES else None

    @property
    def vanished(self) -> bool:
        """True if only integration errors are left."""
        return self.factor >= 1.0 / MIN_REMAINING_SHARE

    @property
    def falling(self) -> bool:
        """True if the later half decays like one exponential."""
        if self.late_factor < MIN_FALLING_FACTOR:
            return False
        motion = self.motion
        return (
            motion is not None
            and motion.rate < 0.0
            and motion.rate_error <= MAX_RATE_DIFFERENCE * abs(motion.rate)
        )

    @property
    def complete(self) -> bool:
        """True if the run counts as relaxation to the straight state."""
        far = self.factor >= MIN_DECAY_FACTOR and self.late_factor >= MIN_LATE_FACTOR
        return self.vanished or (far and self.falling)


def relaxation(time: Instants, nodes: Shapes, away: Instants) -> Relaxation:
    """Measure the decay of a run from its largest displacement.

    Parameters
    ----------
    time
        Equally spaced times [T], shape ``(m,)``.
    nodes
        Node positions [L], shape ``(m, N + 1, 3)``, not all straight.
    away
        Displacement from straight [L], shape ``(m,)``.

    Returns
    -------
    Relaxation
    """
    # The largest later displacement: passages through straight do not count as relaxation.
    ahead = np.empty(len(away))
    peak, stop = largest_ahead(away, MIN_REMAINING_SHARE, ahead)
    start = (peak + stop) // 2
    end = len(time) - max(1, round(END_SHARE * len(time)))
    later = slice(start, stop if peak < (1.0 - MIN_SHARE_AFTER_PEAK) * len(time) else start)
    return Relaxation(
        factor=_ratio(ahead[peak], ahead[end]),
        late_factor=_ratio(ahead[start], ahead[stop - 1]) if start < stop else 1.0,
        start=min(start, len(time) - 1),
        time=time[later],
        nodes=nodes[later],
    )


def _ratio(larger: float, smaller: float) -> float:
    """Return the quotient, finite also for a motion that has decayed to round-off."""
    return float(larger / max(smaller, 1e-16 * larger))
