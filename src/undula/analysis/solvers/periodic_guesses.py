"""Where a run says that a periodic motion is: its last shape, the period after which it comes back.

The period is that of the recurrence of its shape, or the one that it settled with. Twice that is a
guess as well, since next to a period doubling shapes come back nearly after half.
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
import xarray as xr

from undula.analysis.observables.shapes import displacement
from undula.analysis.regimes.classify import STRAIGHT
from undula.analysis.regimes.recurrence import Recurrence, recurrence
from undula.analysis.runs.run import Run
from undula.arrays import Instants, Nodes, Shapes

# Periods that differ by less than this share are one: those of a settled run agree to 1e-4.
_SAME = 1e-2
# Verdicts on shapes that do not change, or come to nothing.
_UNCHANGED = (STRAIGHT, "spinning")


@dataclass(frozen=True)
class Seen:
    """What the late part of a run shows.

    Attributes
    ----------
    time : ndarray, shape (m,)
        Equally spaced times [T], fine enough to follow single periods.
    nodes : ndarray, shape (m, N + 1, 3)
        Positions [L].
    verdict : str
    period : float or None
        Time after which the run repeats itself [T], if it has settled so.
    turn_rate : float
        Rate of turning about the axis [cycles/T], in the mean.
    """

    time: Instants
    nodes: Shapes
    verdict: str
    period: float | None
    turn_rate: float

    @classmethod
    def of(cls, run: Run | xr.Dataset) -> Self:
        """Return what a run shows, as it was computed or as it was stored."""
        if isinstance(run, Run):
            told, late = run.summary(), run.shown
            return cls(late.time, late.nodes, *_told(told))
        told = json.loads(run.attrs["summary"])
        prefix = "close_" if "close_time" in run else ""
        time = run[f"{prefix}time"].values
        late_from = int(np.searchsorted(time, told["window"][0] - 1e-9 * abs(told["window"][0])))
        return cls(time[late_from:], run[f"{prefix}nodes"].values[late_from:], *_told(told))

    @property
    def last(self) -> Nodes:
        """The last shape (N + 1, 3) [L]."""
        return np.asarray(self.nodes[-1])

    @property
    def size(self) -> float:
        """RMS displacement [L]."""
        return float(np.sqrt(np.mean(displacement(self.nodes) ** 2)))


@dataclass(frozen=True)
class Guess:
    """A time after which a shape comes back [T], turned by an angle [rad].

    With it comes the number of maxima of the displacement in that time.
    """

    duration: float
    angle: float
    maxima: int


def guesses_of(seen: Seen, *, axisymmetric: bool) -> tuple[Guess, ...]:
    """Return the periods that a run may have, the likeliest first; none if it does not repeat.

    Parameters
    ----------
    seen : Seen
    axisymmetric : bool
        Whether turns about the axis do not count.
    """
    if seen.verdict in _UNCHANGED:
        return ()  # what comes back are errors of integration
    found: list[Guess] = []
    back = _recurrence(seen, axisymmetric=axisymmetric)
    if back is not None:
        found.append(Guess(back.period, back.turn if axisymmetric else 0.0, back.every))
    period = seen.period
    if period and all(abs(period - one.duration) > _SAME * period for one in found):
        turned = 2.0 * np.pi * seen.turn_rate * period if axisymmetric else 0.0
        found.append(Guess(period, turned, 1))
    doubled = [Guess(2.0 * one.duration, 2.0 * one.angle, 2 * one.maxima) for one in found]
    return (*found, *doubled)


def _recurrence(seen: Seen, *, axisymmetric: bool) -> Recurrence | None:
    found = recurrence(seen.time, seen.nodes, axisymmetric) if len(seen.time) > 1 else None
    return found if found is not None and found.repeats else None


def _told(summary: Mapping[str, Any]) -> tuple[str, float | None, float]:
    """Return verdict, period and rate of turning of a run's summary."""
    settled = summary["settled"]
    turning = summary["rotation_frequency"] or 0.0
    return summary["verdict"], settled["period"] if settled else None, turning
