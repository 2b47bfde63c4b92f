"""Files of figures and movies."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from undula.analysis.linear.curves import GrowthCurve
from undula.analysis.linear.straight_branch import StraightBranch
from undula.analysis.solvers.threshold_record import Threshold
from undula.analysis.states.branch import Branch
from undula.errors import InputError
from undula.models.scales import Scales
from undula.storage.outputs import Claim
from undula.terminal.meter import meter
from undula.views import (
    bifurcation_diagram,
    growth_figure,
    movie,
    portrait,
    threshold_curves,
)
from undula.views.common.figure_file import figure_bytes

#: Endings of figure files.
FORMATS = (".png", ".pdf", ".svg")


def beside(path: Path, ending: str, addition: str = "") -> Path:
    """Return a name in the same folder as a file or folder, with another ending.

    Parameters
    ----------
    path
        The file or folder.
    ending
        The new ending.
    addition
        Text before the ending.

    Raises
    ------
    InputError
        The path is the root of the file system.
    """
    named = path if path.name not in ("", "..") else path.resolve()
    if not named.name:
        raise InputError(f"there is nothing beside {path}; give another --out")
    return named.with_name(f"{named.stem}{addition}{ending}")


def figure_path(result: Path, out: Path | None) -> Path:
    """Return the file of the figure of a result, by default next to it.

    Raises
    ------
    InputError
        The ending of `out` belongs to no format of figures.
    """
    path = out or beside(result, FORMATS[0])
    check_figure_name("--out", path)
    return path


def check_figure_name(option: str, path: Path) -> None:
    """Refuse a name whose ending belongs to no format of figures.

    Raises
    ------
    InputError
        The ending is wrong; the sentence names the option.
    """
    if path.suffix.lower() not in FORMATS:
        raise InputError(
            f"{option} {path} does not end like a figure; give a name that ends in .png, .pdf or"
            " .svg"
        )


def movie_path(result: Path, out: Path | None) -> Path:
    """Return the file of the movie of a result, by default next to it.

    Raises
    ------
    InputError
        `out` does not end in .mp4.
    """
    path = out or beside(result, ".mp4")
    if path.suffix.lower() != ".mp4":
        raise InputError(f"--out {path} does not end like a movie; give a name that ends in .mp4")
    return path


def draw_figure(stored: xr.Dataset, path: Path, claim: Claim) -> None:
    """Draw the portrait of a stored run into a file.

    Raises
    ------
    InputError
        The run has too few samples, or the file cannot be written.
    """
    save_figure(portrait(stored), path, claim)


def save_figure(figure: Any, path: Path, claim: Claim) -> None:
    """Write a matplotlib figure, whole or not at all.

    Raises
    ------
    InputError
        The claim does not allow to replace an existing file, or it cannot be written.
    """
    claim.write(path, figure_bytes(figure, path.suffix))


def check_straight(parameter: str) -> None:
    """Refuse to draw the straight state along anything but the force.

    Raises
    ------
    InputError
        The parameter is not the force.
    """
    if parameter != "load.force":
        raise InputError(
            "the straight state is drawn along load.force only; for thresholds along"
            f" {parameter} use undula stability --along"
        )


def draw_straight(
    branch: StraightBranch,
    path: Path,
    claim: Claim,
    *,
    title: str,
    units: Mapping[str, str],
    scales: Scales | None,
) -> None:
    """Draw growth rate and frequency of the straight state over the force into a file.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    growth = GrowthCurve(
        branch.values, branch.rates, branch.frequencies, np.zeros_like(branch.rates), "spectral"
    )
    save_figure(growth_figure(growth, title=title, units=units, scales=scales), path, claim)


def draw_branches(
    branches: Sequence[Branch[Any]],
    runs: Sequence[xr.Dataset],
    path: Path,
    claim: Claim,
    *,
    title: str,
    scales: Scales | None,
) -> None:
    """Draw branches of states, with stored runs as dots, into a file.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    figure = bifurcation_diagram(branches, title=title, runs=runs, scales=scales)
    save_figure(figure, path, claim)


def draw_thresholds(
    name: str,
    along: tuple[str, Sequence[float]],
    thresholds: Sequence[Threshold],
    path: Path,
    claim: Claim,
    *,
    title: str,
    units: Mapping[str, str],
    scales: Scales | None,
) -> None:
    """Draw a threshold along a parameter into a file.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    values = np.asarray(along[1], dtype=float)
    forces, errors = (
        np.array([getattr(threshold, field) for threshold in thresholds], dtype=float)
        for field in ("value", "error")
    )
    curves = [(name, values, forces, errors)]
    figure = threshold_curves(curves, parameter=along[0], title=title, units=units, scales=scales)
    save_figure(figure, path, claim)


def draw_movie(stored: xr.Dataset, path: Path, claim: Claim) -> None:
    """Make the movie of a stored run.

    Raises
    ------
    InputError
        The run has too few samples, the claim does not allow to replace an existing file, the file
        cannot be written, or the encoder fails.
    """
    claim.check_writable(path)
    try:
        with meter("drawing the movie") as show:
            movie(
                stored,
                path,
                progress=lambda done, total: show(done / total, f"image {done} of {total}"),
            )
    except OSError as error:
        raise InputError(
            f"cannot make the movie {path} ({error}); look at the space on the disk, or do"
            " without it (--no-movie)"
        ) from error
