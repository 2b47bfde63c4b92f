"""Run a model: the call behind `undula.integrate` and behind the command `undula run`."""

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

from undula.analysis.regimes.verdict import UNDECIDED
from undula.analysis.run_settings import Ending, Schedule
from undula.analysis.runs.classify_run import CutShortError, Exponents, Watch
from undula.analysis.runs.run import Run
from undula.analysis.runs.simulation import Simulation
from undula.analysis.runs.stop_rule import (
    Continue,
    Stop,
    when_cut_short,
    when_irregular,
    when_observed,
)
from undula.arrays import State
from undula.interrupts import interruptible
from undula.models.model import Model
from undula.numerics.integration import stepper_state as names

#: Maxima of the energy after which a run to the settled state is asked whether its motion is
#: irregular, and after twice as many again and again.
FIRST_ASKED = 240
#: Why there are no Lyapunov exponents although they were begun.
STOPPED = ("they were interrupted", "they were out of their budget of time")
#: Runs that ended so are not looked at any longer.
CUT_SHORT = (Ending.INTERRUPTED, Ending.OUT_OF_TIME, Ending.FAILED)


@dataclass(frozen=True)
class Progress:
    """Where a run is: time reached and its end at the latest [T], length of the step, seconds.

    While Lyapunov exponents are computed `exponents` says what of them, and the part that is done.
    """

    time: float
    end: float
    step: float
    steps: int
    seconds: float
    exponents: tuple[str, float] | None = None


def integrate(
    model: Model,
    start: State,
    *,
    until: float | Literal["settled", "solved"] = 1.0,
    limit: float = 10.0,
    samples: int = 4000,
    rtol: float = 1e-6,
    atol: float = 1e-10,
    budget: float = float("inf"),
    lyapunov: bool = False,
    progress: Callable[[Progress], None] | None = None,
) -> Run:
    """Integrate a model in time.

    Parameters
    ----------
    model : Model
        For example a `Filament`.
    start : ndarray, shape (model.size,)
        The state at time 0, for example ``kicked(model)``.
    until : float, "settled" or "solved"
        Time at which the run ends [T]; or until the motion repeats itself; or until then at the
        latest, but only until a stable straight or spinning state is found next to it.
    limit : float
        Time at which a run to the settled state gives up [T].
    samples : int
        Number of stored samples; a run to the settled state has up to twice as many.
    rtol, atol : float
        Error tolerance of a step: of the tangents, relative to their RMS inclination to the axis,
        and absolute [rad].
    budget : float
        Seconds after which the run is ended with what it has; Lyapunov exponents are a part of it.
    lyapunov : bool
        Whether to compute Lyapunov exponents of any motion, not only of an irregular one.
    progress : callable, optional
        Called with a `Progress` every few milliseconds.

    Returns
    -------
    Run
        Also when the run was interrupted (Ctrl-C), ran out of its budget, or failed: its `ending`
        says so.

    Raises
    ------
    InputError
        An argument is out of its range or the start is no state of the model.
    """
    schedule = Schedule(until=until, limit=limit, samples=samples, rtol=rtol, atol=atol)
    simulation = Simulation.begin(model, start, schedule)
    begun = time.monotonic()
    judged = carry_on(simulation, budget=budget, progress=progress)
    if simulation.ending in CUT_SHORT:
        return Run.of(simulation, Exponents.NEVER)
    if lyapunov:
        left = budget - (time.monotonic() - begun)
        return with_exponents(simulation, Exponents.ALWAYS, budget=left, progress=progress)
    return judged or Run.of(simulation)


def carry_on(
    simulation: Simulation,
    *,
    budget: float = float("inf"),
    progress: Callable[[Progress], None] | None = None,
) -> Run | None:
    """Advance a simulation to its end, or until Ctrl-C, or until the budget of seconds is spent.

    A run to the settled state also ends when its motion is seen to be chaotic or quasi-periodic. If
    it has settled but cannot be named yet, it goes on for as long as that takes, up to its limit.

    Returns
    -------
    Run or None
        The run, if its end took judging it.
    """
    begun = time.monotonic()
    due = FIRST_ASKED
    while due <= simulation.detector.seen:
        due *= 2
    with interruptible() as interrupted:
        watch = _watch(simulation, begun, budget, interrupted, progress)
        while True:
            goes_on, seconds = simulation.advance(), time.monotonic() - begun
            if not goes_on:
                settled = simulation.ending is Ending.SETTLED
                judged = _observed(simulation, watch) if settled else None
                if simulation.ending is not Ending.RUNNING:
                    return judged
            simulation.apply(when_cut_short(seconds, budget, interrupted=interrupted()))
            if simulation.ending is not Ending.RUNNING:
                return None
            if progress is not None:
                progress(_progress(simulation, seconds))
            if simulation.detector.seen >= due:
                due *= 2
                judged = _irregular(simulation, watch)
                if judged is not None:
                    return judged


def with_exponents(
    simulation: Simulation,
    exponents: Exponents,
    *,
    budget: float = float("inf"),
    progress: Callable[[Progress], None] | None = None,
) -> Run:
    """Judge a run by Lyapunov exponents, too, unless Ctrl-C or the budget of seconds ends them.

    Then the run has none, and tells why (`Run.without_lyapunov`).
    """
    with interruptible() as interrupted:
        watch = _watch(simulation, time.monotonic(), budget, interrupted, progress)
        return Run.of(simulation, exponents).judged(watch)


def _watch(
    simulation: Simulation,
    begun: float,
    budget: float,
    interrupted: Callable[[], bool],
    progress: Callable[[Progress], None] | None,
) -> Watch:
    """Return what shows how far exponents are, and ends them after Ctrl-C or the budget."""

    def watch(what: str, part: float) -> None:
        seconds = time.monotonic() - begun
        if interrupted():
            raise CutShortError(STOPPED[0])
        if seconds > budget:
            raise CutShortError(STOPPED[1])
        if progress is not None:
            progress(replace(_progress(simulation, seconds), exponents=(what, part)))

    return watch


def _observed(simulation: Simulation, watch: Watch) -> Run:
    """Return a run that has settled; have it go on if that does not suffice to classify it."""
    run, observation = Run.of(simulation), simulation.observation
    assert observation is not None  # which is what it has settled to

    def classify() -> tuple[str, float | None]:
        verdict = run.judged(watch).verdict
        return verdict.name, verdict.longer

    window = run.since(observation.settled.since)
    schedule, time_reached = simulation.schedule, simulation.time
    simulation.apply(when_observed(schedule, time_reached, observation, window, classify))
    return run


def _irregular(simulation: Simulation, watch: Watch) -> Run | None:
    """Return a run that waits for its motion to repeat itself if it is seen not to."""
    returned = simulation.detector.returned()
    decision = when_irregular(simulation.schedule, simulation.observation, returned)
    simulation.apply(decision)
    if not isinstance(decision, Stop):
        return None
    run = Run.of(simulation).judged(watch)
    if run.lyapunov is not None and run.verdict.name != UNDECIDED:
        return run
    simulation.apply(Continue())
    return None


def _progress(simulation: Simulation, seconds: float) -> Progress:
    memory = simulation.memory
    return Progress(
        time=simulation.time,
        end=simulation.schedule.end,
        step=float(memory.real[names.STEP]),
        steps=int(memory.count[names.STEPS]),
        seconds=seconds,
    )
