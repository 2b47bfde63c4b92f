"""Buffer of the last samples of a run at finer intervals than the others.

Sampling during the run costs one polynomial evaluation; recomputing costs all the steps. An open-
ended run therefore stores fine samples of its last periods as soon as its period is known and its
samples are too few to resolve it.
"""

from collections import deque
from dataclasses import dataclass, field

import numpy as np

from undula.arrays import Array

#: Number of stored rows, enough for the 160 periods of the close-up of a motion that has not
#: settled.
STORED_ROWS = 12000
#: Number of rows in a period: that of a new interval, and the bounds of one that is kept.
TARGET_ROWS_PER_PERIOD, MIN_ROWS_PER_PERIOD, MAX_ROWS_PER_PERIOD = 40.0, 32.0, 96.0
#: Largest ratio of the interval of the run to that of the buffer.
MAX_PARTS = 256


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
        """Store rows at successive multiples of an interval.

        Parameters
        ----------
        interval : float
            Time between rows [T].
        first : int
            Multiple of the first row.
        rows : ndarray, shape (m, n + RATES)
            Unknowns and integrals in the lab frame.
        """
        if self.following(interval) != first:
            self.rows.clear()
        elif interval != self.interval:
            parts = round(interval / self.interval)
            whole = np.concatenate(self.rows)
            # A view would keep all rows alive.
            self.rows = deque([whole[(len(whole) - self.end) % parts :: parts].copy()])
        self.interval, self.end = interval, first + len(rows)
        self.rows.append(rows)
        stored = sum(map(len, self.rows))
        while stored - len(self.rows[0]) >= STORED_ROWS:
            stored -= len(self.rows.popleft())

    def following(self, interval: float) -> int | None:
        """Return the next multiple of an interval [T]; None if earlier multiples are missing."""
        if not self.rows or interval < self.interval:
            return None
        return -(-self.end // round(interval / self.interval))

    def samples(self, interval: float, first: int, last: int) -> Array | None:
        """Return the rows at multiples of an interval.

        Parameters
        ----------
        interval : float
            Time between rows [T].
        first, last : int
            First and last multiple, both included.

        Returns
        -------
        ndarray or None
            Shape (m, n + RATES); None if a row is missing.
        """
        if not self.rows or interval < self.interval:
            return None
        parts = round(interval / self.interval)
        begin = self.end - sum(map(len, self.rows))
        if first * parts < begin or last * parts >= self.end:
            return None
        rows = np.concatenate(self.rows)
        return rows[first * parts - begin : last * parts - begin + 1 : parts].copy()


def parts_of(interval: float, period: float, present: float) -> int:
    """Return the number of parts of an interval, a power of two, that resolve a period.

    Parameters
    ----------
    interval, period : float
        Interval of the run and period of its motion [T].
    present : float
        Present interval of the buffer [T], which is kept if it suffices; 0 for an empty buffer.
    """
    if (
        present
        and MIN_ROWS_PER_PERIOD <= period / present <= MAX_ROWS_PER_PERIOD
        and present <= interval
    ):
        return round(interval / present)
    parts = 1
    while interval * TARGET_ROWS_PER_PERIOD > parts * period and parts < MAX_PARTS:
        parts *= 2
    return parts
