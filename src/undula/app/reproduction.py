"""The command that computes the paper anew: reproduce."""

from pathlib import Path
from typing import Annotated

import typer

from undula.app.options import Budget, Json, a_path, seconds_of

#: Where the catalogue finds the function that runs its commands.
RUN_COMMAND = "undula.app.cli:main"


def reproduce(
    names: Annotated[
        list[str] | None,
        typer.Argument(metavar="[ITEM]...", help="Items of the catalogue; without any, all."),
    ] = None,
    listed: Annotated[bool, typer.Option("--list", help="Tell all items, and stop.")] = False,
    quick: Annotated[
        bool, typer.Option("--quick", help="Coarser grids, and without what takes long.")
    ] = False,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR", parser=a_path, help="Folder of the report.", show_default="report"
        ),
    ] = None,
    catalogue: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR", parser=a_path, help="Another catalogue of items.", show_default=False
        ),
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option(
            metavar="N", min=1, help="Processes on this machine.", show_default="one a processor"
        ),
    ] = None,
    fresh: Annotated[
        bool, typer.Option("--fresh", help="Compute again what is kept from before.")
    ] = False,
    vector: Annotated[
        bool, typer.Option("--vector", help="Write the figures as PDF files, too.")
    ] = False,
    budget: Budget = None,
    as_json: Json = False,
) -> int:
    """Compute the figures, tables and statements of the paper anew, and judge each statement.

    Writes index.html and claims.json into DIR, and the data of every command below DIR/data. What
    was computed before, by the same sources, is not computed again.
    """
    from undula.reproduction.claims.catalogue import CATALOGUE
    from undula.reproduction.reproduce import Asked, list_items
    from undula.reproduction.reproduce import reproduce as carry_out

    folder = catalogue or CATALOGUE
    if listed:
        return list_items(folder, as_json=as_json)
    seconds = seconds_of(budget)
    report = out or Path("report")
    asked = Asked(
        folder, tuple(names or ()), quick, report, workers, seconds, vector, fresh, RUN_COMMAND
    )
    return carry_out(asked, as_json=as_json)
