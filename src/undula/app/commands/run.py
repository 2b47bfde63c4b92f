"""`undula run`: computation of a run, with its result stored at intervals."""

import time
from dataclasses import dataclass, field

from undula.analysis.runs.classify_run import Exponents
from undula.analysis.runs.dataset import dataset_of
from undula.analysis.runs.integrate import (
    CUT_SHORT_ENDINGS,
    CUT_SHORT_REASONS,
    carry_on,
    with_exponents,
)
from undula.analysis.runs.progress import Progress
from undula.analysis.runs.run import Run
from undula.app.commands.run_job import RunJob
from undula.errors import InputError
from undula.interrupts import interruptible
from undula.storage.physical_attributes import with_physical_attributes
from undula.storage.run_file import write_run
from undula.terminal.compile_notice import compilation_announced
from undula.terminal.meter import Meter, meter
from undula.terminal.output import notice
from undula.terminal.run_progress import far_too_long, pace, part_done

#: Time between two writings of the result so far [s].
SAVE_EVERY = 20.0
#: Largest fraction of the time spent on writing, since long runs have large files.
SAVING_SHARE = 0.1


@dataclass(frozen=True)
class Computed:
    """Outcome of the computation of a run.

    Attributes
    ----------
    seconds
        Wall time.
    without
        Cause of missing Lyapunov exponents if they were stopped, else empty.
    """

    seconds: float
    without: str


def compute(job: RunJob, budget: float, *, lyapunov: bool) -> Computed:
    """Compute a run to its end, or until Ctrl-C or the budget stops it, and store its result.

    Parameters
    ----------
    job
        The run; its file is replaced at intervals and at the end.
    budget
        Wall time after which the run or its exponents are stopped [s].
    lyapunov
        If true, compute Lyapunov exponents of any motion, not only of an irregular one.

    Raises
    ------
    InputError
        The result cannot be written.
    """
    begun, simulation = time.monotonic(), job.simulation
    # The context includes the storing of the result, since a signal may come twice.
    with interruptible(), meter("running") as show, compilation_announced(notice):
        watcher = _Watcher(job, show)
        judged = carry_on(simulation, budget=budget, progress=watcher)
        judged = judged or Run.of(simulation, Exponents.NEVER)
        store(job, judged)  # the exponents may take long and be interrupted
        needs_exponents = lyapunov or (judged.lyapunov is None and judged.verdict.late is not None)
        run, stopped = judged, False
        if needs_exponents and simulation.ending not in CUT_SHORT_ENDINGS:
            exponents = Exponents.ALWAYS if lyapunov else Exponents.IF_IRREGULAR
            left = budget - (time.monotonic() - begun)
            run = with_exponents(simulation, exponents, budget=left, progress=watcher)
            stopped = run.without_lyapunov in CUT_SHORT_REASONS
            store(job, run)
    return Computed(time.monotonic() - begun, run.without_lyapunov if stopped else "")


def store(job: RunJob, run: Run) -> None:
    """Write the result of a run so far, whole or not at all."""
    dataset = dataset_of(run, inputs=job.wanted.dump(), load=job.wanted.load_text)
    dataset = with_physical_attributes(dataset, job.wanted.scales, run.model.units.names())
    write_run(job.result, dataset, run.checkpoint, overwrite=True)


@dataclass
class _Watcher:
    """Shows the progress of a run, gives notice if it takes days, and stores it at intervals."""

    job: RunJob
    show: Meter
    first: Progress | None = None
    warned: bool = False
    next_save: float = field(default_factory=lambda: SAVE_EVERY)

    def __call__(self, progress: Progress) -> None:
        if progress.exponents is not None:
            name, part = progress.exponents
            self.show(part, f"{name}, {part:.0%} done")
            return
        self.first = self.first or progress
        settling = isinstance(self.job.wanted.time.until, str)
        self.show(part_done(progress), pace(progress, self.first, settling=settling))
        warning = "" if self.warned else far_too_long(progress, self.first, settling=settling)
        if warning:
            self.warned = True
            notice(warning)
        if progress.seconds >= self.next_save:
            spent = self._save()
            self.next_save = progress.seconds + spent + max(SAVE_EVERY, spent / SAVING_SHARE)

    def _save(self) -> float:
        """Store the result so far; return the wall time [s]. A full disk does not end the run."""
        begun = time.monotonic()
        try:
            store(self.job, Run.of(self.job.simulation, Exponents.NEVER))
        except InputError as error:
            notice(f"the result so far is not stored: {error}")
        return time.monotonic() - begun
