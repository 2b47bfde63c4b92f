"""Whether a run returns to straight: how far it has come, how steadily, and in which manner."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from undula.analysis.observables.linear_mode import MIN_SAMPLES, LinearMotion, linear_motion
from undula.analysis.observables.sample_sums import largest_ahead
from undula.arrays import Instants, Shapes

# Below this share of its peak the motion is left out: there the integration error takes over.
FLOOR = 1e-4
# The displacement must have fallen by this factor from its peak, and by the second one over the
# later half of the time in view (a steady exponential that just meets the first gives its root).
DECAY_FACTOR = 10.0
LATE_FACTOR = 3.0
# A fall by less than this over the later half is not told from a slow change of amplitude.
FALLING_FACTOR = 1.2
# Rates of the two halves of the later part may differ from the whole by this share: a decay that
# levels off at a small motion, or speeds up, differs by more.
RATE_AGREEMENT = 0.3
# A peak in this last part of the run leaves too little to see a fall in: it may be a swing's.
PEAK_SHARE = 0.25
# The end of the run is its last tenth: one sample could sit in a swing's turning point.
END_SHARE = 0.1


@dataclass(frozen=True)
class Straightening:
    """The fall of the displacement from its peak.

    Attributes
    ----------
    factor
        Peak displacement over the largest displacement in the last tenth of the run, at least 1.
    late_factor
        The same over the later half of the time from the peak to the end (or to 1e-4 of the peak).
    start
        First sample of that later half.
    time, nodes
        Times [T] and nodes [L] of that later half; none if the peak is in the last quarter of the
        run.
    """

    factor: float
    late_factor: float
    start: int
    time: Instants
    nodes: Shapes

    @cached_property
    def motion(self) -> LinearMotion | None:
        """The linear motion fitted to the later half; None when there are too few samples."""
        return linear_motion(self.time, self.nodes) if len(self.time) >= MIN_SAMPLES else None

    @property
    def vanished(self) -> bool:
        """Whether nothing but integration error is left."""
        return self.factor >= 1.0 / FLOOR

    @property
    def falling(self) -> bool:
        """Whether the later half falls, and as one exponential would."""
        if self.late_factor < FALLING_FACTOR:
            return False
        motion = self.motion
        return (
            motion is not None
            and motion.rate < 0.0
            and motion.rate_error <= RATE_AGREEMENT * abs(motion.rate)
        )

    @property
    def complete(self) -> bool:
        """Whether the run counts as returning to straight."""
        far = self.factor >= DECAY_FACTOR and self.late_factor >= LATE_FACTOR
        return self.vanished or (far and self.falling)


def straightening(time: Instants, nodes: Shapes, away: Instants) -> Straightening:
    """Measure how a run falls back from its largest displacement.

    Parameters
    ----------
    time
        Equally spaced times [T], shape ``(m,)``.
    nodes
        Node positions [L], shape ``(m, N + 1, 3)``, not all straight.
    away
        Their displacement from straight [L], shape ``(m,)``.

    Returns
    -------
    Straightening
    """
    # The largest displacement still to come: swings through straight do not count as arrival.
    ahead = np.empty(len(away))
    peak, stop = largest_ahead(away, FLOOR, ahead)
    start = (peak + stop) // 2
    end = len(time) - max(1, round(END_SHARE * len(time)))
    late = slice(start, stop if peak < (1.0 - PEAK_SHARE) * len(time) else start)
    return Straightening(
        factor=_ratio(ahead[peak], ahead[end]),
        late_factor=_ratio(ahead[start], ahead[stop - 1]) if start < stop else 1.0,
        start=min(start, len(time) - 1),
        time=time[late],
        nodes=nodes[late],
    )


def _ratio(larger: float, smaller: float) -> float:
    """Divide, and stay finite when the motion has died out to the last digit."""
    return float(larger / max(smaller, 1e-16 * larger))
