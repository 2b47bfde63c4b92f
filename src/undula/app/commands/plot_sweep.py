"""`undula plot` of a stored sweep: diagram, gallery, paths or basins, and solved boundaries."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from undula.analysis.maps.basins import basins
from undula.analysis.maps.contradictions import Disagreement, contradictions
from undula.analysis.maps.stability_boundaries import BOUNDARIES, StabilityBoundaries
from undula.analysis.parameters import FORCE
from undula.app.commands.boundaries import boundaries_of
from undula.app.commands.drawing import FORMATS, beside, check_figure_name, save_figure
from undula.app.commands.plot_sweep_text import diagram_answer, diagram_text, scales_of_store
from undula.errors import InputError
from undula.inputs.ranges import parse_axis
from undula.schema.sweep_axes import REPLICATE, chosen, varied
from undula.storage.outputs import Claim, claimed
from undula.sweeps.store import load_sweep
from undula.terminal.output import DONE, STOPPED_EARLY, notice, reply
from undula.views import basin_diagram, gallery, mean_paths, phase_diagram, phase_page

#: Figures of a sweep.
VIEWS = ("diagram", "gallery", "paths", "basins")
_PAGE = ".html"
# Relative difference up to which a chosen value is a stored one, written with fewer digits.
_SAME = 1e-6


@dataclass(frozen=True)
class PlotRequest:
    """Options of a call with a sweep.

    Attributes
    ----------
    view
        One of `VIEWS`.
    out
        File of the figure or page; None for a figure next to the store.
    places
        Values of axes, each as ``KEY=VALUE``; the nearest stored value is drawn.
    boundaries
        If true, stability boundaries are solved for, drawn and compared with the runs.
    overwrite
        If true, an existing file is replaced.
    """

    view: str
    out: Path | None
    places: Sequence[str]
    boundaries: bool
    overwrite: bool


def plot_sweep(path: Path, request: PlotRequest, *, as_json: bool) -> int:
    """Draw a stored sweep and answer; return the exit status.

    Raises
    ------
    InputError
        The folder is not a store, an option is wrong, or a file cannot be written.
    """
    figure = _figure_path(path, request)
    store = _part(path, request, with_shapes=figure.suffix == _PAGE or request.view in VIEWS[1:3])
    renewed = [figure] if request.out is None else []
    with claimed(figure, renewed=renewed, overwrite=request.overwrite) as claim:
        boundaries = boundaries_of(path, store) if request.boundaries else None
        if request.boundaries and boundaries is None:
            reply({"status": "interrupted", "store": str(path)}, "", as_json=as_json)
            return STOPPED_EARLY
        contradicting = contradictions(store, boundaries) if boundaries else ()
        _draw(store, request.view, boundaries, contradicting, figure, claim)
    shares = basins(store) if store.sizes[REPLICATE] > 1 else None
    answer = diagram_answer(store, boundaries, contradicting, shares) | {"figure": str(figure)}
    if request.places:
        names = [_chosen_value(text)[0] for text in request.places]
        answer["at"] = {name: float(store[name].values[0]) for name in names}
    reply(answer, diagram_text(answer, scales_of_store(store)), as_json=as_json)
    return DONE


def _figure_path(path: Path, request: PlotRequest) -> Path:
    """Return the file of the figure: by default next to the store, under its name."""
    if request.view not in VIEWS:
        raise InputError(f"--view {request.view} is not known; take {', '.join(VIEWS)}")
    if request.out is None:
        return beside(path, FORMATS[0], "" if request.view == VIEWS[0] else f"-{request.view}")
    if request.out.suffix.lower() != _PAGE:
        check_figure_name("--out", request.out)
    elif request.view != VIEWS[0]:
        raise InputError(
            f"--out {request.out} is a page, which shows --view diagram; give a figure"
        )
    return request.out


def _part(path: Path, request: PlotRequest, *, with_shapes: bool) -> xr.Dataset:
    """Return the selected part of a sweep, in memory."""
    place = dict(_chosen_value(text) for text in request.places)
    store = chosen(load_sweep(path, shapes=with_shapes), place).load()
    for name, value in place.items():
        taken = float(store[name].values[0])
        if not math.isclose(taken, value, rel_tol=_SAME):
            notice(f"{path} has no {name} = {value:g}; {taken:g}, the nearest value, is drawn")
    if len(varied(store)) > 2:
        several = ", ".join(varied(store))
        raise InputError(
            f"{path} varies {several}; choose values of all but two of them, as in --at"
            f" {varied(store)[0]}={float(store[varied(store)[0]].values[0]):g}"
        )
    return store


def _chosen_value(text: str) -> tuple[str, float]:
    name, values = parse_axis("--at", text)
    if len(values) != 1:
        raise InputError(f"--at {text} has {len(values)} values; give one of the axis {name}")
    return name, values[0]


def _draw(
    store: xr.Dataset,
    view: str,
    boundaries: StabilityBoundaries | None,
    contradicting: Sequence[Disagreement],
    figure: Path,
    claim: Claim,
) -> None:
    lines = _lines(boundaries) if boundaries and FORCE in varied(store) else []
    notes = [(point.at, point.sentence) for point in contradicting if not point.near]
    if figure.suffix.lower() == _PAGE:
        page = phase_page(store, lines, contradicting=notes)
        claim.write(figure, page.encode())
        return
    if view == "gallery":
        drawn: Any = gallery(store)
    elif view == "paths":
        drawn = mean_paths(store, lines)
    elif view == "basins":
        drawn = basin_diagram(basins(store), lines, title=str(store.attrs.get("load", "")))
    else:
        drawn = phase_diagram(store, lines, contradicting=notes)
    save_figure(drawn, figure, claim)


def _lines(boundaries: StabilityBoundaries) -> list[tuple[str, Any, Any]]:
    """Return name, values and forces of the boundaries with at least one finite force."""
    values = np.array(boundaries.values)
    curves = [(name, values, boundaries.curve(name)[0]) for name in BOUNDARIES]
    return [curve for curve in curves if np.isfinite(curve[2]).any()]
