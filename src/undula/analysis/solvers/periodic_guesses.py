"""Guesses of a periodic motion from a run: its last shape and the period of its recurrence.

The period is that of the recurrence of the shape, or the one with which the run settled. Twice each
period is a further guess, since next to a period doubling shapes nearly recur after half.
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
import xarray as xr

from undula.analysis.observables.shapes import displacement
from undula.analysis.regimes.recurrence import Recurrence, recurrence
from undula.analysis.regimes.verdict import STRAIGHT
from undula.analysis.runs.run import Run
from undula.arrays import Instants, Nodes, Shapes

# Relative difference below which two periods are the same; those of a settled run agree to 1e-4.
_PERIOD_DIFFERENCE = 1e-2
# Verdicts on runs whose shape does not change, or decays.
_CONSTANT_SHAPES = (STRAIGHT, "spinning")


@dataclass(frozen=True)
class Seen:
    """The late part of a run, with its verdict.

    Attributes
    ----------
    time : ndarray, shape (m,)
        Equally spaced times [T], fine enough to follow single periods.
    nodes : ndarray, shape (m, N + 1, 3)
        Positions [L].
    verdict : str
        Name of the motion.
    period : float or None
        Period of the recurrence with which the run settled [T], None if it did not.
    turn_rate : float
        Mean rate of turning about the axis [cycles/T].
    """

    time: Instants
    nodes: Shapes
    verdict: str
    period: float | None
    turn_rate: float

    @classmethod
    def of(cls, run: Run | xr.Dataset) -> Self:
        """Return the late part of a run, computed or stored."""
        if isinstance(run, Run):
            late = run.shown
            return cls(late.time, late.nodes, *_periodicity(run.summary()))
        summary = json.loads(run.attrs["summary"])
        prefix = "close_" if "close_time" in run else ""
        time, start = run[f"{prefix}time"].values, summary["window"][0]
        first = int(np.searchsorted(time, start - 1e-9 * abs(start)))
        nodes = run[f"{prefix}nodes"].values[first:]
        return cls(time[first:], nodes, *_periodicity(summary))

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
    """A period of a shape up to a turn.

    Attributes
    ----------
    duration : float
        Time after which the shape recurs [T].
    angle : float
        Angle by which it has turned then [rad].
    maxima : int
        Number of maxima of the displacement in that time, 0 if it is not known.
    """

    duration: float
    angle: float
    maxima: int


def guesses_of(seen: Seen, *, axisymmetric: bool) -> tuple[Guess, ...]:
    """Return the periods that a run may have, the likeliest first.

    Parameters
    ----------
    seen : Seen
        The late part of the run.
    axisymmetric : bool
        True if shapes that differ by a turn about the axis are the same.

    Returns
    -------
    tuple of Guess
        Empty if the run does not repeat itself.
    """
    if seen.verdict in _CONSTANT_SHAPES:
        return ()  # only errors of integration recur
    guesses: list[Guess] = []
    recurring = _recurrence(seen, axisymmetric=axisymmetric)
    if recurring is not None:
        turn = recurring.turn if axisymmetric else 0.0
        guesses.append(Guess(recurring.period, turn, recurring.every))
    period = seen.period
    if period and all(
        abs(period - guess.duration) > _PERIOD_DIFFERENCE * period for guess in guesses
    ):
        turn = 2.0 * np.pi * seen.turn_rate * period if axisymmetric else 0.0
        guesses.append(Guess(period, turn, 1))
    doubled = [
        Guess(2.0 * guess.duration, 2.0 * guess.angle, 2 * guess.maxima) for guess in guesses
    ]
    return (*guesses, *doubled)


def _recurrence(seen: Seen, *, axisymmetric: bool) -> Recurrence | None:
    if len(seen.time) < 2:
        return None
    nearest = recurrence(seen.time, seen.nodes, axisymmetric)
    return nearest if nearest is not None and nearest.repeats else None


def _periodicity(summary: Mapping[str, Any]) -> tuple[str, float | None, float]:
    """Return verdict, period and rate of turning of a run's summary."""
    settled = summary["settled"]
    turning = summary["rotation_frequency"] or 0.0
    return summary["verdict"], settled["period"] if settled else None, turning
