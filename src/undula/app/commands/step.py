"""`undula step`: a series of steps begun or gone on with, kept safe on the way, drawn and told."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from undula.analysis.parameters import FORCE
from undula.analysis.ramps.ramp import Ramp, Step, ramp
from undula.analysis.run_settings import Ending
from undula.analysis.solvers.threshold_record import Threshold
from undula.analysis.solvers.thresholds import THRESHOLDS, threshold
from undula.app.commands.drawing import beside, save_figure
from undula.app.commands.step_text import step_answer, step_text
from undula.errors import InputError
from undula.inputs.build import build_model, build_schedule, build_start
from undula.inputs.input import RunInput
from undula.inputs.ranges import parse_steps
from undula.interrupts import interruptible
from undula.models.model import Model
from undula.storage.outputs import Claim, claimed
from undula.storage.ramp_file import (
    Series,
    dataset_of_steps,
    load_ramp,
    refuse_another_series,
    stored_steps,
    write_ramp,
)
from undula.terminal.compile_notice import compilation_announced
from undula.terminal.output import DONE, STOPPED_EARLY, notice, reply
from undula.terminal.progress import searching, stepped
from undula.views import ramp_diagram

#: Least seconds between two times that the steps so far are written.
SAVE_EVERY = 2.0
#: Writing takes at most this part of the time: a long series has a large file.
SAVING_SHARE = 0.1


class _OutOfTimeError(Exception):
    """The budget was spent amid a search."""


@dataclass(frozen=True)
class Job:
    """A series with its input, its place on disk, the files that it is read from, and options."""

    wanted: RunInput
    series: Series
    result: Path
    reads: Sequence[Path]
    overwrite: bool
    with_thresholds: bool


def plan(wanted: RunInput, along: str, *, back: bool, kick: float, seed: int) -> Series:
    """Return the series of an input and the options of a command line.

    Raises
    ------
    InputError
        The parameter, one of its values or the kick is wrong.
    """
    course = Ramp(*parse_steps("--along", along), back=back, kick=kick, seed=seed)
    model = build_model(wanted)
    course.models(model)
    return Series(wanted.dump(), wanted.tell({course.parameter}), model, course)


def step_along(job: Job, *, budget: float, as_json: bool) -> int:
    """Make the steps that are missing, store and draw all of them, and answer.

    Parameters
    ----------
    job
        What is asked.
    budget
        Seconds after which the series is ended with the steps that it has.
    as_json
        Whether to answer in JSON.

    Returns
    -------
    int
        The exit status: 0 if all was done, 3 if not, the steps being kept.

    Raises
    ------
    InputError
        The thresholds are not those of the parameter, the folder cannot be written, or there is a
        file in it with which this series cannot go on.
    """
    if job.with_thresholds and job.series.course.parameter != FORCE:
        raise InputError(
            f"--thresholds are values of {FORCE}; step along that, or leave them out for"
            f" {job.series.course.parameter}"
        )
    end = time.monotonic() + budget
    figure = beside(job.result, ".png")
    with claimed(
        job.result,
        figure,
        renewed=[figure],
        continued=[job.result],
        overwrite=job.overwrite,
        reads=job.reads,
    ) as claim:
        steps = [] if job.overwrite or not job.result.exists() else _taken_up(job)
        with interruptible() as interrupted:
            status, found = _carry_on(job, steps, budget, interrupted), None
        if status == "done" and job.with_thresholds:
            status, found = _solve(job.series.model, end)
        drawn = _draw(job, figure, claim, steps, found or ())
    answer = step_answer(job.series, steps, found)
    answer |= {"status": status, "store": str(job.result) if steps else None, "figure": drawn}
    fine = _tell_of_trouble(job, status, steps) and drawn is not None
    reply(answer, step_text(job.series, answer), as_json=as_json)
    return DONE if fine else STOPPED_EARLY


def _taken_up(job: Job) -> list[Step]:
    """Return the steps of an earlier call."""
    try:
        stored = load_ramp(job.result)
    except InputError as error:
        raise InputError(f"{error}, or start afresh with --overwrite") from error
    refuse_another_series(job.result, stored, job.series)
    return stored_steps(stored)


def _carry_on(job: Job, steps: list[Step], budget: float, interrupted: Callable[[], bool]) -> str:
    """Append the missing steps, as far as time and patience go; return how it ended."""
    series, targets, before = job.series, job.series.course.targets, len(steps)
    first = series.course.models(series.model)[0]
    start = first.straight() if steps else build_start(job.wanted, first)
    keep = _Keeper(job)
    ending = "done"
    try:
        with (
            stepped("stepping", series.course.parameter, before, len(targets)) as tell,
            compilation_announced(notice),
        ):
            for step in ramp(
                series.model,
                series.course,
                start,
                build_schedule(job.wanted),
                before=tuple(steps),
                budget=budget,
                progress=lambda run: tell(len(steps), targets[len(steps)][0], run.time),
            ):
                steps.append(step)
                keep(steps)
                if interrupted() and len(steps) < len(targets):
                    raise KeyboardInterrupt
    except KeyboardInterrupt:
        if not steps:
            raise
        ending = "interrupted"
    if len(steps) > before:
        write_ramp(job.result, series, steps)
    return "out of time" if ending == "done" and len(steps) < len(targets) else ending


class _Keeper:
    """Stores the steps so far every now and then. The series outlives a full disk."""

    def __init__(self, job: Job) -> None:
        self._job, self._due = job, 0.0

    def __call__(self, steps: Sequence[Step]) -> None:
        began = time.monotonic()
        if began < self._due:
            return
        try:
            write_ramp(self._job.result, self._job.series, steps)
        except InputError as error:
            notice(f"the steps so far are not stored: {error}")
        now = time.monotonic()
        self._due = now + max(SAVE_EVERY, (now - began) / SAVING_SHARE)


def _solve(model: Model, end: float) -> tuple[str, list[Threshold] | None]:
    """Return how the search for the solved thresholds ended, and them if it was not cut short."""
    found = []
    try:
        with compilation_announced(notice):
            for name in THRESHOLDS:
                with searching(name) as tell:
                    found.append(threshold(model, name, progress=_until(end, tell)))
    except KeyboardInterrupt:
        return "interrupted", None
    except _OutOfTimeError:
        return "out of time", None
    return "done", found


def _until(end: float, tell: Callable[[int, float], None]) -> Callable[[int, float], None]:
    def progress(links: int, force: float) -> None:
        if time.monotonic() > end:
            raise _OutOfTimeError
        tell(links, force)

    return progress


def _draw(
    job: Job, path: Path, claim: Claim, steps: Sequence[Step], found: Sequence[Threshold]
) -> str | None:
    """Draw the steps beside their file; return the name of the figure, None without one."""
    if not steps:
        return None
    values = {one.kind: one.value for one in found if one.value is not None}
    try:
        figure = ramp_diagram([dataset_of_steps(job.series, steps)], thresholds=[values])
        save_figure(figure, path, claim)
    except InputError as error:
        notice(f"{error}; the steps are stored in {job.result}")
        return None
    except KeyboardInterrupt:
        notice(f"stopped; the steps are stored in {job.result}, the same command draws them")
        return None
    return str(path)


def _tell_of_trouble(job: Job, status: str, steps: Sequence[Step]) -> bool:
    """Say what went wrong, and what to do; return whether nothing did."""
    failed = [step for step in steps if step.status == Ending.FAILED.value]
    if failed:
        notice(
            f"{len(failed)} of {len(steps)} steps failed, the first at {failed[0].value:.6g}"
            f" ({failed[0].cause}); each of the next began where the one before had come to"
        )
    total = len(job.series.course.targets)
    if status != "done":
        why = "interrupted" if status == "interrupted" else "out of its budget of time"
        notice(
            f"the series was {why} after {len(steps)} of {total} steps; the same command goes on"
            " from there"
        )
    return not failed and status == "done"
