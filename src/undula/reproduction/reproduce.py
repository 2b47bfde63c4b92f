"""`undula reproduce`: the catalogue computed as far as it is missing, judged, and reported."""

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
from undula.reproduction.tasks.folder import CLAIMS, refuse_foreign, report_claimed
from undula.reproduction.tasks.queue import TaskWork
from undula.reproduction.tasks.task import Job, answers_of, carry_out, jobs_of
from undula.storage.atomic import write_whole
from undula.sweeps.own_workers import workers_that_fit
from undula.sweeps.workers import LostError, pool
from undula.terminal.output import DONE, INTERRUPTED, STOPPED_EARLY, finite, notice, reply
from undula.terminal.progress import swept

#: The exit status if a claim has another verdict than the one that is known to hold.
DIFFERS = 1
_PATIENCE = 0.2


@dataclass(frozen=True)
class Asked:
    """What a call asks for.

    Attributes
    ----------
    catalogue
        Folder of the items.
    names
        Items; none stands for all.
    quick
        Whether coarser grids will do.
    out
        Folder of the report.
    workers
        Processes; by default one for each processor.
    budget
        Seconds after which to stop with what there is.
    vector
        Whether figures are kept as PDF files as well.
    fresh
        Whether tasks are done again that are done already.
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
    """Tell all items of a catalogue; return the exit status.

    Raises
    ------
    InputError
        There is no catalogue, or an item is wrong.
    """
    items = catalogue(folder)
    listed = [
        {"name": name, "title": item.title, "paper": item.paper, "claims": len(item.claims)}
        for name, item in items.items()
    ]
    width = max(map(len, items))
    text = "\n".join(
        f"{one['name']:<{width}}  {one['title']}" + (f" ({one['paper']})" if one["paper"] else "")
        for one in listed
    )
    reply({"status": "done", "items": listed}, text, as_json=as_json)
    return DONE


def reproduce(asked: Asked, *, as_json: bool) -> int:
    """Compute what is missing, judge the claims, write the report, and answer.

    Returns
    -------
    int
        The exit status: 0 if all claims came out as is known, 1 if not, 3 if some of the tasks are
        left or have failed, those done being kept.

    Raises
    ------
    InputError
        There is no such item, or the folder holds something else, belongs to another process now,
        cannot be written or is full.
    """
    workers_that_fit(asked.workers)
    items, paper = catalogue(asked.catalogue), paper_of(asked.catalogue)
    wanted = chosen(items, asked.names)
    with report_claimed(asked.out):
        jobs = jobs_of(items, asked.catalogue / "inputs", asked.out / "data", quick=asked.quick)
        left = [job for job in _needed(wanted, jobs) if asked.fresh or not job.is_done()]
        for job in left:
            refuse_foreign(job.folder)
        try:
            status = _carry_on(left, asked)
        except LostError as lost:
            status = lost.told
        rows = {
            name: _rows(name, item, jobs, asked, wanted=name in wanted)
            for name, item in items.items()
        }
        page = write_report(
            asked.out,
            paper,
            items,
            rows,
            jobs,
            wanted=wanted.keys(),
            quick=asked.quick,
            vector=asked.vector,
            run_command=asked.run_command,
        )
        _write_claims(asked, [row for name in items for row in rows[name]])
    told = [row for name in wanted for row in rows[name]]
    answer = {
        "status": status,
        "report": str(page),
        "claims_file": str(asked.out / CLAIMS),
        "verdicts": tally(told),
        "claims": told,
    }
    reply(answer, rows_text(told, page), as_json=as_json)
    if status != "done":
        notice(f"the reproduction was {status}; the same command goes on from there")
        return STOPPED_EARLY
    return DIFFERS if any(row["as_expected"] is False for row in told) else DONE


def _write_claims(asked: Asked, claims: list[dict[str, Any]]) -> None:
    content = json.dumps(finite({"quick": asked.quick, "claims": claims}), indent=1)
    write_whole(asked.out / CLAIMS, content.encode(), overwrite=True)


def _needed(wanted: Mapping[str, Item], jobs: Mapping[str, Job]) -> list[Job]:
    """Return the jobs of items, with those of others that they use."""
    places = [f"{name}/{task}" for name, item in wanted.items() for task in item.tasks]
    places += [place for item in wanted.values() for place in item.uses.values()]
    found = [jobs[place] for place in dict.fromkeys(places) if place in jobs]
    by_folder = {job.folder: job for job in jobs.values()}
    queue = list(found)
    while queue:
        for folder in queue.pop().needs:
            if by_folder[folder] not in found:
                found.append(by_folder[folder])
                queue.append(by_folder[folder])
    return found


def _rows(
    name: str, item: Item, jobs: Mapping[str, Job], asked: Asked, *, wanted: bool
) -> list[dict[str, Any]]:
    """Return the rows of an item's claims, without those that have not been asked for yet."""
    answers = answers_of(item, name, jobs)
    rows = [
        row_of(name, item, claim, answers, jobs, quick=asked.quick, wanted=wanted)
        for claim in item.claims
    ]
    return [row for row in rows if row is not None]


def _carry_on(left: list[Job], asked: Asked) -> str:
    """Do the jobs, as far as time and patience go; return how it ended."""
    if not left:
        return "done"
    end = time.monotonic() + asked.budget
    work = TaskWork(left)
    with interruptible() as interrupted:

        def stopped() -> bool:
            return interrupted() or time.monotonic() > end

        while not stopped() and (job := work.take(all_cores=True)) is not None:
            notice(job.told)
            outcome = carry_out(asked.run_command, _limited(job, asked.workers, end), quietly=False)
            if _was_stopped(outcome):
                return str(outcome["answer"].get("status", "interrupted"))
            work.take_back(job, outcome)
        with (
            pool(asked.workers, None, _say_nothing) as workers,
            swept("reproducing", work.total, work.left, "tasks") as tell,
        ):
            while work.left and not stopped():
                while workers.has_room and (job := work.take(all_cores=False)) is not None:
                    workers.give(job, carry_out, asked.run_command, job.command)
                for job, outcome in workers.come_back(_PATIENCE):
                    work.take_back(job, outcome)
                tell(work.left, work.failed)
        if work.left:
            return "interrupted" if interrupted() else "out of time"
    return "incomplete" if work.failed else "done"


def _limited(job: Job, workers: int | None, end: float) -> tuple[str, ...]:
    """Return the command of a job that uses all cores, with the workers and time that it has."""
    if job.command[0] != "sweep":
        return job.command
    limits = [] if workers is None else ["--workers", str(workers)]
    if end < float("inf"):
        limits += ["--budget", str(max(end - time.monotonic(), 1e-3))]
    return (*job.command, *limits)


def _was_stopped(outcome: dict[str, Any]) -> bool:
    """Tell whether a command was left before its end, which the same command goes on from."""
    early = outcome["status"] in (STOPPED_EARLY, INTERRUPTED)
    return early and outcome["answer"].get("status", "interrupted") != "done"


def _say_nothing(sentence: str) -> None:
    """Keep the dashboard's address to ourselves: there is one for each study as well."""
