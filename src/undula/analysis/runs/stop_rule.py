"""Rules for the end of a run, each a pure function from the state of the run to a decision.

| rule | question | decisions |
| --- | --- | --- |
| `at_the_end` | Which ending has a run whose time has passed? | `Stop` |
| `at_a_state` | Has it reached a stable state that was solved for? | `Continue`, `Stop` |
| `when_settled` | Has it settled, and been observed for long enough? | `Continue`, `Stop` |
| `when_observed` | Does the observation suffice to classify the motion? | all four |
| `when_irregular` | Is it a motion that never repeats itself? | `Continue`, `Tighten`, `Stop` |
| `when_cut_short` | Has the user, or the budget, ended it? | `Continue`, `Stop` |

`Simulation` applies the decisions; `undula.analysis.runs.integrate` calls the rules that need a
classification or the clock.
"""

import math
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from typing import Any, Self

import numpy as np

from undula.analysis.observables.trajectory import Motion
from undula.analysis.regimes.evidence import MIN_GROWTH_FACTOR
from undula.analysis.regimes.late_window import PLANAR_TOLERANCE
from undula.analysis.regimes.names import plane_change
from undula.analysis.regimes.recurrence import MAX_RECURRENCE_DISTANCE
from undula.analysis.regimes.trends import Halves, out_of_plane
from undula.analysis.run_settings import Ending, Schedule
from undula.analysis.runs.reached_state import ReachedState
from undula.analysis.runs.settled_motion import Settled
from undula.analysis.runs.settling import NOISE_IN_RTOL
from undula.arrays import Array

#: Number of beats or turns for which a settled motion is observed, and the same for one whose
#: remaining changes are as small as integration errors. A motion that relaxes slowly, such as a
#: beat towards its plane, is misclassified in a shorter window (docs/notes/points.md).
OBSERVED_CYCLES, OBSERVED_CYCLES_AT_NOISE = 12, 6
#: Beats in a trial window, from which planar flapping alone is accepted, and number of trials.
TRIAL_CYCLES, TRIAL_WINDOWS = 3, 6
#: A bent shape at rest is observed up to this multiple of the time that it took to come to rest.
REST_OBSERVED = 1.25
#: The only verdict accepted from a trial window.
TRIAL_VERDICT = "planar flapping"
#: Largest relative tolerance for the other verdicts of a run until "solved": the errors of larger
#: steps may sustain a motion.
TIGHT_RTOL = 1e-6


@dataclass(frozen=True)
class Continue:
    """Decision to continue unchanged."""


@dataclass(frozen=True)
class Observation:
    """A settled motion and the length of its observation.

    Attributes
    ----------
    settled : Settled
        The motion, with the start of the observation `since`.
    cycles : int
        Number of beats or turns to observe.
    trial_windows : int
        Number of short trial windows left, in which planar flapping is the only accepted verdict.
    """

    settled: Settled
    cycles: int = OBSERVED_CYCLES
    trial_windows: int = 0

    @property
    def until(self) -> float:
        """Time until which the motion is observed, to measure its frequencies [T]."""
        if self.settled.kind == "still":
            return REST_OBSERVED * self.settled.since
        # Up to reflection a beat recurs after half its period.
        cycle = 2.0 * self.settled.period if self.settled.period else self.settled.turn
        return self.settled.since + self.cycles * (cycle or 0.0)

    def from_at_most(self, time: float) -> Self:
        """Return the observation with a start at a time [T] at the latest."""
        settled = replace(self.settled, since=min(self.settled.since, time))
        return replace(self, settled=settled)

    def as_dict(self) -> dict[str, Any]:
        """Return the observation in plain JSON types."""
        observed = {"cycles": self.cycles, "brief": self.trial_windows}
        return asdict(self.settled) | observed


@dataclass(frozen=True)
class Observe:
    """Decision to continue and observe the settled motion for longer.

    Attributes
    ----------
    observation : Observation
        The next observation.
    until : float
        Earliest end of the observation [T].
    """

    observation: Observation
    until: float = 0.0


@dataclass(frozen=True)
class Tighten:
    """Decision to continue with another relative tolerance, and observe afresh.

    Attributes
    ----------
    rtol : float
        Relative error tolerance of a step.
    """

    rtol: float


@dataclass(frozen=True)
class Stop:
    """Decision to end the run.

    Attributes
    ----------
    ending : Ending
    """

    ending: Ending


Decision = Continue | Observe | Tighten | Stop


