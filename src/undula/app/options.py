"""Arguments and options that several commands share."""

from pathlib import Path
from typing import Annotated

import typer

from undula.errors import InputError

Result = Annotated[Path, typer.Argument(metavar="RESULT.nc", help="A file that undula run wrote.")]
Input = Annotated[
    Path | None, typer.Argument(metavar="[FILE.toml]", help="Input; without it, the defaults.")
]
Changes = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Change a key, as in load.force=80."),
]
Json = Annotated[bool, typer.Option("--json", help="Answer with exactly one JSON object.")]
Plot = Annotated[Path | None, typer.Option(metavar="FILE", help="Figure: .png, .pdf or .svg.")]
Converge = Annotated[
    bool, typer.Option("--converge", help="Extrapolate to many links, with the error.")
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


def seconds_of(budget: float | None) -> float:
    """Return the seconds that a command may take.

    Raises
    ------
    InputError
        They are not above 0.
    """
    if budget is None:
        return float("inf")
    # Written so that NaN, too, is refused.
    if not budget > 0.0:
        raise InputError(f"--budget {budget} is out of range; give a number of seconds above 0")
    return budget
