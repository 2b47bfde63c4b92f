"""`undula reproduce`: compute the missing tasks, judge the claims and write the report."""

import json
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from undula.interrupts import interruptible
from undula.reproduction.claims.catalogue import Item, catalogue, chosen, paper_of
from undula.reproduction.report.claim_table import row_of, rows_text, tally
from undula.reproduction.report.page import write_report
from undula.reproduction.tasks.folder import CLAIMS, locked_report, refuse_foreign
from undula.reproduction.tasks.queue import ReproductionWork
from undula.reproduction.tasks.task import (
    ReproductionTask,
    Tasks,
    answers_of,
    run_captured,
    tasks_of,
)
from undula.storage.atomic import write_whole
from undula.sweeps.own_workers import workers_that_fit
from undula.sweeps.workers import LostError, pool
from undula.terminal.output import DONE, INTERRUPTED, STOPPED_EARLY, finite, notice, reply
from undula.terminal.progress import swept

#: Exit status if a claim has another verdict than the expected one.
DIFFERS = 1
#: Time to wait for results before the clock is checked again [s].
_PATIENCE = 0.2


@dataclass(frozen=True)
class ReproductionRequest:
    """Options of a reproduction.

    Attributes
    ----------
    catalogue
        Folder of the items.
    names
        Names of the items; empty for all.
    quick
        If true, coarser grids are used.
    out
        Folder of the report.
    workers
        Number of processes; None for one on each processor.
    budget
        Wall time after which the reproduction is stopped with the tasks that are done [s].
    vector
        If true, the figures are also written as PDF files.
    fresh
        If true, tasks that are done are computed again.
    run_command
        Import path of the function that runs a command of the catalogue.
    """

    catalogue: Path
    names: tuple[str, ...]
    quick: bool
    out: Path
    workers: int | None
    budget: float
    vector: bool
    fresh: bool
    run_command: str


def list_items(folder: Path, *, as_json: bool) -> int:
    """List all items of a catalogue; return the exit status.

    Parameters
    ----------
    folder
        Folder of the catalogue.
    as_json
        If true, the answer is JSON.

    Raises
    ------
    InputError
        The folder holds no catalogue, or an item is wrong.
    """
    items = catalogue(folder)
    listed = [
        {"name": name, "title": item.title, "paper": item.paper, "claims": len(item.claims)}
        for name, item in items.items()
    ]
    width = max(map(len, items))
    text = "\n".join(
        f"{entry['name']:<{width}}  {entry['title']}"
        + (f" ({entry['paper']})" if entry["paper"] else "")
        for entry in listed
    )
    reply({"status": "done", "items": listed}, text, as_json=as_json)
    return DONE


def reproduce(request: ReproductionRequest, *, as_json: bool) -> int:
    """Compute the missing tasks, judge the claims, write the report, and answer.

    Parameters
    ----------
    request
        The options.
    as_json
        If true, the answer is JSON.

    Returns
    -------
    int
        The exit status: 0 if all claims have the expected verdict, 1 if not, 3 if some tasks are
        missing or have failed and the others are kept.

    Raises
    ------
    InputError
        An item is unknown, or the folder holds something else, is locked by another process, cannot
        be written or is full.
    """
    workers_that_fit(request.workers)
    items, paper = catalogue(request.catalogue), paper_of(request.catalogue)
    wanted = chosen(items, request.names)
    with locked_report(request.out):
        tasks = tasks_of(
            items, request.catalogue / "inputs", request.out / "data", quick=request.quick
        )
        left = [task for task in _needed(wanted, tasks) if request.fresh or not task.is_done()]
        for task in left:
            refuse_foreign(task.folder)
        try:
            status = _compute(left, request)
        except LostError as lost:
            status = lost.text
        rows = {
            name: _rows(name, item, tasks, request, wanted=name in wanted)
            for name, item in items.items()
        }
        page = write_report(
            request.out,
            paper,
            items,
            rows,
            tasks,
            wanted=wanted.keys(),
            quick=request.quick,
            vector=request.vector,
            run_command=request.run_command,
        )
        _write_claims(request, [row for name in items for row in rows[name]])
    judged = [row for name in wanted for row in rows[name]]
    return _answer(request, judged, page, status, as_json=as_json)


