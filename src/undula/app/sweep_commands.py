"""The commands on sweeps of many runs: sweep and status."""

from pathlib import Path
from typing import Annotated

import typer

from undula.app.options import Budget, Changes, Csv, Json, a_file, a_path, seconds_of


def sweep(
    file: Annotated[
        Path,
        typer.Argument(metavar="STUDY.toml", parser=a_file, help="Input with a table [study]."),
    ],
    changes: Changes = None,
    workers: Annotated[
        int | None,
        typer.Option(
            metavar="N", help="Processes on this machine.", show_default="one a processor"
        ),
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(metavar="ADDRESS", help="A running Dask scheduler to use instead."),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="STORE", parser=a_path, help="Folder of the store.", show_default=False
        ),
    ] = None,
    retry_failed: Annotated[
        bool, typer.Option("--retry-failed", help="Do points that have failed again.")
    ] = False,
    budget: Budget = None,
    as_json: Json = False,
) -> int:
    """Run a model at every point of a study, and keep all results in one store.

    The store is a Zarr group, by default results/ and the name of the file. A study that was
    stopped goes on with the same command.
    """
    from undula.app.commands.sweep import SweepRequest, run_sweep

    request = SweepRequest(workers, scheduler, retry_failed, seconds_of(budget))
    return run_sweep(file, changes or (), out, request, as_json=as_json)


def status(
    store: Annotated[
        Path, typer.Argument(metavar="STORE", parser=a_path, help="What undula sweep made.")
    ],
    as_json: Json = False,
    as_csv: Csv = False,
) -> int:
    """Tell how far a study is, also while it goes on: points done, verdicts, failures.

    With --csv all points with their results.
    """
    from undula.app.commands.sweep import report_status
    from undula.terminal.output import answer_form

    return report_status(store, answer_form(as_json=as_json, as_csv=as_csv))
