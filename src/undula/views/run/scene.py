"""What a run has to show: its arrays, its verdict, its time scales, and the spans to draw."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

PERIODS_IN_FOCUS = 4
# Below this many samples a cycle, curves drawn between the samples would be invented.
SAMPLES_PER_CYCLE = 8.0


@dataclass(frozen=True)
class Scene:
    """A run as the views see it, in the units of `undula.models`.

    Attributes
    ----------
    times : ndarray of shape (m,)
        Times of the samples [T], rising, m >= 2.
    nodes : ndarray of shape (m, n, 3)
        Positions of the nodes, base first [L].
    turn : ndarray of shape (m,)
        Angle of the frame in which the motion is slowest between samples [rad]: the stored
        rotation angle, or zero where turning the motion back would only roughen it.
    energy, active, dissipation : ndarray of shape (m,)
        Bending energy; active power and dissipation, both energy per T.
    units : mapping of str to str
        Names of the units of its numbers by quantity.
    load, verdict : str
        The words of the run's summary.
    frequency : float or None
        Rate of the whole motion [cycles per T], positive, if there is one.
    period : float or None
        Time [T] after which the motion repeats; None if it does not, or the run is shorter.
    cycle : float or None
        Shortest time [T] in which the motion swings to and fro in the frame of `turn`.
    settled_from : float or None
        Time [T] from which the motion counts as settled.
    close : Scene or None
        The last part of the run once more, at finer intervals, if it has been stored.
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
        """What shows single periods: the close-up of the run if there is one, or the run itself."""
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
        """Stored samples in one swing of the motion; infinite if it does not swing."""
        spacing = self.duration / (len(self.times) - 1)
        return np.inf if self.cycle is None else self.cycle / spacing

    @property
    def interpolable(self) -> bool:
        """Whether the samples are dense enough to draw the motion between them."""
        return self.samples_per_cycle >= SAMPLES_PER_CYCLE

    @property
    def swings(self) -> float:
        """Number of cycles that the whole run goes through, as seen in the laboratory."""
        if self.close is not None:
            return self.close.swings * self.duration / self.close.duration
        return max(turning_points(self.nodes[:, -1, k]) for k in (0, 1)) / 2

    @property
    def shown(self) -> tuple[float, float]:
        """The part of the run [T, T] whose shapes tell most: last period, last part, or all."""
        if self.period is not None:
            return self.end - self.period, self.end
        if self.focus is None or self.verdict.startswith("straight"):
            return self.start, self.end
        return self.focus

    @property
    def settled(self) -> tuple[float, float] | None:
        """The settled part of the run [T, T], if there is one."""
        if self.settled_from is None or self.settled_from >= self.end:
            return None
        return max(self.settled_from, self.start), self.end

    @property
    def focus(self) -> tuple[float, float] | None:
        """The last few cycles [T, T], if they are a small part of the run."""
        if self.period is not None:
            length = PERIODS_IN_FOCUS * self.period
        else:
            length = self.duration * 2 * PERIODS_IN_FOCUS / max(self.swings, 1.0)
        if self.close is not None:
            length = min(length, self.close.duration)
        return (self.end - length, self.end) if length < self.duration / 1.6 else None


def turning_points(values: Floats, least: float = 1e-3) -> int:
    """Count the times at which a quantity turns back, movements smaller than `least` left out."""
    moves = np.diff(np.round(values / least))
    moves = moves[moves != 0]
    return int(np.count_nonzero(moves[1:] * moves[:-1] < 0))
