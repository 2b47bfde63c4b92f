"""`undula plot` of a stored study: diagram, gallery, paths or basins, and the solved borders."""

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
from undula.app.commands.boundaries import borders_of
from undula.app.commands.drawing import FORMATS, beside, check_figure_name, save_figure
from undula.app.commands.plot_sweep_text import diagram_answer, diagram_text
from undula.errors import InputError
from undula.inputs.ranges import parse_axis
from undula.schema.sweep_axes import TRY, chosen, varied
from undula.storage.outputs import Claim, claimed
from undula.sweeps.store import load_sweep
from undula.terminal.output import DONE, STOPPED_EARLY, reply
from undula.views import basin_diagram, gallery, mean_paths, phase_diagram, phase_page

#: What of a study can be drawn.
VIEWS = ("diagram", "gallery", "paths", "basins")
_PAGE = ".html"


@dataclass(frozen=True)
class Asked:
    """What is to be drawn of a study, where to, and what is solved for besides."""

    view: str
    out: Path | None
    at: Sequence[str]
    borders: bool
    overwrite: bool


def plot_study(path: Path, asked: Asked, *, as_json: bool) -> int:
    """Draw a stored study and answer.

    Raises
    ------
    InputError
        There is no such study, an option is wrong, or a file cannot be written.
    """
    figure = _figure_path(path, asked)
    store = _part(path, asked, with_shapes=figure.suffix == _PAGE or asked.view in VIEWS[1:3])
    renewed = [figure] if asked.out is None else []
    with claimed(figure, renewed=renewed, overwrite=asked.overwrite) as claim:
        found = borders_of(path, store) if asked.borders else None
        if asked.borders and found is None:
            reply({"status": "interrupted", "store": str(path)}, "", as_json=as_json)
            return STOPPED_EARLY
        wrong = contradictions(store, found) if found else ()
        _draw(store, asked.view, found, wrong, figure, claim)
    shares = basins(store) if store.sizes[TRY] > 1 else None
    answer = diagram_answer(store, found, wrong, shares) | {"figure": str(figure)}
    reply(answer, diagram_text(answer), as_json=as_json)
    return DONE


def _figure_path(path: Path, asked: Asked) -> Path:
    """Return where the figure goes: by default beside the store, under its name."""
    if asked.view not in VIEWS:
        raise InputError(f"--view {asked.view} is not known; take {', '.join(VIEWS)}")
    if asked.out is None:
        return beside(path, FORMATS[0], "" if asked.view == VIEWS[0] else f"-{asked.view}")
    if asked.out.suffix.lower() != _PAGE:
        check_figure_name("--out", asked.out)
    elif asked.view != VIEWS[0]:
        raise InputError(f"--out {asked.out} is a page, which shows --view diagram; give a figure")
    return asked.out


def _part(path: Path, asked: Asked, *, with_shapes: bool) -> xr.Dataset:
    """Return what was chosen of a study, in memory."""
    at = dict(_chosen_value(text) for text in asked.at)
    store = chosen(load_sweep(path, shapes=with_shapes), at).load()
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
    found: StabilityBoundaries | None,
    wrong: Sequence[Disagreement],
    figure: Path,
    claim: Claim,
) -> None:
    lines = _lines(found) if found and FORCE in varied(store) else []
    notes = [(one.at, one.sentence) for one in wrong if not one.near]
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


def _lines(found: StabilityBoundaries) -> list[tuple[str, Any, Any]]:
    """Return the borders that have a force somewhere, as the views draw them."""
    values = np.array(found.values)
    curves = [(name, values, found.curve(name)[0]) for name in BOUNDARIES]
    return [curve for curve in curves if np.isfinite(curve[2]).any()]