def _answer(
    request: ReproductionRequest,
    judged: list[dict[str, Any]],
    page: Path,
    status: str,
    *,
    as_json: bool,
) -> int:
    """Answer with the rows of the wanted claims; return the exit status."""
    answer = {
        "status": status,
        "report": str(page),
        "claims_file": str(request.out / CLAIMS),
        "verdicts": tally(judged),
        "claims": judged,
    }
    reply(answer, rows_text(judged, page), as_json=as_json)
    if status != "done":
        notice(f"the reproduction was {status}; the same command goes on from there")
        return STOPPED_EARLY
    return DIFFERS if any(row["as_expected"] is False for row in judged) else DONE


def _write_claims(request: ReproductionRequest, claims: list[dict[str, Any]]) -> None:
    content = json.dumps(finite({"quick": request.quick, "claims": claims}), indent=1)
    write_whole(request.out / CLAIMS, content.encode(), overwrite=True)


def _needed(wanted: Mapping[str, Item], tasks: Tasks) -> list[ReproductionTask]:
    """Return the tasks of items, with those of other items that they use."""
    places = [f"{name}/{local}" for name, item in wanted.items() for local in item.tasks]
    places += [place for item in wanted.values() for place in item.uses.values()]
    needed = [tasks[place] for place in dict.fromkeys(places) if place in tasks]
    by_folder = {task.folder: task for task in tasks.values()}
    queue = list(needed)
    while queue:
        for folder in queue.pop().needs:
            if by_folder[folder] not in needed:
                needed.append(by_folder[folder])
                queue.append(by_folder[folder])
    return needed


def _rows(
    name: str,
    item: Item,
    tasks: Tasks,
    request: ReproductionRequest,
    *,
    wanted: bool,
) -> list[dict[str, Any]]:
    """Return the rows of an item's claims, without unwanted claims that were not computed."""
    answers = answers_of(item, name, tasks)
    rows = [
        row_of(name, item, claim, answers, tasks, quick=request.quick, wanted=wanted)
        for claim in item.claims
    ]
    return [row for row in rows if row is not None]


def _compute(left: list[ReproductionTask], request: ReproductionRequest) -> str:
    """Compute tasks within the budget; return the status of the answer."""
    if not left:
        return "done"
    end = time.monotonic() + request.budget
    work = ReproductionWork(left)
    with interruptible() as interrupted:

        def stopped() -> bool:
            return interrupted() or time.monotonic() > end

        while not stopped() and (task := work.take(all_cores=True)) is not None:
            notice(task.typed)
            command = _limited(task, request.workers, end)
            outcome = run_captured(request.run_command, command, quietly=False)
            if _was_stopped(outcome):
                return str(outcome["answer"].get("status", "interrupted"))
            work.take_back(task, outcome)
        with (
            pool(request.workers, None, _say_nothing) as workers,
            swept("reproducing", work.total, work.left, "tasks") as show,
        ):
            while work.left and not stopped():
                while workers.has_room and (task := work.take(all_cores=False)) is not None:
                    workers.give(task, run_captured, request.run_command, task.command)
                for task, outcome in workers.come_back(_PATIENCE):
                    work.take_back(task, outcome)
                show(work.left, work.failed)
        if work.left:
            return "interrupted" if interrupted() else "out of time"
    return "incomplete" if work.failed else "done"


def _limited(task: ReproductionTask, workers: int | None, end: float) -> tuple[str, ...]:
    """Return the command of a task on all cores, with its number of workers and its budget."""
    if task.command[0] != "sweep":
        return task.command
    limits = [] if workers is None else ["--workers", str(workers)]
    if end < float("inf"):
        limits += ["--budget", str(max(end - time.monotonic(), 1e-3))]
    return (*task.command, *limits)


def _was_stopped(outcome: dict[str, Any]) -> bool:
    """Return True for a command that was stopped early and can be continued."""
    early = outcome["status"] in (STOPPED_EARLY, INTERRUPTED)
    return early and outcome["answer"].get("status", "interrupted") != "done"


def _say_nothing(sentence: str) -> None:
    """Suppress the address of the dashboard, since each sweep has its own."""
