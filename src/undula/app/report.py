"""The report: one page with every claim, figure and command, that opens without a network."""

import base64
import platform
import shutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from undula.app.catalogue_tasks import Job, answers_of
from undula.app.claim_rows import number_text, tally
from undula.app.drawing import figure_bytes
from undula.app.report_pages import packed_library, packed_pages
from undula.errors import InputError
from undula.studies.claims import Answer
from undula.studies.items import Figure, Item, Paper, Verdict
from undula.studies.steps_store import load_steps
from undula.studies.store import load_result
from undula.studies.study_store import load_study
from undula.studies.whole_file import write_whole
from undula.views import reproduced

_KINDS = {".png": "image/png", ".svg": "image/svg+xml"}
#: What tasks store besides their answers, and who reads it.
_STORED: Mapping[str, Callable[[Path], Any]] = {
    "run.nc": load_result,
    "steps.nc": load_steps,
    "study.zarr": load_study,
}
_VERDICTS: tuple[str, ...] = Verdict.__args__  # type: ignore[attr-defined]


@dataclass(frozen=True)
class Shown:
    """A figure or movie with its place in the page.

    Attributes
    ----------
    name, shows, caption
        As in the catalogue.
    source
        The picture itself as a data URI, or the name of a file beside the page.
    """

    name: str
    shows: str
    caption: str
    source: str


def write_report(
    out: Path,
    paper: Paper,
    items: Mapping[str, Item],
    rows: Mapping[str, Sequence[Mapping[str, Any]]],
    jobs: Mapping[str, Job],
    *,
    quick: bool,
    vector: bool,
) -> Path:
    """Write the page, with movies and, if wanted, vector figures beside it; return its name.

    Raises
    ------
    InputError
        A file cannot be written.
    """
    sections = [
        {
            "name": name,
            "item": item,
            "rows": rows[name],
            "figures": _figures(out, name, item, jobs, vector=vector),
            "movies": _movies(out, name, item, jobs),
            "pages": packed_pages(item, answers_of(item, name, jobs)),
            "commands": _commands(name, item, jobs),
        }
        for name, item in items.items()
    ]
    shown = [section for section in sections if _has_content(section)]
    claims = [row for name in items for row in rows[name]]
    environment = Environment(
        loader=PackageLoader("undula.app", "."),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["number"] = number_text
    page = environment.get_template("report.html.j2").render(
        paper=paper,
        sections=shown,
        library=packed_library() if any(section["pages"] for section in shown) else "",
        claims=claims,
        verdicts={verdict: tally(claims).get(verdict, 0) for verdict in _VERDICTS},
        unexpected=[row for row in claims if not row["as_expected"]],
        quick=quick,
        versions={name: version(name) for name in ("undula", "numpy", "scipy", "numba")},
        python=platform.python_version(),
    )
    path = out / "index.html"
    write_whole(path, page.encode(), overwrite=True)
    return path


def _has_content(section: Mapping[str, Any]) -> bool:
    return bool(section["rows"] or section["figures"] or section["movies"])


def _commands(name: str, item: Item, jobs: Mapping[str, Job]) -> list[tuple[str, float]]:
    """Return the commands of an item that are done, each with the seconds that it took."""
    done = []
    for task in item.tasks:
        job = jobs.get(f"{name}/{task}")
        record = job.kept() if job else None
        if job is not None and record is not None:
            done.append((job.told, float(record["seconds"])))
    return done


def _figures(
    out: Path, name: str, item: Item, jobs: Mapping[str, Job], *, vector: bool
) -> list[Shown]:
    answers = answers_of(item, name, jobs)
    shown = []
    for figure in item.figures:
        if not figure.asks <= answers.keys():
            continue
        suffix, content = _content(figure, answers, jobs)
        source = f"data:{_KINDS[suffix]};base64,{base64.b64encode(content).decode()}"
        shown.append(Shown(figure.name, figure.shows, figure.caption, source))
        if vector:
            path = out / "figures" / f"{name}-{figure.name}.pdf"
            _write_vector(path, figure, answers, jobs)
    return shown


def _content(
    figure: Figure, answers: Mapping[str, Answer], jobs: Mapping[str, Job]
) -> tuple[str, bytes]:
    """Return the ending and the content of a figure's file."""
    if figure.view is not None:
        return ".svg", figure_bytes(_drawn(figure, answers, jobs), ".svg")
    path = _path(figure.file or "", answers)
    try:
        return path.suffix, path.read_bytes()
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


def _write_vector(
    path: Path, figure: Figure, answers: Mapping[str, Answer], jobs: Mapping[str, Job]
) -> None:
    """Write a figure as PDF; one that is stored as pixels is kept as it is, beside it."""
    if figure.view is not None:
        drawn = _drawn(figure, answers, jobs)
        write_whole(path, figure_bytes(drawn, ".pdf"), overwrite=True)
        return
    source = _path(figure.file or "", answers)
    write_whole(path.with_suffix(source.suffix), source.read_bytes(), overwrite=True)


def _movies(out: Path, name: str, item: Item, jobs: Mapping[str, Job]) -> list[Shown]:
    """Copy the movies beside the page."""
    answers = answers_of(item, name, jobs)
    shown = []
    for movie in item.movies:
        if not movie.asks <= answers.keys():
            continue
        source = _path(movie.file, answers)
        place = out / "movies" / f"{name}-{next(iter(movie.asks))}.mp4"
        place.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(source, place)
        relative = place.relative_to(out).as_posix()
        shown.append(Shown(place.stem, movie.shows, movie.caption, relative))
    return shown


def _path(template: str, answers: Mapping[str, Any]) -> Path:
    return Path(template.format_map({name: answer.folder for name, answer in answers.items()}))
