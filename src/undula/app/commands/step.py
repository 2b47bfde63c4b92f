"""`undula step`: a quasi-static ramp computed or continued, stored at intervals and drawn."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from undula.analysis.parameters import FORCE
from undula.analysis.ramps.ramp import Ramp, Step, ramp_steps
from undula.analysis.run_settings import Ending
from undula.analysis.solvers.threshold_record import Threshold
from undula.analysis.solvers.thresholds import THRESHOLDS, single_threshold
from undula.app.commands.drawing import beside, save_figure
from undula.app.commands.step_text import step_answer, step_text
from undula.app.tables import ramp_table
from undula.errors import InputError
from undula.inputs.build import build_model, build_schedule, build_start
from undula.inputs.input import RunInput
from undula.inputs.ramp_values import parse_ramp
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
from undula.terminal.output import DONE, STOPPED_EARLY, Form, notice, reply
from undula.terminal.physical import with_physical
from undula.terminal.progress import searching, stepped
from undula.views import ramp_diagram

#: Least time between two writings of the steps so far [s].
SAVE_EVERY = 2.0
#: Largest fraction of the time spent on writing, since long ramps have large files.
SAVING_SHARE = 0.1


class _OutOfTimeError(Exception):
    """The budget was spent during a search."""


@dataclass(frozen=True)
class RampJob:
    """A ramp with its input, files and options.

    Attributes
    ----------
    wanted
        The checked input.
    series
        The ramp.
    result
        File of the steps.
    reads
        Files that the input is read from.
    overwrite
        If true, an existing file is replaced instead of continued.
    with_thresholds
        If true, thresholds of the force are solved for.
    remark
        A sentence on the values, for standard error.
    """

    wanted: RunInput
    series: Series
    result: Path
    reads: Sequence[Path]
    overwrite: bool
    with_thresholds: bool
    remark: str | None = None


def plan(
    wanted: RunInput, along: str, *, back: bool, kick: float, seed: int
) -> tuple[Series, str | None]:
    """Return the ramp of an input, and a remark on the text of its values.

    Parameters
    ----------
    wanted
        The checked input.
    along
        ``KEY=START:STOP:COUNT``, a list, or ``KEY=START:STOP:STEP``.
    back
        If true, the ramp returns through the same values.
    kick
        Largest turn of a link before a step [rad].
    seed
        Seed of the random kicks.

    Raises
    ------
    InputError
        The parameter, one of its values or the kick is wrong.
    """
    parameter, values, remark = parse_ramp("--along", along)
    course = Ramp(parameter, values, back=back, kick=kick, seed=seed)
    model = build_model(wanted)
    course.models(model)
    load = wanted.describe({course.parameter})
    return Series(wanted.dump(), load, model, course, wanted.scales), remark


def run_ramp(job: RampJob, form: Form, *, budget: float) -> int:
    """Compute the missing steps of a ramp, store and draw all steps, and answer.

    Parameters
    ----------
    job
        The ramp.
    form
        Form of the answer.
    budget
        Wall time after which the ramp is stopped [s].

    Returns
    -------
    int
        The exit status: 0 if all is done, 3 if some steps are missing and the others kept.

    Raises
    ------
    InputError
        The parameter has no thresholds, the folder cannot be written, or the file holds another
        ramp.
    """
    if job.with_thresholds and job.series.ramp.parameter != FORCE:
        raise InputError(
            f"--thresholds are values of {FORCE}; step along that, or leave them out for"
            f" {job.series.ramp.parameter}"
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
        if job.remark:
            notice(job.remark)
        steps = [] if job.overwrite or not job.result.exists() else _stored(job)
        with interruptible() as interrupted:
            status, thresholds = _compute(job, steps, budget, interrupted), None
        if status == "done" and job.with_thresholds:
            status, thresholds = _solve(job.series.model, end)
        drawn = _draw(job, figure, claim, steps, thresholds or ())
    answer = step_answer(job.series, steps, thresholds)
    answer |= {"status": status, "store": str(job.result) if steps else None, "figure": drawn}
    complete = _report_failures(job, status, steps) and drawn is not None
    answer = with_physical(answer, "step", job.wanted.scales)
    text = ramp_table(answer) if form is Form.CSV else step_text(job.series, answer)
    reply(answer, text, as_json=form is Form.JSON)
    return DONE if complete else STOPPED_EARLY


def _stored(job: RampJob) -> list[Step]:
    """Return the steps of an earlier call."""
    try:
        stored = load_ramp(job.result)
    except InputError as error:
        raise InputError(f"{error}, or start afresh with --overwrite") from error
    refuse_another_series(job.result, stored, job.series)
    return stored_steps(stored)


def _compute(
    job: RampJob, steps: list[Step], budget: float, interrupted: Callable[[], bool]
) -> str:
    """Append the missing steps within the budget; return the status of the answer."""
    series, targets, before = job.series, job.series.ramp.targets, len(steps)
    first = series.ramp.models(series.model)[0]
    start = first.straight() if steps else build_start(job.wanted, first)
    save = _Saver(job)
    ending = "done"
    try:
        with (
            stepped("stepping", series.ramp.parameter, before, len(targets)) as show,
            compilation_announced(notice),
        ):
            for step in ramp_steps(
                series.model,
                series.ramp,
                start,
                build_schedule(job.wanted),
                before=tuple(steps),
                budget=budget,
                progress=lambda run: show(len(steps), targets[len(steps)][0], run.time),
            ):
                steps.append(step)
                save(steps)
                if interrupted() and len(steps) < len(targets):
                    raise KeyboardInterrupt
    except KeyboardInterrupt:
        if not steps:
            raise
        ending = "interrupted"
    if len(steps) > before:
        write_ramp(job.result, series, steps)
    return "out of time" if ending == "done" and len(steps) < len(targets) else ending


class _Saver:
    """Stores the steps so far at intervals. A full disk does not end the ramp."""

    def __init__(self, job: RampJob) -> None:
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
    """Return the status of the search for thresholds, and the thresholds of a complete search."""
    thresholds = []
    try:
        with compilation_announced(notice):
            for name in THRESHOLDS:
                with searching(name) as show:
                    thresholds.append(single_threshold(model, name, progress=_until(end, show)))
    except KeyboardInterrupt:
        return "interrupted", None
    except _OutOfTimeError:
        return "out of time", None
    return "done", thresholds


def _until(end: float, show: Callable[[int, float], None]) -> Callable[[int, float], None]:
    """Return a progress function that ends the search when the time is over."""

    def progress(links: int, force: float) -> None:
        if time.monotonic() > end:
            raise _OutOfTimeError
        show(links, force)

    return progress


def _draw(
    job: RampJob, path: Path, claim: Claim, steps: Sequence[Step], thresholds: Sequence[Threshold]
) -> str | None:
    """Draw the steps; return the name of the figure, None without a figure."""
    if not steps:
        return None
    values = {
        threshold.kind: threshold.value for threshold in thresholds if threshold.value is not None
    }
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


def _report_failures(job: RampJob, status: str, steps: Sequence[Step]) -> bool:
    """Give notice of failed and missing steps, with the cure; return True without any."""
    failed = [step for step in steps if step.status == Ending.FAILED.value]
    if failed:
        notice(
            f"{len(failed)} of {len(steps)} steps failed, the first at {failed[0].value:.6g}"
            f" ({failed[0].cause}); each of the next began where the one before had come to"
        )
    total = len(job.series.ramp.targets)
    if status != "done":
        cause = "interrupted" if status == "interrupted" else "out of its budget of time"
        notice(
            f"the series was {cause} after {len(steps)} of {total} steps; the same command goes on"
            " from there"
        )
    return not failed and status == "done"
