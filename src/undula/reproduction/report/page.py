"""The report: one page with every claim, figure and command, that opens without a network."""

import platform
from collections.abc import Collection, Mapping, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from undula.reproduction.claims.catalogue import Item, Paper, Verdict
from undula.reproduction.report.claim_table import number_text, tally
from undula.reproduction.report.figures import figures_of, movies_of, write_vectors
from undula.reproduction.report.interactive_pages import packed_library, packed_pages
from undula.reproduction.tasks.folder import PAGE
from undula.reproduction.tasks.task import Job, answers_of
from undula.storage.outputs import renewing

_VERDICTS: tuple[str, ...] = Verdict.__args__  # type: ignore[attr-defined]


def write_report(
    out: Path,
    paper: Paper,
    items: Mapping[str, Item],
    rows: Mapping[str, Sequence[Mapping[str, Any]]],
    jobs: Mapping[str, Job],
    *,
    wanted: Collection[str],
    quick: bool,
    vector: bool,
    run_command: str,
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
            "figures": figures_of(name, item, jobs, quick=quick),
            "movies": movies_of(out, name, item, jobs, quick=quick),
            "pages": packed_pages(item, answers_of(item, name, jobs)),
            "commands": _commands(name, item, jobs),
        }
        for name, item in items.items()
    ]
    if vector:
        for name, item in items.items():
            write_vectors(out / "figures", name, item, jobs, run_command)
    shown = [one for one in sections if one["name"] in wanted or _has_content(one)]
    claims = [row for name in items for row in rows[name]]
    environment = Environment(
        loader=PackageLoader("undula.reproduction.report", "."),
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
        verdicts={verdict: tally(claims).get(verdict, 0) for verdict in _VERDICTS}
        | {verdict: count for verdict, count in tally(claims).items() if verdict not in _VERDICTS},
        unexpected=[row for row in claims if row["as_expected"] is False],
        quick=quick,
        versions={name: version(name) for name in ("undula", "numpy", "scipy", "numba")},
        python=platform.python_version(),
    )
    path = out / PAGE
    # Names of files need not be Unicode.
    renewing(path).write(path, page.encode("utf-8", "replace"))
    return path


def _has_content(section: Mapping[str, Any]) -> bool:
    drawn = [one for one in (*section["figures"], *section["movies"]) if one.source]
    return bool(section["rows"] or drawn)


def _commands(name: str, item: Item, jobs: Mapping[str, Job]) -> list[tuple[str, float]]:
    """Return the commands of an item that are done, each with the seconds that it took."""
    done = []
    for task in item.tasks:
        job = jobs.get(f"{name}/{task}")
        record = job.kept() if job else None
        if job is not None and record is not None:
            done.append((job.told, float(record["seconds"])))
    return done
