"""Figures and movies of the report: pictures inside the page, movies as files next to it."""

import base64
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from undula.errors import InputError
from undula.reproduction.claims.catalogue import Figure, Item
from undula.reproduction.claims.evaluate import Answers, ClaimAnswer
from undula.reproduction.figures import by_name as reproduced
from undula.reproduction.report.claim_table import left_out
from undula.reproduction.tasks.task import Tasks, answers_of, run_captured
from undula.storage.outputs import renewing
from undula.storage.ramp_file import load_ramp
from undula.storage.run_file import load_result
from undula.sweeps.store import load_sweep
from undula.terminal.output import DONE
from undula.views.common.figure_file import figure_bytes

_MEDIA_TYPES = {".png": "image/png", ".svg": "image/svg+xml"}
#: Results that tasks store in addition to their answers, and their readers.
_STORED: Mapping[str, Callable[[Path], Any]] = {
    "run.nc": load_result,
    "steps.nc": load_ramp,
    "study.zarr": load_sweep,
}


@dataclass(frozen=True)
class PlacedFigure:
    """A figure or movie with its place in the page.

    Attributes
    ----------
    name, shows, caption
        As in the catalogue.
    source
        The picture as a data URI, or the name of a file next to the page; empty if it is left out.
    left_out
        Reason for leaving it out, else empty.
    """

    name: str
    shows: str
    caption: str
    source: str
    left_out: str = ""


def figures_of(name: str, item: Item, tasks: Tasks, *, quick: bool) -> list[PlacedFigure]:
    """Return the figures of an item; figures with missing tasks have the reason for it.

    Raises
    ------
    InputError
        The file of a figure is missing.
    """
    answers = answers_of(item, name, tasks)
    shown = []
    for figure in item.figures:
        reason = left_out(sorted(figure.asks), answers, quick=quick)
        if reason:
            shown.append(PlacedFigure(figure.name, figure.shows, figure.caption, "", reason))
            continue
        suffix, content = _content(figure, answers, tasks)
        source = f"data:{_MEDIA_TYPES[suffix]};base64,{base64.b64encode(content).decode()}"
        shown.append(PlacedFigure(figure.name, figure.shows, figure.caption, source))
    return shown


def movies_of(out: Path, name: str, item: Item, tasks: Tasks, *, quick: bool) -> list[PlacedFigure]:
    """Copy the movies of an item next to the page; movies with missing tasks have the reason.

    Raises
    ------
    InputError
        The file of a movie is missing, or the copy cannot be written.
    """
    answers = answers_of(item, name, tasks)
    shown = []
    for movie in item.movies:
        place = out / "movies" / f"{name}-{next(iter(movie.asks))}.mp4"
        reason = left_out(sorted(movie.asks), answers, quick=quick)
        if reason:
            shown.append(PlacedFigure(place.stem, movie.shows, movie.caption, "", reason))
            continue
        renewing(place).write(place, _bytes(_path(movie.file, answers)))
        relative = place.relative_to(out).as_posix()
        shown.append(PlacedFigure(place.stem, movie.shows, movie.caption, relative))
    return shown


def write_vectors(folder: Path, name: str, item: Item, tasks: Tasks, run_command: str) -> None:
    """Write the figures of an item as PDF, or as SVG where a command has drawn an SVG file.

    Parameters
    ----------
    folder
        Folder of the files.
    name, item
        The item.
    tasks
        All tasks.
    run_command
        Import path, as for `run_captured`.

    Raises
    ------
    InputError
        A file cannot be written, or the data of a figure are missing.
    """
    answers = answers_of(item, name, tasks)
    for figure in _ready(item, answers):
        path = folder / f"{name}-{figure.name}.pdf"
        if figure.view is not None:
            drawn = _drawn(figure, answers, tasks)
            renewing(path).write(path, figure_bytes(drawn, ".pdf"))
            continue
        source = _path(figure.file or "", answers)
        if source.suffix == ".svg":
            path = path.with_suffix(".svg")
            renewing(path).write(path, _bytes(source))
            continue
        renewing(path).check_writable(path)
        outcome = run_captured(run_command, _drawing_again(source, path, tasks))
        if outcome["status"] != DONE:
            raise InputError(f"{path} cannot be drawn: {outcome['said']}")


def _ready(item: Item, answers: Answers) -> Iterator[Figure]:
    return (figure for figure in item.figures if figure.asks <= answers.keys())


def _drawing_again(source: Path, path: Path, tasks: Tasks) -> tuple[str, ...]:
    """Return the command that draws a figure of a run or a sweep again, into another file."""
    if source.name == "run.png":
        return ("plot", str(source.with_name("run.nc")), "--out", str(path), "--overwrite")
    task = next(task for task in tasks.values() if task.folder == source.parent)
    return tuple(str(path) if word == str(source) else word for word in task.command)


def _content(figure: Figure, answers: Answers, tasks: Tasks) -> tuple[str, bytes]:
    """Return the ending and the content of a figure's file."""
    if figure.view is not None:
        return ".svg", figure_bytes(_drawn(figure, answers, tasks), ".svg")
    path = _path(figure.file or "", answers)
    return path.suffix, _bytes(path)


def _bytes(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise InputError(f"{path} is gone; run the same command with --fresh") from error


def _drawn(figure: Figure, answers: Answers, tasks: Tasks) -> Any:
    """Draw the view of a figure from the outcomes of its tasks."""
    view = reproduced.VIEWS[figure.view or ""]
    return view(*(_outcome(answers[name], tasks) for name in figure.of))


def _outcome(answer: ClaimAnswer, tasks: Tasks) -> Any:
    """Return the dataset that a task has stored; its plain JSON answer without a dataset."""
    for name, load in _STORED.items():
        if answer.folder is not None and (answer.folder / name).exists():
            return load(answer.folder / name)
    records = (task.stored() for task in tasks.values() if task.folder == answer.folder)
    return next(record["answer"] for record in records if record is not None)


def _path(template: str, answers: Answers) -> Path:
    return Path(template.format_map({name: answer.folder for name, answer in answers.items()}))
