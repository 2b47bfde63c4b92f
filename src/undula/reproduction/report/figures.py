"""Figures and movies of the report: pictures inside of the page, files beside it."""

import base64
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from undula.errors import InputError
from undula.reproduction.claims.catalogue import Figure, Item
from undula.reproduction.claims.evaluate import Answer
from undula.reproduction.figures import by_name as reproduced
from undula.reproduction.report.claim_table import left_out
from undula.reproduction.tasks.task import Job, answers_of, carry_out
from undula.storage.outputs import renewing
from undula.storage.ramp_file import load_ramp
from undula.storage.run_file import load_result
from undula.sweeps.store import load_sweep
from undula.terminal.output import DONE
from undula.views.common.figure_file import figure_bytes

_KINDS = {".png": "image/png", ".svg": "image/svg+xml"}
#: What tasks store besides their answers, and who reads it.
_STORED: Mapping[str, Callable[[Path], Any]] = {
    "run.nc": load_result,
    "steps.nc": load_ramp,
    "study.zarr": load_sweep,
}


@dataclass(frozen=True)
class Shown:
    """A figure or movie with its place in the page.

    Attributes
    ----------
    name, shows, caption
        As in the catalogue.
    source
        The picture itself as a data URI, or the name of a file beside the page; empty if it is left
        out.
    left_out
        Why it is left out, if it is.
    """

    name: str
    shows: str
    caption: str
    source: str
    left_out: str = ""


def figures_of(name: str, item: Item, jobs: Mapping[str, Job], *, quick: bool) -> list[Shown]:
    """Return the figures of an item, those whose tasks are not done with the reason.

    Raises
    ------
    InputError
        The file of a figure is gone.
    """
    answers = answers_of(item, name, jobs)
    shown = []
    for figure in item.figures:
        why = left_out(sorted(figure.asks), answers, quick=quick)
        if why:
            shown.append(Shown(figure.name, figure.shows, figure.caption, "", why))
            continue
        suffix, content = _content(figure, answers, jobs)
        source = f"data:{_KINDS[suffix]};base64,{base64.b64encode(content).decode()}"
        shown.append(Shown(figure.name, figure.shows, figure.caption, source))
    return shown


def movies_of(
    out: Path, name: str, item: Item, jobs: Mapping[str, Job], *, quick: bool
) -> list[Shown]:
    """Copy the movies of an item beside the page; return them, or why they are not there.

    Raises
    ------
    InputError
        The file of a movie is gone, or it cannot be written.
    """
    answers = answers_of(item, name, jobs)
    shown = []
    for movie in item.movies:
        place = out / "movies" / f"{name}-{next(iter(movie.asks))}.mp4"
        why = left_out(sorted(movie.asks), answers, quick=quick)
        if why:
            shown.append(Shown(place.stem, movie.shows, movie.caption, "", why))
            continue
        renewing(place).write(place, _bytes(_path(movie.file, answers)))
        relative = place.relative_to(out).as_posix()
        shown.append(Shown(place.stem, movie.shows, movie.caption, relative))
    return shown


def write_vectors(
    folder: Path, name: str, item: Item, jobs: Mapping[str, Job], run_command: str
) -> None:
    """Write the figures of an item as PDF, or as SVG where a command has drawn that.

    The import path `run_command` is that of `carry_out`.

    Raises
    ------
    InputError
        A file cannot be written, or what a figure is drawn from is gone.
    """
    answers = answers_of(item, name, jobs)
    for figure in _ready(item, answers):
        path = folder / f"{name}-{figure.name}.pdf"
        if figure.view is not None:
            drawn = _drawn(figure, answers, jobs)
            renewing(path).write(path, figure_bytes(drawn, ".pdf"))
            continue
        source = _path(figure.file or "", answers)
        if source.suffix == ".svg":
            path = path.with_suffix(".svg")
            renewing(path).write(path, _bytes(source))
            continue
        renewing(path).check(path)
        outcome = carry_out(run_command, _drawing_again(source, path, jobs))
        if outcome["status"] != DONE:
            raise InputError(f"{path} cannot be drawn: {outcome['said']}")


def _ready(item: Item, answers: Mapping[str, Answer]) -> Iterator[Figure]:
    return (figure for figure in item.figures if figure.asks <= answers.keys())


def _drawing_again(source: Path, path: Path, jobs: Mapping[str, Job]) -> tuple[str, ...]:
    """Return the command that draws a figure of a run or a study again, into another file."""
    if source.name == "run.png":
        return ("plot", str(source.with_name("run.nc")), "--out", str(path), "--overwrite")
    job = next(job for job in jobs.values() if job.folder == source.parent)
    return tuple(str(path) if word == str(source) else word for word in job.command)


def _content(
    figure: Figure, answers: Mapping[str, Answer], jobs: Mapping[str, Job]
) -> tuple[str, bytes]:
    """Return the ending and the content of a figure's file."""
    if figure.view is not None:
        return ".svg", figure_bytes(_drawn(figure, answers, jobs), ".svg")
    path = _path(figure.file or "", answers)
    return path.suffix, _bytes(path)


def _bytes(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise InputError(f"{path} is gone; run the same command with --fresh") from error


def _drawn(figure: Figure, answers: Mapping[str, Answer], jobs: Mapping[str, Job]) -> Any:
    """Draw the view of a figure from what its tasks came to."""
    view = reproduced.VIEWS[figure.view or ""]
    return view(*(_outcome(answers[name], jobs) for name in figure.of))


def _outcome(answer: Answer, jobs: Mapping[str, Job]) -> Any:
    """Return the dataset that a task stored or, where it stored none, its plain JSON answer."""
    for name, load in _STORED.items():
        if answer.folder is not None and (answer.folder / name).exists():
            return load(answer.folder / name)
    records = (job.kept() for job in jobs.values() if job.folder == answer.folder)
    return next(record["answer"] for record in records if record is not None)


def _path(template: str, answers: Mapping[str, Answer]) -> Path:
    return Path(template.format_map({name: answer.folder for name, answer in answers.items()}))
