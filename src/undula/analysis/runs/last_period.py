"""What the last periods of a run look like, little enough to be kept of thousands of runs."""

import math

import numpy as np

from undula.analysis.observables.shapes import mean_position, transverse
from undula.analysis.observables.spectrum import spectral_peak
from undula.analysis.observables.trajectory import Motion
from undula.analysis.runs.run import Run
from undula.arrays import Array, Instants, Shapes

#: Enough for a beat to be drawn as a fan of shapes.
SHAPES = 24
#: Enough for the path of the mean position over so many periods, of a torus one after the other.
INSTANTS, PERIODS = 360, 12


def last_period(run: Run) -> tuple[Instants, Shapes]:
    """Return samples about evenly over the last period of a run, the last one among them.

    Parameters
    ----------
    run : Run

    Returns
    -------
    times : ndarray, shape (SHAPES,)
        [T]
    shapes : ndarray, shape (SHAPES, N + 1, 3)
        Nodes [L]. Of a motion without a period they span that of the strongest line of its
        spectrum, of a straight one the whole late window.
    """
    nearest = _samples(run, 1, SHAPES)
    return run.shown.time[nearest], run.shown.nodes[nearest]


def last_path(run: Run) -> Array:
    """Return the mean position [L] over the last periods of a run, shape (INSTANTS, 3).

    Where the run shows fewer than `PERIODS` of them, over those that it shows.
    """
    return mean_position(run.shown.nodes[_samples(run, PERIODS, INSTANTS)])


def _samples(run: Run, periods: int, count: int) -> Array:
    """Return the indices (count,) of samples about evenly over the last periods of the window."""
    late = run.shown
    length = float(late.time[-1] - late.time[0])
    period = length if run.verdict.name == "straight" else min(length, periods * _period(run, late))
    wanted = late.time[-1] - period * np.arange(count - 1, -1, -1) / count
    return np.asarray(np.rint(np.interp(wanted, late.time, np.arange(late.time.size))).astype(int))


def _period(run: Run, late: Motion) -> float:
    """Return the period of the motion, or what comes nearest to one; infinite without any."""
    if late.time.size < 2:
        return 0.0
    if run.frequency is not None:
        rate = run.frequency.value
    else:
        rate = spectral_peak(late.time, transverse(mean_position(late.nodes))[:, None])
    return 1.0 / abs(rate) if rate else math.inf
