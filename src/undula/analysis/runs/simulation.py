"""A run in progress, which can be advanced, observed, saved, stopped and resumed.

`Simulation` owns the state of the integrator and the samples so far. Samples lie at multiples of
one interval. A run to a given time has the interval of the requested number of samples. An
open-ended run starts with a short interval and doubles it, dropping every other sample, whenever
there are twice as many samples as requested.
"""

import math
from collections import deque
from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np

from undula.analysis.observables.alignment import comparison
from undula.analysis.run_settings import Ending, Schedule
from undula.analysis.runs import stop_rule as rules
from undula.analysis.runs.early_stop import StateDetector
from undula.analysis.runs.memory_needed import refuse_too_large
from undula.analysis.runs.reached_state import ReachedState
from undula.analysis.runs.sample_buffer import SampleBuffer, parts_of
from undula.analysis.runs.settled_motion import Settled
from undula.analysis.runs.settling import MotionRates, SettlingDetector
from undula.analysis.runs.stop_rule import Decision, Observation
from undula.arrays import Array, State
from undula.errors import InputError
from undula.models.given_shapes import finite_array, refuse_misfits
from undula.models.model import Model
from undula.numerics.integration import stepper_state as names
from undula.numerics.integration.schemes import NDF
from undula.numerics.integration.status import Status
from undula.numerics.integration.stepper_state import StepperState, start
from undula.numerics.integration.system import RATES
from undula.numerics.integration.time_loop import advance

#: Largest numbers of steps and samples between two checks of the run: about a millisecond.
MAX_STEPS_PER_CHECK, MAX_SAMPLES_PER_CHECK = 150, 256
#: Largest inclination, per link, that round-off makes of a straight start [rad].
ROUND_OFF_INCLINATION = 8.0 * float(np.finfo(float).eps)
#: Number of samples in a period with which a run needs no close-up.
SUFFICIENT_SAMPLES_PER_PERIOD = 24.0
#: Number of stored integrator states, and least number of steps between two of them: from these
#: marks the last periods are sampled again at finer intervals.
STORED_MARKS, STEPS_PER_MARK = 400, 450


