"""A run from its first step to its stored result, kept safe on the way."""

import time
from dataclasses import dataclass, field

from undula.analysis.runs.classify_run import Exponents
from undula.analysis.runs.dataset import dataset_of
from undula.analysis.runs.integrate import (
    CUT_SHORT_ENDINGS,
    CUT_SHORT_REASONS,
    Progress,
    carry_on,
    with_exponents,
)
from undula.analysis.runs.run import Run
from undula.app.commands.run_job import Job
from undula.errors import InputError
from undula.interrupts import interruptible
from undula.storage.run_file import write_run
from undula.terminal.compile_notice import compilation_announced
from undula.terminal.meter import Meter, meter
from undula.terminal.output import notice
from undula.terminal.run_progress import far_too_long, pace, part_done

#: Seconds between two times that the result so far is written.
SAVE_EVERY = 20.0
#: Writing takes at most this part of the time: a long run has a large file.
SAVING_SHARE = 0.1


@dataclass(frozen=True)
class Computed:
    """Seconds that a run took, and why its Lyapunov exponents are missing if they were stopped."""

    seconds: float
    without: str


def compute(job: Job, budget: float, *, lyapunov: bool) -> Computed:
    """Carry a run on to its end, or until Ctrl-C or the budget stops it, and store its result.

    Parameters
    ----------
    job
        The run; its file is replaced, every now and then and at the end.
    budget
        Seconds after which the run is ended with what it has, or its exponents are.
    lyapunov
        Whether to compute Lyapunov exponents of any motion, not only of an irregular one.

    Raises
    ------
    InputError
        The result cannot be written.
    """
    begun, simulation = time.monotonic(), job.simulation
    # Also while the result is stored: a signal may come twice.
    with interruptible(), meter("running") as show, compilation_announced(notice):
        watcher = _Watcher(job, show)
        judged = carry_on(simulation, budget=budget, progress=watcher)
        judged = judged or Run.of(simulation, Exponents.NEVER)
        store(job, judged)  # exponents may take long, and something may end that
        wanted = lyapunov or (judged.lyapunov is None and judged.verdict.late is not None)
        run, stopped = judged, False
        if wanted and simulation.ending not in CUT_SHORT_ENDINGS:
            exponents = Exponents.ALWAYS if lyapunov else Exponents.IF_IRREGULAR
            left = budget - (time.monotonic() - begun)
            run = with_exponents(simulation, exponents, budget=left, progress=watcher)
            stopped = run.without_lyapunov in CUT_SHORT_REASONS
            store(job, run)
    return Computed(time.monotonic() - begun, run.without_lyapunov if stopped else "")


def store(job: Job, run: Run) -> None:
    """Write the result that a run has come to so far, whole."""
    dataset = dataset_of(run, inputs=job.wanted.dump(), load=job.wanted.load_text)
    write_run(job.result, dataset, run.checkpoint, overwrite=True)


@dataclass
class _Watcher:
    """Shows where a run is, says if it takes days, and stores it every now and then."""

    job: Job
    show: Meter
    first: Progress | None = None
    warned: bool = False
    next_save: float = field(default_factory=lambda: SAVE_EVERY)

    def __call__(self, progress: Progress) -> None:
        if progress.exponents is not None:
            what, part = progress.exponents
            self.show(part, f"{what}, {part:.0%} done")
            return
        self.first = self.first or progress
        settling = isinstance(self.job.wanted.time.until, str)
        self.show(part_done(progress), pace(progress, self.first, settling=settling))
        told = "" if self.warned else far_too_long(progress, self.first, settling=settling)
        if told:
            self.warned = True
            notice(told)
        if progress.seconds >= self.next_save:
            spent = self._save()
            self.next_save = progress.seconds + spent + max(SAVE_EVERY, spent / SAVING_SHARE)

    def _save(self) -> float:
        """Store the result so far; return the seconds it took. The run outlives a full disk."""
        begun = time.monotonic()
        try:
            store(self.job, Run.of(self.job.simulation, Exponents.NEVER))
        except InputError as error:
            notice(f"the result so far is not stored: {error}")
        return time.monotonic() - begun
