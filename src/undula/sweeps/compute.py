"""Computation of the missing points of a sweep through a pool of workers."""

import time
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext

from undula.analysis.run_settings import Ending
from undula.errors import InputError
from undula.interrupts import interruptible
from undula.sweeps.point import point_record, point_records, row_records, software
from undula.sweeps.sweep import Sweep
from undula.sweeps.work_queue import SAVE_EVERY, SweepWork
from undula.sweeps.workers import DiedError, LostError, Pool, pool

#: Time to wait for results before the clock is checked again [s].
_PATIENCE = 0.2
#: Called with the numbers of remaining and of failed points.
Progress = Callable[[int, int], None]


def compute(
    work: SweepWork,
    sweep: Sweep,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    deadline: float = float("inf"),
    say: Callable[[str], None] = lambda _: None,
    compiling: Callable[[], AbstractContextManager[object]] = nullcontext,
    progress: Callable[[], AbstractContextManager[Progress]] = lambda: nullcontext(_silent),
) -> str:
    """Compute the missing points of a sweep, and store them as they come.

    Parameters
    ----------
    work
        The missing points.
    sweep
        The sweep.
    workers
        Number of processes on this machine; None for one on each processor.
    scheduler
        Address of a running Dask scheduler whose workers are used instead; None without.
    deadline
        Time of `time.monotonic` at which the work ends [s].
    say
        Called with sentences on workers that come late or are lost.
    compiling
        Returns the context in which kernels are compiled.
    progress
        Returns a context that yields a function of the numbers of remaining and of failed points.

    Returns
    -------
    str
        "done", "interrupted", "out of time", "scheduler lost" or "no workers".

    Raises
    ------
    InputError
        No scheduler answers, or a worker has another version.
    """
    try:
        with compiling():
            _compile(sweep)
        with (
            interruptible() as interrupted,
            pool(workers, scheduler, say) as hands,
            progress() as show,
        ):
            try:
                while work.left:
                    if interrupted():
                        return "interrupted"
                    if time.monotonic() > deadline:
                        return "out of time"
                    _hand_out(work, sweep, hands)
                    _take_back(work, hands)
                    show(work.left, work.failed)
            finally:
                work.save()
    except LostError as lost:
        return lost.status
    except KeyboardInterrupt:
        return "interrupted"
    return "done"


def _silent(left: int, failed: int) -> None:
    """Show nothing."""


def _compile(sweep: Sweep) -> None:
    """Compile the kernels in this process before many workers need them."""
    request = sweep.request(0)
    if request["label"] == "runs":
        request["tables"]["time"] |= {"until": 1e-6, "samples": 2}
        request["tables"]["time"].pop("limit", None)
        record = point_record(request)
        if record.get("ending") == Ending.INTERRUPTED.value:
            raise KeyboardInterrupt


def _hand_out(work: SweepWork, sweep: Sweep, workers: Pool) -> None:
    records = row_records if sweep.whole_rows else point_records
    while workers.has_room and (task := work.take()) is not None:
        workers.give(task, records, sweep.dump(), task.numbers)


def _take_back(work: SweepWork, workers: Pool) -> None:
    for task, outcome in workers.come_back(_PATIENCE):
        if isinstance(outcome, DiedError):
            work.died(task)
            continue
        version, records = outcome
        if version != software():
            raise InputError(
                f"a worker runs undula {version} instead of {software()}; install that version"
                " there"
            )
        work.take_back(task, records)
    work.save(SAVE_EVERY)
