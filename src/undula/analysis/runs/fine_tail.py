"""Close-up: the last periods of a run at finer intervals than the rest.

A long run has too few samples in a period to classify or to draw the motion. Its last periods are
then taken from the sample buffer, or recomputed from a stored state of the integrator, which gives
exactly the same trajectory.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from undula.analysis.observables.trajectory import Motion
from undula.analysis.run_settings import Schedule
from undula.analysis.runs.sample_buffer import MIN_ROWS_PER_PERIOD
from undula.analysis.runs.simulation import SUFFICIENT_SAMPLES_PER_PERIOD, Simulation, copied
from undula.arrays import Array, Instants
from undula.models.model import Model
from undula.numerics.integration.stepper_state import StepperState
from undula.numerics.integration.time_loop import advance

#: Number of periods in a close-up, if the marks are early enough: the accuracy of frequencies grows
#: with its square.
CLOSE_UP_PERIODS = 16.0
#: Number of periods in the close-up of a motion that has not settled: the classification of an
#: irregular one needs more.
UNSETTLED_PERIODS = 160.0
#: Kinds of settled motions whose close-up begins when they settle.
RECURRING_KINDS = ("steady", "periodic")
#: Number of samples from which a close-up is not refined further.
MAX_SAMPLES = 8000


@dataclass(frozen=True)
class CloseUp:
    """The last periods of a run at fine intervals, computed on first use.

    Attributes
    ----------
    model, schedule
        Of the run.
    mark : StepperState
        State of the integrator at the first time or before.
    time : ndarray, shape (m,)
        Equally spaced times [T].
    noted : ndarray or None
        The samples, shape (m, n + RATES), if the sample buffer has them.
    """

    model: Model
    schedule: Schedule
    mark: StepperState
    time: Instants
    noted: Array | None

    @cached_property
    def motion(self) -> Motion:
        """Trajectory of the close-up."""
        states = self.noted
        if states is None:
            states = sampled_again(self.model, self.schedule, self.mark, self.time)
        return Motion.of(self.model, self.time, states)


def close_up(simulation: Simulation) -> CloseUp | None:
    """Return the close-up of a simulation.

    Parameters
    ----------
    simulation : Simulation
        Run in progress.

    Returns
    -------
    CloseUp or None
        None if the samples of the simulation are fine enough, or no period is known.
    """
    fast, slow = simulation.detector.periods(simulation.time)
    interval = simulation.interval
    if fast is None or interval * SUFFICIENT_SAMPLES_PER_PERIOD <= fast:
        return None
    end = simulation.time
    periods = CLOSE_UP_PERIODS if simulation.settled or simulation.arrival else UNSETTLED_PERIODS
    start = max(end - periods * slow, simulation.earliest_mark, _repeating_from(simulation))
    # Powers of two, so that samples are at the same times for every length of the run.
    parts = 1
    while (
        interval * MIN_ROWS_PER_PERIOD > parts * fast
        and parts * (end - start) < MAX_SAMPLES * interval
    ):
        parts *= 2
    first, last = math.ceil(start * parts / interval), (simulation.sampled - 1) * parts
    if last - first < 2:
        return None
    # Round-off must not place the first time before the mark.
    times = np.maximum(interval / parts * np.arange(first, last + 1), start)
    return CloseUp(
        simulation.model,
        simulation.schedule,
        simulation.mark_before(times[0]),
        times,
        simulation.recent.samples(interval / parts, first, last),
    )


def _repeating_from(simulation: Simulation) -> float:
    settled = simulation.settled
    return settled.since if settled is not None and settled.kind in RECURRING_KINDS else 0.0


def sampled_again(model: Model, schedule: Schedule, mark: StepperState, times: Array) -> Array:
    """Recompute a part of a run at other times.

    Parameters
    ----------
    model, schedule
        Of the run.
    mark : StepperState
        A stored state of the integrator.
    times : ndarray, shape (m,)
        Rising times between the mark and the end of the run [T].

    Returns
    -------
    ndarray, shape (m, n + RATES)
        Samples of exactly the same trajectory at these times.
    """
    memory = copied(mark)
    states = np.empty((times.size, memory.differences.shape[1]))
    advance(
        model.system,
        memory,
        schedule.options(model),
        times,
        states,
        np.empty((0, 1 + states.shape[1])),
        np.iinfo(np.int64).max,
    )
    return states
