"""`undula sweep` and `undula status`: a study done or gone on with, and how far it is."""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from undula.analysis.run_settings import Ending
from undula.app.commands.sweep_text import study_answer, study_text
from undula.errors import InputError
from undula.interrupts import interruptible
from undula.sweeps.own_workers import workers_that_fit
from undula.sweeps.point import line, point, points, software
from undula.sweeps.store import StudyStore, load_sweep, open_study
from undula.sweeps.sweep import Study, read_study
from undula.sweeps.work_queue import SAVE_EVERY, SweepWork
from undula.sweeps.workers import DiedError, LostError, Pool, pool
from undula.terminal.compile_notice import compilation_announced
from undula.terminal.output import DONE, STOPPED_EARLY, notice, reply
from undula.terminal.progress import swept

#: Seconds to wait for results before looking at the clock again.
_PATIENCE = 0.2
_WHY = {
    "interrupted": "interrupted",
    "out of time": "out of its budget of time",
    "scheduler lost": "left by its scheduler",
    "no workers": "left without workers",
}


@dataclass(frozen=True)
class Asked:
    """What a call asks for besides the study: where the workers are, and how long.

    Attributes
    ----------
    workers
        Number of processes on this machine; by default one for each processor.
    scheduler
        Address of a running Dask scheduler to be used instead.
    retry_failed
        Whether points that have failed are done again.
    budget
        Seconds after which the study is left with the points that it has.
    """

    workers: int | None = None
    scheduler: str | None = None
    retry_failed: bool = False
    budget: float = float("inf")

    def __post_init__(self) -> None:
        """Refuse what does not go together."""
        if self.workers is not None and self.scheduler is not None:
            raise InputError(
                f"--workers {self.workers} has no meaning with --scheduler, which has workers of"
                " its own; leave out one of them"
            )
        if self.workers is not None and self.workers < 1:
            raise InputError(f"--workers {self.workers} is out of range; give at least 1")


def sweep(
    file: Path, changes: Sequence[str], out: Path | None, asked: Asked, *, as_json: bool
) -> int:
    """Do the points of a study that are missing in its store, and answer.

    Parameters
    ----------
    file, changes
        The input with the study, and changes of single keys.
    out
        The store; by default results/ and the name of the input.
    asked
        Where and for how long.
    as_json
        Whether to answer in JSON.

    Returns
    -------
    int
        The exit status: 0 if all points are done, 3 if some are left or have failed, what there is
        being kept.

    Raises
    ------
    InputError
        The study is wrong, there is something else in the store's place, no scheduler answers, or
        the folder cannot be written or is full.
    """
    began = time.monotonic()
    if asked.scheduler is None:
        workers_that_fit(asked.workers)
    store = open_study(out or Path("results") / f"{file.stem}.zarr", read_study(file, changes))
    with store.alone():
        work = SweepWork(store, retry_failed=asked.retry_failed)
        status = _carry_on(work, store.study, asked, began) if work.left else "done"
    answer = study_answer(load_sweep(store.path, shapes=False))
    answer |= {"status": status, "seconds": time.monotonic() - began, "store": str(store.path)}
    _tell_of_trouble(answer, store)
    reply(answer, study_text(answer), as_json=as_json)
    return DONE if status == "done" and not work.failed else STOPPED_EARLY


def status(path: Path, *, as_json: bool) -> int:
    """Tell how far a study is; return the exit status.

    Raises
    ------
    InputError
        There is no such store.
    """
    answer = study_answer(load_sweep(path, shapes=False)) | {"store": str(path)}
    reply(answer, study_text(answer), as_json=as_json)
    return DONE


def _carry_on(work: SweepWork, study: Study, asked: Asked, began: float) -> str:
    """Do what is left, as far as time and patience go; return how it ended."""
    try:
        _compile(study)
        with (
            interruptible() as interrupted,
            pool(asked.workers, asked.scheduler, notice) as workers,
            swept("sweeping", work.total, work.left) as tell,
        ):
            try:
                while work.left:
                    if interrupted():
                        return "interrupted"
                    if time.monotonic() - began > asked.budget:
                        return "out of time"
                    _hand_out(work, study, workers)
                    _take_back(work, workers)
                    tell(work.left, work.failed)
            finally:
                work.save()
    except LostError as lost:
        return lost.status
    except KeyboardInterrupt:
        return "interrupted"
    return "done"


def _compile(study: Study) -> None:
    """Have the kernels compiled here, where it can be told, before many workers need them."""
    job = study.job(0)
    if job["label"] == "runs":
        job["tables"]["time"] |= {"until": 1e-6, "samples": 2}
        job["tables"]["time"].pop("limit", None)
        with compilation_announced(notice):
            made = point(job)
        if made.get("ending") == Ending.INTERRUPTED.value:
            raise KeyboardInterrupt


def _hand_out(work: SweepWork, study: Study, workers: Pool) -> None:
    each = line if study.whole_lines else points
    while workers.has_room and (piece := work.take()) is not None:
        workers.give(piece, each, study.dump(), piece.numbers)


def _take_back(work: SweepWork, workers: Pool) -> None:
    for piece, outcome in workers.come_back(_PATIENCE):
        if isinstance(outcome, DiedError):
            work.died(piece)
            continue
        at_work, records = outcome
        if at_work != software():
            raise InputError(
                f"a worker runs undula {at_work} instead of {software()}; install that version"
                " there"
            )
        work.take_back(piece, records)
    work.save(SAVE_EVERY)


def _tell_of_trouble(answer: dict[str, Any], store: StudyStore) -> None:
    """Say what went wrong, and what to do."""
    counts = answer["points"]
    if counts["failed"]:
        first = answer["failures"][0]
        notice(
            f"{counts['failed']} of {counts['all']} points have failed, the first because:"
            f" {first['reason']}; --retry-failed does them again"
        )
    if answer["status"] != "done":
        notice(
            f"the study was {_WHY[answer['status']]} with {counts['to_go']} of {counts['all']}"
            f" points to go; everything so far is in {store.path}, the same command goes on"
        )
