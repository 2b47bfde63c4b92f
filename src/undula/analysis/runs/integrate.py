"""Time integration of a model from a start to the end of a run."""

import time
from collections.abc import Callable
from dataclasses import replace
from typing import Literal

from undula.analysis.arguments import require_model
from undula.analysis.one_thread import on_one_thread
from undula.analysis.regimes.verdict import UNDECIDED
from undula.analysis.run_settings import Ending, Schedule
from undula.analysis.runs.classify_run import CutShortError, Exponents, Watch
from undula.analysis.runs.progress import Progress, displayed
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
from undula.log import logger
from undula.models.model import Model
from undula.numerics.integration import stepper_state as names

_LOG = logger(__name__)

#: Number of maxima of the energy after which an open-ended run is first tested for irregular
#: motion; it doubles with each test.
FIRST_TEST_MAXIMA = 240
#: Reasons for unfinished Lyapunov exponents.
CUT_SHORT_REASONS = ("they were interrupted", "they were out of their budget of time")
#: Endings of runs whose Lyapunov exponents are not computed.
CUT_SHORT_ENDINGS = (Ending.INTERRUPTED, Ending.OUT_OF_TIME, Ending.FAILED)


@on_one_thread
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
    progress: Callable[[Progress], None] | bool | None = None,
) -> Run:
    """Integrate a model in time.

    Parameters
    ----------
    model : Model
        For example a `Filament`.
    start : ndarray, shape (model.size,)
        The state at time 0, for example ``kicked(model)``.
    until : float, "settled" or "solved"
        Time at which the run ends [T], positive. "settled": the run ends when the motion repeats
        itself. "solved": it also ends next to a stable straight or spinning state.
    limit : float
        Latest end of a run until "settled" or "solved" [T], positive.
    samples : int
        Number of stored samples, from 2 to 10^9; up to twice as many for "settled" and "solved".
    rtol : float
        Relative error tolerance of a step, from 1e-12 to 1e-2: of the tangents, relative to their
        RMS inclination to the axis.
    atol : float
        Absolute error tolerance of a step [rad], above 0 and at most 1e-2.
    budget : float
        Largest elapsed time, with Lyapunov exponents [s]; the run then ends with what it has.
    lyapunov : bool
        True for Lyapunov exponents of every motion, not only of an irregular one.
    progress : callable or True, optional
        Called with a `Progress` every few milliseconds; True shows a bar, or lines in a notebook.

    Returns
    -------
    Run
        Also for a run that was interrupted (Ctrl-C), exceeded its budget, or failed, as its
        `ending` shows.

    Raises
    ------
    InputError
        An argument is out of its range or the start is no state of the model.

    Examples
    --------
    >>> import undula as un
    >>> model = un.Filament(4, load=un.TipLoad(0.0))
    >>> run = un.integrate(model, un.planar(model, 0.1), until=0.001, samples=3)
    >>> run.motion.nodes.shape
    (3, 5, 3)
    """
    require_model(model, "integrate")
    schedule = Schedule(until=until, limit=limit, samples=samples, rtol=rtol, atol=atol)
    simulation = Simulation.begin(model, start, schedule)
    begun = time.monotonic()
    with displayed(progress, settling=isinstance(until, str)) as show:
        run = carry_on(simulation, budget=budget, progress=show)
        if simulation.ending in CUT_SHORT_ENDINGS:
            return Run.of(simulation, Exponents.NEVER)
        if lyapunov:
            left = budget - (time.monotonic() - begun)
            return with_exponents(simulation, Exponents.ALWAYS, budget=left, progress=show)
        return run or Run.of(simulation)


def carry_on(
    simulation: Simulation,
    *,
    budget: float = float("inf"),
    progress: Callable[[Progress], None] | None = None,
) -> Run | None:
    """Advance a simulation to its end, to an interruption, or until its budget is exceeded.

    An open-ended run also ends when its motion is chaotic or quasi-periodic. A settled motion that
    is still undecided is observed for longer, up to the limit.

    Parameters
    ----------
    simulation : Simulation
        Run in progress.
    budget : float
        Largest elapsed time [s].
    progress : callable, optional
        Called with a `Progress` every few milliseconds.

    Returns
    -------
    Run or None
        The run, if its end needed a classification.
    """
    run = _carried_on(simulation, budget, progress)
    _LOG.info("run %s at t = %.6g", simulation.ending.value, simulation.time)
    return run


def _carried_on(
    simulation: Simulation, budget: float, progress: Callable[[Progress], None] | None
) -> Run | None:
    begun = time.monotonic()
    due = FIRST_TEST_MAXIMA
    while due <= simulation.detector.seen:
        due *= 2
    with interruptible() as interrupted:
        watch = _watch(simulation, begun, budget, interrupted, progress)
        while True:
            goes_on, seconds = simulation.advance(), time.monotonic() - begun
            if not goes_on:
                settled = simulation.ending is Ending.SETTLED
                run = _observed(simulation, watch) if settled else None
                if simulation.ending is not Ending.RUNNING:
                    return run
            simulation.apply(when_cut_short(seconds, budget, interrupted=interrupted()))
            if simulation.ending is not Ending.RUNNING:
                return None
            if progress is not None:
                progress(_progress(simulation, seconds))
            if simulation.detector.seen >= due:
                due *= 2
                run = _irregular(simulation, watch)
                if run is not None:
                    return run


def with_exponents(
    simulation: Simulation,
    exponents: Exponents,
    *,
    budget: float = float("inf"),
    progress: Callable[[Progress], None] | None = None,
) -> Run:
    """Classify a run with Lyapunov exponents.

    After an interruption or beyond the budget the run has none, and gives the reason
    (`Run.without_lyapunov`).

    Parameters
    ----------
    simulation : Simulation
        Run in progress.
    exponents : Exponents
        Condition for computing them.
    budget : float
        Largest elapsed time [s].
    progress : callable, optional
        Called with a `Progress` every few milliseconds.

    Returns
    -------
    Run
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
    """Return a callback that reports the progress of exponents, and ends them when due."""

    def watch(name: str, share: float) -> None:
        seconds = time.monotonic() - begun
        if interrupted():
            raise CutShortError(CUT_SHORT_REASONS[0])
        if seconds > budget:
            raise CutShortError(CUT_SHORT_REASONS[1])
        if progress is not None:
            progress(replace(_progress(simulation, seconds), exponents=(name, share)))

    return watch


def _observed(simulation: Simulation, watch: Watch) -> Run:
    """Return the result of a settled run; continue it if that does not suffice to classify it."""
    run, observation = Run.of(simulation), simulation.observation
    assert observation is not None  # as the run has settled

    def classify() -> tuple[str, float | None]:
        verdict = run.judged(watch).verdict
        return verdict.name, verdict.longer

    window = run.since(observation.settled.since)
    schedule, time_reached = simulation.schedule, simulation.time
    simulation.apply(when_observed(schedule, time_reached, observation, window, classify))
    return run


def _irregular(simulation: Simulation, watch: Watch) -> Run | None:
    """Return the result of an open-ended run whose motion is irregular, None if it continues."""
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
