"""Page of the report with all claims, figures and commands, which needs no network."""

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
from undula.reproduction.tasks.task import Tasks, answers_of
from undula.storage.outputs import renewing

_VERDICTS: tuple[str, ...] = Verdict.__args__  # type: ignore[attr-defined]


def write_report(
    out: Path,
    paper: Paper,
    items: Mapping[str, Item],
    rows: Mapping[str, Sequence[Mapping[str, Any]]],
    tasks: Tasks,
    *,
    wanted: Collection[str],
    quick: bool,
    vector: bool,
    run_command: str,
) -> Path:
    """Write the page, its movies and optionally vector figures; return the name of the page.

    Parameters
    ----------
    out
        Folder of the report.
    paper
        The paper of the catalogue.
    items
        Items by name.
    rows
        Rows of claims by item.
    tasks
        All tasks.
    wanted
        Names of the items that the user has selected.
    quick
        True for the quick report.
    vector
        If true, write the figures as PDF files as well.
    run_command
        Import path, as for `run_captured`.

    Raises
    ------
    InputError
        A file cannot be written.
    """
    sections = [
        _section(out, name, item, tasks, quick=quick) | {"rows": rows[name]}
        for name, item in items.items()
    ]
    if vector:
        for name, item in items.items():
            write_vectors(out / "figures", name, item, tasks, run_command)
    shown = [section for section in sections if section["name"] in wanted or _has_content(section)]
    claims = [row for name in items for row in rows[name]]
    page = _rendered(
        paper=paper,
        sections=shown,
        library=packed_library() if any(section["pages"] for section in shown) else "",
        claims=claims,
        verdicts=dict.fromkeys(_VERDICTS, 0) | tally(claims),
        unexpected=[row for row in claims if row["as_expected"] is False],
        quick=quick,
    )
    path = out / PAGE
    # File names may contain bytes that are not Unicode.
    renewing(path).write(path, page.encode("utf-8", "replace"))
    return path


def _section(out: Path, name: str, item: Item, tasks: Tasks, *, quick: bool) -> dict[str, Any]:
    """Return the content of an item's section, without the rows of its claims."""
    return {
        "name": name,
        "item": item,
        "figures": figures_of(name, item, tasks, quick=quick),
        "movies": movies_of(out, name, item, tasks, quick=quick),
        "pages": packed_pages(item, answers_of(item, name, tasks)),
        "commands": _commands(name, item, tasks),
    }


def _rendered(**content: Any) -> str:
    """Return the page with a given content, and with the versions of software."""
    environment = Environment(
        loader=PackageLoader("undula.reproduction.report", "."),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["number"] = number_text
    return environment.get_template("report.html.j2").render(
        **content,
        versions={name: version(name) for name in ("undula", "numpy", "scipy", "numba")},
        python=platform.python_version(),
    )


def _has_content(section: Mapping[str, Any]) -> bool:
    drawn = [shown for shown in (*section["figures"], *section["movies"]) if shown.source]
    return bool(section["rows"] or drawn)


def _commands(name: str, item: Item, tasks: Tasks) -> list[tuple[str, float]]:
    """Return the finished commands of an item, each with its wall time [s]."""
    done = []
    for local in item.tasks:
        task = tasks.get(f"{name}/{local}")
        record = task.stored() if task else None
        if task is not None and record is not None:
            done.append((task.typed, float(record["seconds"])))
    return done
