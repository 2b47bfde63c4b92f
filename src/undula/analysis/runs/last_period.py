"""Shapes and mean path of the last periods of a run, small enough to store for thousands."""

import math

import numpy as np

from undula.analysis.observables.shapes import mean_position, transverse
from undula.analysis.observables.spectrum import spectral_peak
from undula.analysis.observables.trajectory import Motion
from undula.analysis.runs.run import Run
from undula.arrays import Array, Instants, Shapes

#: Number of shapes in a period, enough to draw a beat.
SHAPES = 24
#: Number of instants on the path of the mean position, and of the periods that it covers.
INSTANTS, PERIODS = 360, 12


def last_period(run: Run) -> tuple[Instants, Shapes]:
    """Return samples spread evenly over the last period of a run, including the last sample.

    Parameters
    ----------
    run : Run
        Result of a run.

    Returns
    -------
    times : ndarray, shape (SHAPES,)
        Times [T].
    shapes : ndarray, shape (SHAPES, N + 1, 3)
        Nodes [L]. For a motion without a period they span that of its strongest spectral line, for
        a straight one the whole late window.
    """
    nearest = _samples(run, 1, SHAPES)
    return run.shown.time[nearest], run.shown.nodes[nearest]


def last_path(run: Run) -> Array:
    """Return the path of the mean position over the last periods of a run.

    Parameters
    ----------
    run : Run
        Result of a run.

    Returns
    -------
    ndarray, shape (INSTANTS, 3)
        Positions [L] over `PERIODS` periods, or over those of the late window if they are fewer.
    """
    return mean_position(run.shown.nodes[_samples(run, PERIODS, INSTANTS)])


def _samples(run: Run, periods: int, count: int) -> Array:
    """Return indices (count,) of samples spread evenly over the last periods of the window."""
    window = run.shown
    length = float(window.time[-1] - window.time[0])
    period = (
        length if run.verdict.name == "straight" else min(length, periods * _period(run, window))
    )
    times = window.time[-1] - period * np.arange(count - 1, -1, -1) / count
    indices = np.interp(times, window.time, np.arange(window.time.size))
    return np.asarray(np.rint(indices).astype(int))


def _period(run: Run, window: Motion) -> float:
    """Return the period [T], or that of the strongest spectral line; infinite without either."""
    if window.time.size < 2:
        return 0.0
    if run.frequency is not None:
        rate = run.frequency.value
    else:
        rate = spectral_peak(window.time, transverse(mean_position(window.nodes))[:, None])
    return 1.0 / abs(rate) if rate else math.inf
