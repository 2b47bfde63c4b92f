"""The last periods of a run, sampled more finely than the rest.

A long run has too few samples a period to tell what it does or to draw it. Its last periods are
then taken from what was noted of them on the way, or computed once more from a mark that the
simulation has kept, which gives the very same trajectory.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from undula.analysis.observables.trajectory import Motion
from undula.analysis.run_settings import Schedule
from undula.analysis.runs.sample_buffer import FEWEST
from undula.analysis.runs.simulation import ENOUGH_A_PERIOD, Simulation, copied
from undula.arrays import Array, Instants
from undula.models.model import Model
from undula.numerics.integration.stepper_state import StepperState
from undula.numerics.integration.time_loop import advance

#: Periods in a close-up, if the marks reach back so far: frequencies gain with their square.
PERIODS = 16.0
#: Of a motion that has not settled, so many: an irregular one takes more to be told as such.
PERIODS_UNSETTLED = 160.0
#: What repeats itself is judged from where it does so.
REPEATING = ("steady", "periodic")
#: A close-up that has as many samples is made no finer.
MOST_SAMPLES = 8000


@dataclass(frozen=True)
class CloseUp:
    """The last periods of a run at fine intervals, made when somebody asks.

    Attributes
    ----------
    model, schedule
        Those of the run.
    mark : Memory
        The integrator's at its beginning or before.
    time : ndarray, shape (m,)
        Equally spaced times [T].
    noted : ndarray or None
        The samples, shape (m, n + RATES), if they were noted on the way.
    """

    model: Model
    schedule: Schedule
    mark: StepperState
    time: Instants
    noted: Array | None

    @cached_property
    def motion(self) -> Motion:
        """The trajectory."""
        states = self.noted
        if states is None:
            states = sampled_again(self.model, self.schedule, self.mark, self.time)
        return Motion.of(self.model, self.time, states)


def close_up(simulation: Simulation) -> CloseUp | None:
    """Return the last periods of a simulation at fine intervals; None where its samples will do."""
    fast, slow = simulation.detector.periods(simulation.time)
    interval = simulation.interval
    if fast is None or interval * ENOUGH_A_PERIOD <= fast:
        return None
    end = simulation.time
    periods = PERIODS if simulation.settled or simulation.arrival else PERIODS_UNSETTLED
    start = max(end - periods * slow, simulation.earliest_mark, _repeating_from(simulation))
    # Powers of two, so that there are samples at the same times whoever makes them.
    parts = 1
    while interval * FEWEST > parts * fast and parts * (end - start) < MOST_SAMPLES * interval:
        parts *= 2
    first, last = math.ceil(start * parts / interval), (simulation.sampled - 1) * parts
    if last - first < 2:
        return None
    # Round-off must not put the first before the mark.
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
    return settled.since if settled is not None and settled.kind in REPEATING else 0.0


def sampled_again(model: Model, schedule: Schedule, mark: StepperState, times: Array) -> Array:
    """Sample a part of a run once more, at other times.

    Parameters
    ----------
    model, schedule
        Those of the run.
    mark : Memory
        One of its marks.
    times : ndarray, shape (m,)
        Increasing times between the mark and the end of the run [T].

    Returns
    -------
    ndarray, shape (m, n + RATES)
        The very trajectory of the run, at these times.
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
