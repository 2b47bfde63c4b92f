"""Growth of a small but finite separation: Lyapunov exponents as an experiment would see them.

Two runs from nearby states are compared by their mean positions, each turned about the axis into
the same half-plane, so that a difference in azimuth does not count. The logarithm of their distance
grows along a line until the distance is as large as the motion lets it become; its slope, over
several such pairs along one motion, estimates the largest exponent. Unlike the variational
equations (`undula.analysis.regimes.lyapunov`) this sees an average over a few e-foldings only, each
in another place.

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

#: First separation, of every coordinate in units of the length: far above errors of integration,
#: and more than ten e-foldings below saturation.
SEPARATION = 1e-7
#: A distance beyond this part of how far the mean position is from straight feels the size of the
#: motion.
SATURATED = 0.03
#: E-foldings in which the first separation grows to where it feels the size of any motion.
FOLDS = 15.0
#: Pairs of runs, one where the other ends: their scatter tells the error.
PAIRS = 8
#: Samples of a pair.
SAMPLES = 1000
# The mean position of a straight body: on the axis, half-way up [L].
_STRAIGHT = np.array([0.0, 0.5])
# A line through fewer samples is none.
_FEWEST = 10


@dataclass(frozen=True)
class Separation:
    """How nearby runs part.

    Attributes
    ----------
    rate, error : float
        Mean slope of the logarithm of the distance [1/T], and its error: from the scatter over
        pairs, or half the mean difference between the halves of the lines if that is more.
    saturated : int
        Pairs, of all, whose distance grew until it felt the size of the motion.
    time : ndarray, shape (m,)
        Times since the separation [T].
    distance : ndarray, shape (pairs, m)
        Distances of the mean positions, turned into one half-plane [L].
    """

    rate: float
    error: float
    saturated: int
    time: Instants
    distance: Array

    def as_dict(self) -> dict[str, float]:
        """Return its figures in plain JSON types."""
        return {"rate": self.rate, "error": self.error, "saturated": self.saturated}


def finite_separation(
    model: Model,
    state: State,
    duration: float,
    *,
    pairs: int = PAIRS,
    rtol: float = 1e-9,
    atol: float = 1e-12,
    seed: int = 1,
    progress: Callable[[float], None] | None = None,
) -> Separation | NotFollowed:
    """Measure how fast runs from nearby states part.

    Parameters
    ----------
    model : Model
    state : ndarray, shape (model.size,)
        A state on the attractor, such as the last one of a run.
    duration : float
        Time for which each pair is followed [T]: 15 over the largest exponent, if it is known.
    pairs : int
        Number of pairs, at least 2.
    rtol, atol : float
        Tolerances of the integration, far below the first separation of 1e-7.
    seed : int
        Seed of the first separations.
    progress : callable, optional
        Called with the part of all runs that is done, every few milliseconds.

    Returns
    -------
    Separation or NotFollowed

    Raises
    ------
    InputError
        An argument is out of its range, or joints wind up.
    """
    if not (is_number(duration) and duration > 0.0):
        raise InputError(f"duration = {duration!r} has to be a positive finite number")
    if not isinstance(pairs, int | np.integer) or pairs < 2:
        raise InputError(f"pairs = {pairs!r} has to be a whole number, at least 2")
    if model.unwrapped:
        raise InputError(
            "a state whose joints have wound up cannot be started from; ask for the Lyapunov"
            " exponents only"
        )
    schedule = Schedule(until=duration, samples=SAMPLES, rtol=rtol, atol=atol)
    random = np.random.default_rng(seed)
    time, distances, fits = np.zeros(0), [], []
    for done in range(pairs):
        nearby = state + SEPARATION * random.normal(size=state.size)
        both = []
        for which, x in enumerate((state, nearby)):
            motion = _run(model, x, schedule, progress, (2 * done + which, 2 * pairs))
            if isinstance(motion, NotFollowed):
                return motion
            both.append(motion)
        one, other = both
        time, state = one.time, model.from_nodes(one.nodes[-1])
        here, there = _out_and_up(one), _out_and_up(other)
        distances.append(np.linalg.norm(here - there, axis=1))
        size = float(np.sqrt(np.mean(np.sum((here - _STRAIGHT) ** 2, axis=1))))
        fits.append(_fit(time, distances[-1], SATURATED * size))
    slopes, bends = np.array([slopes for slopes, _ in fits]).T
    return Separation(
        rate=float(slopes.mean()),
        error=max(float(slopes.std(ddof=1)) / np.sqrt(pairs), 0.5 * abs(float(bends.mean()))),
        saturated=sum(saturated for _, saturated in fits),
        time=time,
        distance=np.array(distances),
    )


def _run(
    model: Model,
    x: State,
    schedule: Schedule,
    progress: Callable[[float], None] | None,
    place: tuple[int, int],
) -> Motion | NotFollowed:
    """Return a run from a state, which is one of so many."""
    simulation, (number, count) = Simulation.begin(model, x, schedule), place
    while simulation.advance():
        if progress:
            progress((number + simulation.time / schedule.end) / count)
    if simulation.ending is Ending.FAILED:
        return NotFollowed(f"the motion could not be followed: {simulation.cause}")
    return Motion.of(model, simulation.times, simulation.states)


def _out_and_up(motion: Motion) -> Array:
    """Return distance from the axis and height (m, 2) of the mean position [L]."""
    x, y, z = mean_position(motion.nodes).T
    return np.stack([np.hypot(x, y), z], axis=1)


def _fit(time: Instants, distance: Array, level: float) -> tuple[tuple[float, float], bool]:
    """Fit a line to the logarithm of the distance up to a level.

    Returns its slope with the difference of slopes between its halves, and whether the level was
    reached.
    """
    above = np.flatnonzero(distance > level)
    end = max(_FEWEST, int(above[0])) if above.size else distance.size
    logs = np.log(np.maximum(distance[:end], np.finfo(float).tiny))
    first, last = slice(0, end // 2), slice(end // 2, end)
    slope, early, late = (
        float(np.polyfit(time[part], logs[part], 1)[0]) for part in (slice(0, end), first, last)
    )
    return (slope, late - early), bool(above.size)
