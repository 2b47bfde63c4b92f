"""The last samples of a run at finer intervals than the rest, noted on the way.

To have a sample costs a polynomial, to compute the last periods once more all their steps. A run
that waits for its motion to settle therefore notes more of them than it will keep, as soon as it
knows how fast the motion is and that the samples of the run are too few to follow it.
"""

from collections import deque
from dataclasses import dataclass, field

import numpy as np

from undula.arrays import Array

#: Rows that are kept, for the 160 periods in which a motion that has not settled is looked at.
KEPT = 12000
#: Rows a period: so many are asked for, and between these bounds the interval is left as it is.
ASKED, FEWEST, MOST = 40.0, 32.0, 96.0
#: The finest interval as a part of that of the run.
FINEST = 256


@dataclass
class SampleBuffer:
    """Rows at multiples of an interval [T], without gaps.

    Attributes
    ----------
    interval : float
        Time between rows [T]: that between the samples of the run over a power of two.
    end : int
        The multiple that comes next.
    rows : deque of ndarray
        Shape (m, n + RATES) together.
    """

    interval: float = 0.0
    end: int = 0
    rows: deque[Array] = field(default_factory=deque)

    def note(self, interval: float, first: int, rows: Array) -> None:
        """Take down rows from the `first` multiple of an interval on."""
        if self.following(interval) != first:
            self.rows.clear()
        elif interval != self.interval:
            parts = round(interval / self.interval)
            whole = np.concatenate(self.rows)
            # A copy, for a view would hold on to all of them.
            self.rows = deque([whole[(len(whole) - self.end) % parts :: parts].copy()])
        self.interval, self.end = interval, first + len(rows)
        self.rows.append(rows)
        kept = sum(map(len, self.rows))
        while kept - len(self.rows[0]) >= KEPT:
            kept -= len(self.rows.popleft())

    def following(self, interval: float) -> int | None:
        """Return which multiple of an interval comes next; None if multiples of it are missing."""
        if not self.rows or interval < self.interval:
            return None
        return -(-self.end // round(interval / self.interval))

    def samples(self, interval: float, first: int, last: int) -> Array | None:
        """Return the rows at multiples of an interval, the last one among them, if all are here."""
        if not self.rows or interval < self.interval:
            return None
        parts = round(interval / self.interval)
        begin = self.end - sum(map(len, self.rows))
        if first * parts < begin or last * parts >= self.end:
            return None
        rows = np.concatenate(self.rows)
        return rows[first * parts - begin : last * parts - begin + 1 : parts].copy()


def parts_of(interval: float, period: float, kept: float) -> int:
    """Return in how many parts, a power of two, to divide an interval to follow a period.

    `kept` is the interval of the rows so far, 0 without any, which stays if it will do.
    """
    if kept and FEWEST <= period / kept <= MOST and kept <= interval:
        return round(interval / kept)
    parts = 1
    while interval * ASKED > parts * period and parts < FINEST:
        parts *= 2
    return parts
