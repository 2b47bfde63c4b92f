"""`undula sweep` and `undula status`: compute the missing points of a sweep, and report on it."""

import json
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from undula.app.commands.sweep_text import sweep_answer, sweep_text
from undula.app.tables import sweep_table
from undula.errors import InputError
from undula.inputs.units_table import scales_of
from undula.sweeps.compute import compute
from undula.sweeps.own_workers import workers_that_fit
from undula.sweeps.store import SweepStore, load_sweep, open_sweep
from undula.sweeps.sweep import Sweep, read_sweep
from undula.sweeps.work_queue import SweepWork
from undula.terminal.compile_notice import compilation_announced
from undula.terminal.output import DONE, STOPPED_EARLY, Form, notice, reply
from undula.terminal.progress import swept

#: Causes of an early end in words, by the status of the answer.
_CAUSES = {
    "interrupted": "interrupted",
    "out of time": "out of its budget of time",
    "scheduler lost": "left by its scheduler",
    "no workers": "left without workers",
}


@dataclass(frozen=True)
class SweepRequest:
    """Options of a call with a sweep.

    Attributes
    ----------
    workers
        Number of processes on this machine; None for one on each processor.
    scheduler
        Address of a running Dask scheduler whose workers are used instead; None without.
    retry_failed
        If true, failed points are computed again.
    budget
        Time after which the sweep is stopped with the points that it has [s].
    """

    workers: int | None = None
    scheduler: str | None = None
    retry_failed: bool = False
    budget: float = float("inf")

    def __post_init__(self) -> None:
        """Refuse options that exclude each other."""
        if self.workers is not None and self.scheduler is not None:
            raise InputError(
                f"--workers {self.workers} has no meaning with --scheduler, which has workers of"
                " its own; leave out one of them"
            )
        if self.workers is not None and self.workers < 1:
            raise InputError(f"--workers {self.workers} is out of range; give at least 1")


def run_sweep(
    file: Path, changes: Sequence[str], out: Path | None, request: SweepRequest, *, as_json: bool
) -> int:
    """Compute the points of a sweep that are missing in its store, and answer.

    Parameters
    ----------
    file, changes
        The input file of the sweep, and changes of single keys.
    out
        Folder of the store; None for results/ and the name of the input.
    request
        Workers and budget.
    as_json
        If true, the answer is JSON.

    Returns
    -------
    int
        The exit status: 0 if all points are done, 3 if some are missing or have failed. All results
        are kept.

    Raises
    ------
    InputError
        The input is wrong, the folder holds something else, no scheduler answers, or the folder
        cannot be written or is full.
    """
    began = time.monotonic()
    if request.scheduler is None:
        workers_that_fit(request.workers)
    store = open_sweep(out or Path("results") / f"{file.stem}.zarr", read_sweep(file, changes))
    with store.alone():
        work = SweepWork(store, retry_failed=request.retry_failed)
        status = _compute(work, store.sweep, request, began) if work.left else "done"
    answer = sweep_answer(load_sweep(store.path, shapes=False))
    answer |= {"status": status, "seconds": time.monotonic() - began, "store": str(store.path)}
    _report_failures(answer, store)
    reply(answer, sweep_text(answer, scales_of(store.sweep.shared)), as_json=as_json)
    return DONE if status == "done" and not work.failed else STOPPED_EARLY


def report_status(path: Path, form: Form) -> int:
    """Report the state of a stored sweep, or all its points; return the exit status.

    Raises
    ------
    InputError
        The folder is not a store.
    """
    stored = load_sweep(path, shapes=False)
    answer = sweep_answer(stored) | {"store": str(path)}
    scales = scales_of(json.loads(stored.attrs["study"]))
    text = sweep_table(stored) if form is Form.CSV else sweep_text(answer, scales)
    reply(answer, text, as_json=form is Form.JSON)
    return DONE


def _compute(work: SweepWork, sweep: Sweep, request: SweepRequest, began: float) -> str:
    """Compute the missing points within the budget; return the status of the answer."""
    return compute(
        work,
        sweep,
        workers=request.workers,
        scheduler=request.scheduler,
        deadline=began + request.budget,
        say=notice,
        compiling=lambda: compilation_announced(notice),
        progress=lambda: swept("sweeping", work.total, work.left),
    )


def _report_failures(answer: dict[str, Any], store: SweepStore) -> None:
    """Give notice of failed and missing points, with the cure."""
    counts = answer["points"]
    if counts["failed"]:
        first = answer["failures"][0]
        notice(
            f"{counts['failed']} of {counts['all']} points have failed, the first because:"
            f" {first['reason']}; --retry-failed does them again"
        )
    if answer["status"] != "done":
        notice(
            f"the study was {_CAUSES[answer['status']]} with {counts['to_go']} of {counts['all']}"
            f" points to go; everything so far is in {store.path}, the same command goes on"
        )
