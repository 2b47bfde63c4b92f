"""The command that reproduces the paper: reproduce."""

from pathlib import Path
from typing import Annotated

import typer

from undula.app.options import Budget, Json, a_path, seconds_of

#: Import path of the function that runs the commands of the catalogue.
RUN_COMMAND = "undula.app.cli:main"


Items = Annotated[
    list[str] | None,
    typer.Argument(metavar="[ITEM]...", help="Items of the catalogue; without any, all."),
]
Listed = Annotated[bool, typer.Option("--list", help="Tell all items, and stop.")]
Quick = Annotated[bool, typer.Option("--quick", help="Coarser grids, and without what takes long.")]
ReportFolder = Annotated[
    Path | None,
    typer.Option(metavar="DIR", parser=a_path, help="Folder of the report.", show_default="report"),
]
CatalogueFolder = Annotated[
    Path | None,
    typer.Option(
        metavar="DIR", parser=a_path, help="Another catalogue of items.", show_default=False
    ),
]
Workers = Annotated[
    int | None,
    typer.Option(
        metavar="N", min=1, help="Processes on this machine.", show_default="one a processor"
    ),
]
Fresh = Annotated[bool, typer.Option("--fresh", help="Compute again what is kept from before.")]
Vector = Annotated[bool, typer.Option("--vector", help="Write the figures as PDF files, too.")]


def reproduce(
    names: Items = None,
    listed: Listed = False,
    quick: Quick = False,
    out: ReportFolder = None,
    catalogue: CatalogueFolder = None,
    workers: Workers = None,
    fresh: Fresh = False,
    vector: Vector = False,
    budget: Budget = None,
    as_json: Json = False,
) -> int:
    """Compute the figures, tables and statements of the paper anew, and judge each statement.

    Writes index.html and claims.json into DIR, and the data of every command below DIR/data. What
    was computed before, by the same sources, is not computed again.
    """
    from undula.reproduction.claims.catalogue import CATALOGUE
    from undula.reproduction.reproduce import ReproductionRequest, list_items
    from undula.reproduction.reproduce import reproduce as run_reproduction

    folder = catalogue or CATALOGUE
    if listed:
        return list_items(folder, as_json=as_json)
    seconds = seconds_of(budget)
    report = out or Path("report")
    request = ReproductionRequest(
        folder, tuple(names or ()), quick, report, workers, seconds, vector, fresh, RUN_COMMAND
    )
    return run_reproduction(request, as_json=as_json)