@dataclass
class Simulation:
    """A run in the making, from `begin` or from `undula.analysis.runs.checkpoint.resume`.

    Attributes
    ----------
    model, schedule, ending, cause, arrival, tight_from
        As in `undula.analysis.runs.run.Run`.
    memory : StepperState
        State of the integrator.
    interval : float
        Time between samples [T].
    rows : list of ndarray
        Samples so far, shape (m, n + RATES) together: unknowns in the lab frame, then the integrals
        of the rate of rotation, of the active power and of the dissipation.
    observation : Observation or None
        Observation of the settled motion; None before the motion has settled.
    observe_until : float
        Earliest end of the observation [T].
    recent : SampleBuffer
        Last samples at finer intervals.
    marks : deque of StepperState
        Earlier states of the integrator, in order of time.
    """

    model: Model
    schedule: Schedule
    memory: StepperState
    interval: float
    rows: list[Array] = field(default_factory=list)
    ending: Ending = Ending.RUNNING
    observation: Observation | None = None
    arrival: ReachedState | None = None
    tight_from: float | None = None
    observe_until: float = 0.0
    cause: str = ""
    recent: SampleBuffer = field(default_factory=SampleBuffer)
    sampled: int = field(init=False)
    marks: deque[StepperState] = field(default_factory=lambda: deque(maxlen=STORED_MARKS))

    def __post_init__(self) -> None:
        """Count the samples, and begin to observe."""
        self.sampled = sum(map(len, self.rows))  # used several times in a check
        self._observe_afresh()

    def _observe_afresh(self) -> None:
        """Begin to observe the run under its present schedule."""
        self.options = self.schedule.options(self.model)
        first = self.rows[0][0] if self.rows else self.memory.differences[0]
        tangent_distance = self.model.tangent_distance(self.model.positions(first[:-RATES]))
        if tangent_distance <= ROUND_OFF_INCLINATION * self.model.links:
            tangent_distance = 0.0
        compare = comparison(axisymmetric=self.model.axisymmetric)
        self.detector = SettlingDetector(self.schedule.rtol, tangent_distance, compare)
        self.state_detector = StateDetector(self.model)
        self.marks.append(copied(self.memory))

    @classmethod
    def begin(cls, model: Model, x: State, schedule: Schedule) -> Self:
        """Return a new run from the state x (model.size,) at time 0; raise InputError if wrong."""
        refuse_too_large(model, schedule)
        x = finite_array(x, "the start")
        if x.shape != (model.size,):
            shapes = f"a start of shape {x.shape} is no state of this model"
            raise InputError(f"{shapes}; give {model.size} finite numbers")
        refuse_misfits(model.nodes(x), extensible=model.extensible)
        x = model.admissible(x)
        unknowns, rates = model.unknowns_and_rates(x)
        speed = float(np.abs(model.positions(rates[:-RATES])).max())
        reach = schedule.atol + schedule.rtol * float(np.abs(x - model.straight()).max())
        step = reach / speed if speed > 0.0 else schedule.end * 1e-3
        memory = start(model.system, NDF, unknowns, rates, 0.0, min(step, schedule.end))
        return cls(model, schedule, memory, schedule.interval)

    @property
    def settled(self) -> Settled | None:
        """The settled motion; None before the motion has settled."""
        return None if self.observation is None else self.observation.settled

    @property
    def time(self) -> float:
        """Time of the last sample [T]."""
        return max(0, self.sampled - 1) * self.interval

    @property
    def times(self) -> Array:
        """Times of the samples [T], shape (m,)."""
        return self.interval * np.arange(self.sampled, dtype=np.float64)

    @property
    def states(self) -> Array:
        """The samples, shape (m, n + RATES)."""
        if len(self.rows) != 1:
            width = self.memory.differences.shape[1]
            self.rows = [np.concatenate([np.zeros((0, width)), *self.rows])]
        return self.rows[0]

    def advance(self) -> bool:
        """Integrate for some milliseconds; return False at the end of the run."""
        last = math.ceil(self.schedule.end / self.interval - 1e-9)
        ahead = min(self.sampled + MAX_SAMPLES_PER_CHECK, self._enough(), last + 1)
        if ahead <= self.sampled:
            self.apply(rules.at_the_end(self.schedule, self.observation))
            return False
        width = self.memory.differences.shape[1]
        noted = self._parts()
        parts = max(1, noted)
        fine = np.arange(self._first(parts), (ahead - 1) * parts + 1)
        most = self.state_detector.steps if self.schedule.until == "solved" else MAX_STEPS_PER_CHECK
        states, sections = np.empty((fine.size, width)), np.empty((most, 1 + width))
        code, filled, found = advance(
            self.model.system,
            self.memory,
            self.options,
            self.interval / parts * fine,
            states,
            sections,
            most,
        )
        # A check may end long before all times are reached: a copy does not keep the rest alive.
        states = states if filled == fine.size else states[:filled].copy()
        self._keep(states if parts == 1 else states[-fine[0] % parts :: parts].copy())
        if noted:
            self.recent.note(self.interval / parts, int(fine[0]), states)
        return self._after_steps(self._status(code), sections[:found])

    def _after_steps(self, status: Status, maxima: Array) -> bool:
        """Note times and states of maxima (k, 1 + n + RATES); return False where the run ends."""
        if status not in (Status.DONE, Status.PAUSED):
            self.ending, self.cause = Ending.FAILED, status.advice
            return False
        if self.memory.count[names.STEPS] >= self.marks[-1].count[names.STEPS] + STEPS_PER_MARK:
            self.marks.append(copied(self.memory))
        shapes = self._nodes(maxima[:, 1:]) if len(maxima) else ()
        self.detector.note(self._pace(), list(zip(maxima[:, 0].tolist(), shapes, strict=True)))
        return not self.schedule.open_ended or self._goes_on()

    def apply(self, decision: Decision) -> None:
        """Carry out a decision of the stop rule."""
        match decision:
            case rules.Stop(ending):
                self.ending = ending
            case rules.Observe(observation, until):
                self.observation, self.observe_until = observation, max(self.observe_until, until)
                self.ending = Ending.RUNNING
            case rules.Tighten(rtol):
                self._tighten(rtol)
            case rules.Continue():
                self.ending = Ending.RUNNING

    def _status(self, code: int) -> Status:
        """Return the status of the integration, after removing samples that are not finite."""
        if np.isfinite(self.memory.differences[0]).all():
            return Status(code)
        self.rows[-1] = self.rows[-1][np.isfinite(self.rows[-1]).all(axis=1)]
        self.sampled = sum(map(len, self.rows))
        return Status.NOT_FINITE

    def _keep(self, rows: Array) -> None:
        """Add samples to those so far."""
        self.rows.append(rows)
        self.sampled += len(rows)

    def _parts(self) -> int:
        """Return the number of parts of an interval for the close-up; 0 without a close-up."""
        fast, _ = self.detector.periods(self.time)
        if not self.schedule.open_ended or fast is None or self.detector.turns_steadily():
            return 0
        return parts_of(self.interval, fast, self.recent.interval)

    def _first(self, parts: int) -> int:
        """Return the next multiple of a part of the interval that is sampled."""
        following = max(0, self.sampled - 1) * parts + min(1, self.sampled)
        if parts == 1:
            return following
        interval, real = self.interval / parts, self.memory.real
        noted = self.recent.following(interval)
        if noted is not None and noted >= following:
            return noted
        # Times before the last step can no longer be sampled.
        available = math.floor(float(real[names.TIME] - real[names.STEP]) / interval) + 1
        return max(following, min(available, self.sampled * parts))

    def _enough(self) -> int:
        """Return the largest number of samples at the next check, limited by the observation."""
        if not self.schedule.open_ended or self.observation is None:
            return self.sampled + MAX_SAMPLES_PER_CHECK
        until = max(self.observation.until, self.observe_until)
        return max(self.sampled, math.ceil(until / self.interval - 1e-9)) + 1

    def _goes_on(self) -> bool:
        """Apply the rules of an open-ended run; thin its samples if it goes on."""
        self.apply(self._decision())
        if self.ending is not Ending.RUNNING:
            return False
        if self.sampled >= 2 * self.schedule.samples:
            self.rows, self.sampled = [self.states[::2].copy()], -(-self.sampled // 2)
            self.interval *= 2.0
        return True

    def _decision(self) -> Decision:
        """Return whether the run has reached a state, or settled and been observed."""
        if self.schedule.until == "solved":
            last = self.rows[-1][-1] if len(self.rows[-1]) else self.states[-1]
            self.arrival = self.state_detector.arrival(
                self.detector.paces, self.time, last[:-RATES]
            )
            if self.arrival:
                return rules.at_a_state(self.arrival)
        settled = self.detector.settled()
        if settled is None:
            self.observation = None  # a motion that drifts away again had not settled
        elif self.observation is None:
            self.observation = rules.observation_of(settled, self.schedule)
        return rules.when_settled(self.time, self.observation, self.observe_until)

    def _tighten(self, rtol: float) -> None:
        """Continue with more exact steps, and begin to observe afresh."""
        self.schedule = replace(self.schedule, rtol=rtol)
        self.tight_from, self.observation, self.observe_until = self.time, None, 0.0
        self.ending = Ending.RUNNING
        self.marks.clear()  # their steps had another tolerance
        self._observe_afresh()

    def _pace(self) -> MotionRates:
        real = self.memory.real
        return MotionRates(
            time=float(real[names.TIME]),
            shape_speed=float(real[names.SHAPE_SPEED]),
            displacement=float(real[names.DISPLACEMENT]),
            turn_rate=float(real[names.TURN_RATE]),
        )

    def _nodes(self, rows: Array) -> Array:
        return self.model.nodes(self.model.positions(rows[:, :-RATES]))

    @property
    def earliest_mark(self) -> float:
        """Earliest time from which the run can be sampled again [T]."""
        return float(self.marks[0].real[names.TIME])

    def mark_before(self, time: float) -> StepperState:
        """Return the last mark at or before a time [T] between the earliest mark and the end."""
        earlier = (mark for mark in reversed(self.marks) if mark.real[names.TIME] <= time)
        last: StepperState = next(earlier)
        return last


def copied(memory: StepperState) -> StepperState:
    """Return a copy of a state of the integrator."""
    return StepperState(*(array.copy() for array in memory))