def observation_of(settled: Settled, schedule: Schedule) -> Observation:
    """Return the first observation of a motion that has just settled."""
    if settled.kind != "periodic":
        return Observation(settled)
    if schedule.until == "solved":
        return Observation(settled, TRIAL_CYCLES, TRIAL_WINDOWS)
    at_noise = settled.remaining <= NOISE_IN_RTOL * schedule.rtol
    return Observation(settled, OBSERVED_CYCLES_AT_NOISE if at_noise else OBSERVED_CYCLES)


def at_the_end(schedule: Schedule, observation: Observation | None) -> Stop:
    """Stop a run whose time has passed."""
    if not schedule.open_ended:
        return Stop(Ending.DONE)
    return Stop(Ending.SETTLED if observation else Ending.LIMIT)


def at_a_state(reached: ReachedState | None) -> Continue | Stop:
    """Stop a run that has reached a stable state."""
    return Stop(Ending.SOLVED) if reached else Continue()


def when_settled(time: float, observation: Observation | None, until: float) -> Continue | Stop:
    """Stop a run that has settled and been observed.

    Parameters
    ----------
    time
        Time of the last sample [T].
    observation
        Observation of the settled motion; None before.
    until
        Earliest end of the observation [T].
    """
    if observation is not None and time >= max(observation.until, until):
        return Stop(Ending.SETTLED)
    return Continue()


def when_observed(
    schedule: Schedule,
    time: float,
    observation: Observation,
    window: Motion,
    classify: Callable[[], tuple[str, float | None]],
) -> Decision:
    """Stop a run that shows enough to be classified, or continue for the time that it lacks.

    Parameters
    ----------
    schedule
        Schedule of the run.
    time
        Time of the last sample [T].
    observation
        The finished observation.
    window
        The motion since it settled.
    classify
        Returns the name of the verdict and the time that the run lacks [T] or None; called only if
        needed.
    """
    # A motion that leaves its plane is undecided, which takes far less time to detect.
    if observation.trial_windows and (plane_change(window.nodes) or classify()[0] != TRIAL_VERDICT):
        if observation.trial_windows == 1 and schedule.rtol > TIGHT_RTOL:
            return Tighten(TIGHT_RTOL)
        return Observe(_next_window(observation, window))
    longer = classify()[1]
    if longer and time < schedule.end:
        return Observe(observation, time + longer)
    return Stop(Ending.SETTLED)


def when_irregular(
    schedule: Schedule, observation: Observation | None, returned: Array
) -> Continue | Tighten | Stop:
    """Stop a run whose shape does not recur; Lyapunov exponents decide if it is continued.

    Parameters
    ----------
    schedule, observation
        Of the run.
    returned
        Distances of the newest shape from those at earlier maxima, relative to the displacement,
        shape ``(k,)``.
    """
    if not schedule.open_ended or observation is not None:
        return Continue()
    if returned.min(initial=np.inf) <= MAX_RECURRENCE_DISTANCE:
        return Continue()  # it recurs nearly, and settles slowly
    if schedule.until == "solved" and schedule.rtol > TIGHT_RTOL:
        return Tighten(TIGHT_RTOL)
    return Stop(Ending.IRREGULAR)


def when_cut_short(seconds: float, budget: float, *, interrupted: bool) -> Continue | Stop:
    """Stop a run that the user has interrupted or that has exceeded its budget.

    Parameters
    ----------
    seconds, budget
        Elapsed and largest time [s].
    interrupted
        True after an interruption by the user.
    """
    if interrupted:
        return Stop(Ending.INTERRUPTED)
    return Stop(Ending.OUT_OF_TIME) if seconds > budget else Continue()


def _next_window(observation: Observation, window: Motion) -> Observation:
    """Return the next window of a motion that the last one did not classify."""
    if observation.trial_windows == 1:
        return replace(observation, cycles=OBSERVED_CYCLES, trial_windows=0)
    settled = observation.settled
    # The next window begins with the second half of this one, or where the motion is planar.
    half = 0.5 * (float(window.time[-1]) - settled.since)
    since = settled.since + half * (1.0 + _halves_until_flat(out_of_plane(window.nodes)))
    return replace(
        observation,
        settled=replace(settled, since=since),
        trial_windows=observation.trial_windows - 1,
    )


def _halves_until_flat(share: Halves) -> float:
    """Return the number of half windows until a motion is planar; 0 if it does not flatten."""
    if not share.first > MIN_GROWTH_FACTOR * share.last > MIN_GROWTH_FACTOR * PLANAR_TOLERANCE:
        return 0.0
    return math.log(share.last / PLANAR_TOLERANCE) / math.log(share.first / share.last)
