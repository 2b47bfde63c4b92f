"""The commands that draw stored results: plot and movie."""

from pathlib import Path
from typing import Annotated

import typer

from undula.app.options import Json, Overwrite, Result, a_file, a_path
from undula.errors import InputError


def plot(
    result: Annotated[
        Path,
        typer.Argument(
            metavar="RESULT", parser=a_path, help="What undula run, step or sweep wrote."
        ),
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            parser=a_file,
            help="Figure: .png, .pdf or .svg; .html for a page of a study.",
            show_default=False,
        ),
    ] = None,
    view: Annotated[
        str, typer.Option(help="Of a study: diagram, gallery, paths or basins.")
    ] = "diagram",
    at: Annotated[
        list[str] | None,
        typer.Option("--at", metavar="KEY=VALUE", help="Of a study: at or near this value."),
    ] = None,
    boundaries: Annotated[
        bool, typer.Option("--borders", help="Of a study: solve for borders, and compare.")
    ] = False,
    overwrite: Overwrite = False,
    as_json: Json = False,
) -> int:
    """Draw a stored run, a ramp or a study of many runs, by default next to it as .png."""
    if result.is_dir():
        from undula.app.commands.plot_sweep import PlotRequest, plot_sweep

        request = PlotRequest(view, out, at or (), boundaries, overwrite)
        return plot_sweep(result, request, as_json=as_json)
    for option, given in (("--view", view != "diagram"), ("--at", at), ("--borders", boundaries)):
        if given:
            raise InputError(f"{option} is about studies, and {result} is none; leave it out")
    return _plot_file(result, out, overwrite=overwrite, as_json=as_json)


def _plot_file(result: Path, out: Path | None, *, overwrite: bool, as_json: bool) -> int:
    """Draw a stored run, a ramp or a record and answer; return the exit status."""
    from undula.app.commands.drawing import figure_path, save_figure
    from undula.app.stored_files import figure_of
    from undula.storage.outputs import claimed
    from undula.terminal.output import DONE, reply

    path, renewed = figure_path(result, out), out is None
    figure = figure_of(result)
    with claimed(path, renewed=[path] * renewed, overwrite=overwrite, reads=[result]) as claim:
        save_figure(figure, path, claim)
    reply({"status": "done", "figure": str(path)}, str(path), as_json=as_json)
    return DONE


def movie(
    result: Result,
    out: Annotated[
        Path | None,
        typer.Option(metavar="FILE", parser=a_file, help="Movie: .mp4.", show_default=False),
    ] = None,
    overwrite: Overwrite = False,
    as_json: Json = False,
) -> int:
    """Make the movie of a stored run, by default next to it as .mp4."""
    from undula.app.commands.drawing import draw_movie, movie_path
    from undula.app.stored_files import MOVIE, load_run_for
    from undula.storage.outputs import claimed
    from undula.terminal.output import DONE, reply

    path = movie_path(result, out)
    stored, renewed = load_run_for(result, MOVIE), [path] if out is None else []
    with claimed(path, renewed=renewed, overwrite=overwrite, reads=[result]) as claim:
        draw_movie(stored, path, claim)
    reply({"status": "done", "movie": str(path)}, str(path), as_json=as_json)
    return DONE
