"""Arguments and options shared by several commands."""

from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer

from undula.errors import InputError
from undula.inputs.file_names import any_name, file_name


def a_file(text: str) -> Path:
    """Parse a word of the command line that names a file; the parser of all such words.

    Raises
    ------
    typer.BadParameter
        No file can have this name.
    """
    return _parsed(file_name, text)


def a_path(text: str) -> Path:
    """Parse a word of the command line that names a file or folder; errors as for `a_file`."""
    return _parsed(any_name, text)


def _parsed(read: Callable[[str], Path], text: str) -> Path:
    try:
        return read(text)
    except InputError as error:
        raise typer.BadParameter(str(error)) from None


Result = Annotated[
    Path,
    typer.Argument(metavar="RESULT.nc", parser=a_file, help="A file that undula run wrote."),
]
Input = Annotated[
    Path | None,
    typer.Argument(metavar="[FILE.toml]", parser=a_file, help="Input; without it, the defaults."),
]
Folder = Annotated[
    Path | None,
    typer.Option(
        "--out", metavar="DIR", parser=a_path, help="Folder of the results.", show_default=False
    ),
]
Changes = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Change a key, as in load.force=80."),
]
Json = Annotated[bool, typer.Option("--json", help="Answer with exactly one JSON object.")]
Csv = Annotated[bool, typer.Option("--csv", help="Answer with a table of comma-separated values.")]
Plot = Annotated[
    Path | None, typer.Option(metavar="FILE", parser=a_file, help="Figure: .png, .pdf or .svg.")
]
Converge = Annotated[
    bool, typer.Option("--converge", help="Extrapolate to many links, with the error.")
]
Derivatives = Annotated[
    bool,
    typer.Option("--sensitivities", help="Add the derivatives by every parameter of the model."),
]
WithLyapunov = Annotated[
    bool,
    typer.Option("--lyapunov", help="Compute Lyapunov exponents, of a regular motion as well."),
]
NoMovie = Annotated[bool, typer.Option("--no-movie", help="Make no movie.")]
Overwrite = Annotated[bool, typer.Option("--overwrite", help="Replace what exists.")]
Budget = Annotated[
    float | None,
    typer.Option(metavar="SECONDS", help="Stop after so long, with what there is (exit status 3)."),
]
FollowedKinds = Annotated[
    list[str],
    typer.Argument(
        metavar="KIND... [FILE.toml]",
        help="straight, spinning, flapping, equilibrium or periodic, one or several.",
    ),
]
Along = Annotated[
    str,
    typer.Option(
        metavar="KEY=START:END",
        help="The way, as load.force=38:300 or load.force=onset:300; KEY=RANGE for values on it.",
    ),
]
RunsToDraw = Annotated[
    list[Path] | None,
    typer.Option(
        "--run", metavar="RESULT.nc", parser=a_file, help="A stored run to draw as a dot."
    ),
]
ThresholdName = Annotated[
    str,
    typer.Argument(metavar="NAME", help="onset, spinning-lost, flapping-gained or flapping-lost."),
]
LinearMethod = Annotated[
    str | None,
    typer.Option(help="spectral, modes or discrete; short for --set stability.method=."),
]
SecondParameter = Annotated[
    str | None,
    typer.Option(
        metavar="KEY=RANGE", help="Along a parameter, as model.drag_ratio=1:3:9 or 1,2,3."
    ),
]
EndOfSearch = Annotated[
    float | None,
    typer.Option(
        "--up-to",
        metavar="FORCE",
        help="Where the search ends; without it, at 20 times the force of the onset.",
    ),
]


def end_of_search(up_to: float | None) -> float | None:
    """Return the force at which a search ends; None for the default.

    Raises
    ------
    InputError
        The force is not a positive number.
    """
    # This form of the condition also refuses NaN.
    if up_to is not None and not 0.0 < up_to < float("inf"):
        raise InputError(f"--up-to {up_to} is out of range; give a finite force above 0")
    return up_to


def seconds_of(budget: float | None) -> float:
    """Return the wall time of a command [s], infinite for None.

    Raises
    ------
    InputError
        The budget is not above 0.
    """
    if budget is None:
        return float("inf")
    # This form of the condition also refuses NaN.
    if not budget > 0.0:
        raise InputError(f"--budget {budget} is out of range; give a number of seconds above 0")
    return budget
