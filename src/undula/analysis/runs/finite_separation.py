"""Largest Lyapunov exponent from the growth of a finite separation, as in an experiment.

Two runs from nearby states are compared by their mean positions, each rotated about the axis into
the same half-plane, so that a difference in azimuth does not count. The logarithm of their distance
grows linearly until the distance saturates at the size of the motion; its slope, averaged over
several such pairs along one motion, estimates the largest exponent. Unlike the variational
equations (`undula.analysis.regimes.lyapunov`) each pair averages over a few e-foldings only.

Source: Ling, Guo & Kanso (2018), Lyapunov exponents from a finite separation of the mean position.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from undula.analysis.observables.shapes import mean_position
from undula.analysis.observables.trajectory import Motion
from undula.analysis.regimes.lyapunov import NotFollowed
from undula.analysis.run_settings import Ending, Schedule
from undula.analysis.runs.simulation import Simulation
from undula.arrays import Array, Instants, State
from undula.errors import InputError, is_number
from undula.models.model import Model

#: Standard deviation of the first separation of every coordinate [L]: far above errors of the
#: integration, and more than ten e-foldings below saturation.
FIRST_SEPARATION = 1e-7
#: Distance at which a separation saturates, as a share of the distance of the mean position from
#: straight.
SATURATION_SHARE = 0.03
#: Number of e-foldings in which the first separation grows to saturation in any motion.
E_FOLDINGS = 15.0
#: Number of successive pairs of runs, whose scatter gives the error.
PAIR_COUNT = 8
#: Number of samples of a pair.
SAMPLE_COUNT = 1000
# Distance from the axis and height of the mean position of the straight filament [L].
_STRAIGHT_MEAN = np.array([0.0, 0.5])
# Least number of samples in the fit of a line.
_MIN_FIT_SAMPLES = 10


@dataclass(frozen=True)
class Separation:
    """Divergence of nearby runs.

    Attributes
    ----------
    rate, error : float
        Mean slope of the logarithm of the distance [1/T], and its error: from the scatter over
        pairs, or half the mean difference between the halves of the lines if that is more.
    saturated : int
        Number of pairs whose distance saturated.
    time : ndarray, shape (m,)
        Times since the separation [T].
    distance : ndarray, shape (pairs, m)
        Distances of the mean positions in one half-plane [L].
    """

    rate: float
    error: float
    saturated: int
    time: Instants
    distance: Array

    def as_dict(self) -> dict[str, float]:
        """Return rate, error and number of saturated pairs in plain JSON types."""
        return {"rate": self.rate, "error": self.error, "saturated": self.saturated}


def finite_separation(
    model: Model,
    state: State,
    duration: float,
    *,
    pairs: int = PAIR_COUNT,
    rtol: float = 1e-9,
    atol: float = 1e-12,
    seed: int = 1,
    progress: Callable[[float], None] | None = None,
) -> Separation | NotFollowed:
    """Measure the rate of divergence of runs from nearby states.

    Parameters
    ----------
    model : Model
        Model of the filament or chain.
    state : ndarray, shape (model.size,)
        A state on the attractor, such as the last one of a run.
    duration : float
        Length of each pair of runs [T]: 15 over the largest exponent, if it is known.
    pairs : int
        Number of pairs, at least 2.
    rtol, atol : float
        Relative and absolute [rad] error tolerance, far below the first separation of 1e-7.
    seed : int
        Seed of the first separations.
    progress : callable, optional
        Called with the finished share of all runs, every few milliseconds.

    Returns
    -------
    Separation or NotFollowed
        NotFollowed if an integration fails.

    Raises
    ------
    InputError
        An argument is out of its range, or the joints of the model wind up.
    """
    _check(model, duration, pairs)
    schedule = Schedule(until=duration, samples=SAMPLE_COUNT, rtol=rtol, atol=atol)
    random = np.random.default_rng(seed)
    time, distances, fits = np.zeros(0), [], []
    for done in range(pairs):
        nearby = state + FIRST_SEPARATION * random.normal(size=state.size)
        first = _run(model, state, schedule, progress, (2 * done, 2 * pairs))
        if isinstance(first, NotFollowed):
            return first
        second = _run(model, nearby, schedule, progress, (2 * done + 1, 2 * pairs))
        if isinstance(second, NotFollowed):
            return second
        time, state = first.time, model.from_nodes(first.nodes[-1])
        path, other = _radius_and_height(first), _radius_and_height(second)
        distances.append(np.linalg.norm(path - other, axis=1))
        size = float(np.sqrt(np.mean(np.sum((path - _STRAIGHT_MEAN) ** 2, axis=1))))
        fits.append(_fit(time, distances[-1], SATURATION_SHARE * size))
    slopes, slope_changes = np.array([slopes for slopes, _ in fits]).T
    return Separation(
        rate=float(slopes.mean()),
        error=max(
            float(slopes.std(ddof=1)) / np.sqrt(pairs), 0.5 * abs(float(slope_changes.mean()))
        ),
        saturated=sum(saturated for _, saturated in fits),
        time=time,
        distance=np.array(distances),
    )


def _check(model: Model, duration: float, pairs: int) -> None:
    if not (is_number(duration) and duration > 0.0):
        raise InputError(f"duration = {duration!r} has to be a positive finite number")
    if not isinstance(pairs, int | np.integer) or pairs < 2:
        raise InputError(f"pairs = {pairs!r} has to be a whole number, at least 2")
    if model.unwrapped:
        raise InputError(
            "a state whose joints have wound up cannot be started from; ask for the Lyapunov"
            " exponents only"
        )


def _run(
    model: Model,
    x: State,
    schedule: Schedule,
    progress: Callable[[float], None] | None,
    place: tuple[int, int],
) -> Motion | NotFollowed:
    """Return the trajectory from a state; `place` is its number and the number of all runs."""
    simulation, (number, count) = Simulation.begin(model, x, schedule), place
    while simulation.advance():
        if progress:
            progress((number + simulation.time / schedule.end) / count)
    if simulation.ending is Ending.FAILED:
        return NotFollowed(f"the motion could not be followed: {simulation.cause}")
    return Motion.of(model, simulation.times, simulation.states)


def _radius_and_height(motion: Motion) -> Array:
    """Return distance from the axis and height (m, 2) of the mean position [L]."""
    x, y, z = mean_position(motion.nodes).T
    return np.stack([np.hypot(x, y), z], axis=1)


def _fit(time: Instants, distance: Array, level: float) -> tuple[tuple[float, float], bool]:
    """Fit a line to the logarithm of the distance up to a level.

    Returns its slope with the difference of slopes between its halves, and whether the level was
    reached.
    """
    above = np.flatnonzero(distance > level)
    end = max(_MIN_FIT_SAMPLES, int(above[0])) if above.size else distance.size
    logs = np.log(np.maximum(distance[:end], np.finfo(float).tiny))
    first, last = slice(0, end // 2), slice(end // 2, end)
    slope, early, late = (
        float(np.polyfit(time[part], logs[part], 1)[0]) for part in (slice(0, end), first, last)
    )
    return (slope, late - early), bool(above.size)
