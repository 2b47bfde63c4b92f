"""Scene of a run: its arrays, verdict and time scales, and the intervals to be drawn."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

#: Number of periods in the close view of a run.
PERIODS_IN_FOCUS = 4
#: Least number of samples in a cycle for interpolation.
SAMPLES_PER_CYCLE = 8.0
# Least ratio of the whole run to its close view; a longer view shows nearly the same.
_LEAST_ENLARGEMENT = 1.6


@dataclass(frozen=True)
class Scene:
    """A run in the form that figures use, in the units of `undula.models`.

    Attributes
    ----------
    times : ndarray of shape (m,)
        Times of the samples [T], rising, m >= 2.
    nodes : ndarray of shape (m, n, 3)
        Positions of the nodes, base first [L].
    turn : ndarray of shape (m,)
        Angle of the frame in which the motion changes least between samples [rad]: the stored
        rotation angle, or zero where a turning frame has no advantage.
    energy, active, dissipation : ndarray of shape (m,)
        Bending energy; active power and dissipation [energy per T].
    units : mapping of str to str
        Names of the units by quantity.
    load, verdict : str
        Load and verdict in words.
    frequency : float or None
        Frequency of the whole motion [cycles per T], positive; None without one.
    period : float or None
        Period of the motion [T]; None without one, and if the run is shorter.
    cycle : float or None
        Shortest time of a swing in the frame of `turn` [T]; None without swings.
    settled_from : float or None
        Time from which the motion is settled [T]; None without one.
    close : Scene or None
        The last part of the run at finer intervals; None if it is not stored.
    """

    times: Floats
    nodes: Floats
    turn: Floats
    energy: Floats
    active: Floats
    dissipation: Floats
    units: Mapping[str, str]
    load: str
    verdict: str
    frequency: float | None
    period: float | None
    cycle: float | None
    settled_from: float | None
    close: "Scene | None" = None

    @property
    def detail(self) -> "Scene":
        """The scene that resolves single periods: the close-up, or the run itself without one."""
        return self.close or self

    @property
    def start(self) -> float:
        """Time of the first sample [T]."""
        return float(self.times[0])

    @property
    def end(self) -> float:
        """Time of the last sample [T]."""
        return float(self.times[-1])

    @property
    def duration(self) -> float:
        """Time from the first sample to the last [T]."""
        return self.end - self.start

    @property
    def samples_per_cycle(self) -> float:
        """Number of stored samples in one swing; infinite for a motion without swings."""
        spacing = self.duration / (len(self.times) - 1)
        return np.inf if self.cycle is None else self.cycle / spacing

    @property
    def interpolable(self) -> bool:
        """True if the samples are dense enough for interpolation."""
        return self.samples_per_cycle >= SAMPLES_PER_CYCLE

    @property
    def swings(self) -> float:
        """Number of cycles of the whole run in the laboratory frame."""
        if self.close is not None:
            return self.close.swings * self.duration / self.close.duration
        return max(turning_points(self.nodes[:, -1, k]) for k in (0, 1)) / 2

    @property
    def shown(self) -> tuple[float, float]:
        """The interval [T, T] whose shapes are drawn: last period, last part, or the whole run."""
        if self.period is not None:
            return self.end - self.period, self.end
        if self.focus is None or self.verdict.startswith("straight"):
            return self.start, self.end
        return self.focus

    @property
    def settled(self) -> tuple[float, float] | None:
        """The settled interval [T, T], None without one."""
        if self.settled_from is None or self.settled_from >= self.end:
            return None
        return max(self.settled_from, self.start), self.end

    @property
    def focus(self) -> tuple[float, float] | None:
        """The interval of the last few cycles [T, T]; None if they are most of the run."""
        if self.period is not None:
            length = PERIODS_IN_FOCUS * self.period
        else:
            length = self.duration * 2 * PERIODS_IN_FOCUS / max(self.swings, 1.0)
        if self.close is not None:
            length = min(length, self.close.duration)
        return (
            (self.end - length, self.end) if length < self.duration / _LEAST_ENLARGEMENT else None
        )


def turning_points(values: Floats, least: float = 1e-3) -> int:
    """Return the number of turning points of a quantity, ignoring changes below `least`.

    Parameters
    ----------
    values
        Values in the order of time.
    least
        Smallest change that counts.
    """
    moves = np.diff(np.round(values / least))
    moves = moves[moves != 0]
    return int(np.count_nonzero(moves[1:] * moves[:-1] < 0))
