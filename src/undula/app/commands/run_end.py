"""End of `undula run` and `resume`: figure, movie, answer and exit status."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import xarray as xr

from undula.analysis.run_settings import Ending
from undula.app.commands.drawing import draw_figure, draw_movie, figure_path, movie_path
from undula.app.commands.run import compute
from undula.app.commands.run_job import RunJob
from undula.app.commands.run_text import run_text
from undula.errors import InputError
from undula.storage.outputs import Claim, discard
from undula.storage.run_file import load_result
from undula.terminal.output import DONE, STOPPED_EARLY, notice, reply
from undula.terminal.physical import with_physical

_VIEWS = (("figure", draw_figure), ("movie", draw_movie))
_ENDED_WELL = (Ending.DONE, Ending.SETTLED, Ending.SOLVED, Ending.IRREGULAR, Ending.LIMIT)


def views_of(result: Path, *, with_movie: bool = True) -> list[Path]:
    """Return the files of the figure of a result and of its movie, next to it."""
    return [figure_path(result, None), *([movie_path(result, None)] if with_movie else [])]


def finish(
    job: RunJob,
    claim: Claim,
    views: Sequence[Path],
    *,
    budget: float,
    lyapunov: bool,
    as_json: bool,
) -> int:
    """Compute a run to its end, draw it, and answer.

    Parameters
    ----------
    job
        The run.
    claim
        The claim on its file, figure and movie.
    views
        Files of figure and movie to be made; a run that is stopped early has no movie.
    budget
        Wall time after which the run is stopped [s].
    lyapunov
        If true, compute Lyapunov exponents of any motion, not only of an irregular one.
    as_json
        If true, the answer is JSON.

    Returns
    -------
    int
        The exit status: 0 if all is done, 3 if the run was stopped early and its result kept.
    """
    computed = compute(job, budget, lyapunov=lyapunov)
    for path in views_of(job.result):
        discard(path)  # figure and movie of the replaced result would mislead
    stopped = job.simulation.ending in (Ending.INTERRUPTED, Ending.OUT_OF_TIME)
    stored = load_result(job.result)
    made, complete = _draw(stored, job.result, claim, views[:1] if stopped else views)
    complete = complete and not computed.without
    answer = json.loads(stored.attrs["summary"]) | _seed(job)
    answer |= {"seconds": computed.seconds, "output": str(job.result)} | made
    _report_early_end(job, computed.without)
    scales = job.wanted.scales
    reply(with_physical(answer, "run", scales), run_text(answer, scales), as_json=as_json)
    return DONE if complete and job.simulation.ending in _ENDED_WELL else STOPPED_EARLY


def _seed(job: RunJob) -> dict[str, Any]:
    start = job.wanted.dump()["start"]
    return {"seed": start["seed"]} if "seed" in start else {}


def _draw(
    stored: xr.Dataset, result: Path, claim: Claim, views: Sequence[Path]
) -> tuple[dict[str, str | None], bool]:
    """Draw figure and movie; return their names by kind, and True if nothing failed."""
    made: dict[str, str | None] = {"figure": None, "movie": None}
    try:
        # Without a movie, `views` holds the figure alone.
        for (kind, draw), path in zip(_VIEWS, views, strict=False):
            draw(stored, path, claim)
            made[kind] = str(path)
    except InputError as error:
        notice(f"{error}; the result is stored in {result}")
        return made, False
    except KeyboardInterrupt:
        notice(f"stopped; the result is stored in {result}, undula plot and movie draw it")
        return made, False
    return made, True


def _report_early_end(job: RunJob, without: str) -> None:
    """Give notice of an early end of a run, with its cause and cure."""
    ending, time = job.simulation.ending, job.simulation.time
    if ending is Ending.FAILED:
        notice(
            f"the run failed at t = {time:.6g}: {job.simulation.cause}; everything up to there is"
            f" in {job.result}"
        )
    elif ending not in _ENDED_WELL:
        cause = "interrupted" if ending is Ending.INTERRUPTED else "out of its budget of time"
        notice(
            f"the run was {cause} at t = {time:.6g}; everything so far is in {job.result}, go on"
            f" with: undula resume {job.result}"
        )
    elif without:
        notice(
            f"no Lyapunov exponents: {without}; the run without them is in {job.result}, later"
            f" ones come with: undula resume {job.result} --lyapunov --until T"
        )
