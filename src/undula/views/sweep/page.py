"""Interactive diagram of a sweep: a single page of HTML without external resources."""

import base64
import html
import json
import re
from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.colors import to_hex

from undula.analysis.observables.shapes import transverse
from undula.arrays import Array
from undula.schema.sweep_axes import axes_of
from undula.views.common import style
from undula.views.common.physical_labels import labelled, physical_units_of
from undula.views.common.renamed_keyword import renamed_keyword
from undula.views.sweep.axes import Border
from undula.views.sweep.page_script import FRAME, SCRIPT
from undula.views.sweep.page_traces import border_traces, dot_traces, layout, plain
from undula.views.sweep.points import (
    Dot,
    Note,
    diagram_axes,
    dots_of,
    heading,
    note_at,
    stored_shapes,
)

# Positions per L as integers: with 16 bits, they extend to 3 L.
_PER_LENGTH = 10_000
# Number of shades of shapes.
_SHADES = 24
# Variables that are not listed in the table of a point.
_NO_FIGURES = ("status", "shapes", "shape_times")


@renamed_keyword("borders", "boundaries")
def phase_page(
    store: xr.Dataset,
    boundaries: Sequence[Border] = (),
    *,
    contradicting: Sequence[Note] = (),
    title: str | None = None,
) -> str:
    """Return the diagram of a sweep as a page for a browser.

    Pointing at a dot shows the results there and, if the sweep has shapes, draws them next to the
    diagram; a click keeps them until the next click.

    Parameters
    ----------
    store : xarray.Dataset
        A stored sweep that varies one or two axes; values of other axes are selected with `sel`.
    boundaries : sequence of (str, ndarray, ndarray)
        As for `phase_diagram`.
    contradicting : sequence of (mapping of str to float, str)
        As for `phase_diagram`; the sentences are listed among the results.
    title : str, optional
        Title of the page; by default the load, and the values of axes that do not vary.

    Returns
    -------
    str
        A page of HTML that includes the plotting library, about 5 MB, and loads nothing else.

    Raises
    ------
    InputError
        The dataset is not a stored sweep, or varies more than two axes.

    Examples
    --------
    >>> from pathlib import Path
    >>> import undula
    >>> from undula.views import phase_page
    >>> stored = undula.load("results/point-loads.zarr")
    >>> size = Path("page.html").write_text(phase_page(stored), "utf-8")
    """
    with labelled(physical_units_of(store)):
        return _page(store, boundaries, contradicting, title)


def _page(
    store: xr.Dataset,
    boundaries: Sequence[Border],
    contradicting: Sequence[Note],
    title: str | None,
) -> str:
    names, dots = diagram_axes(store), dots_of(store)
    points = [_point(store, dot, note_at(dot, names, contradicting)) for dot in dots]
    content = {
        "traces": [
            *border_traces(store, names, boundaries),
            *dot_traces(store, names, dots, contradicting),
        ],
        "layout": layout(store, names, dots),
        "points": points,
        "nodes": store.sizes.get("node", 0),
        "per_length": _PER_LENGTH,
        "colours": [to_hex(colour) for colour in style.shape_colours(_SHADES)],
        **_extent(store),
    }
    # Escaped, since the JSON must not end the script that contains it.
    embedded = json.dumps(content, allow_nan=False, separators=(",", ":")).replace("</", "<\\/")
    return FRAME.format(
        title=html.escape(plain(heading(store) if title is None else title)),
        library=plotting_library(),
        content=embedded,
        script=SCRIPT,
    )


@cache
def plotting_library() -> str:
    """Return the plotting library without addresses of other machines.

    The addresses belong to maps and services that the page does not use. Names in notices stay.
    """
    from plotly.offline import get_plotlyjs  # the import is slow, and no figure needs it

    library = re.sub(r"https?://(?!www\.w3\.org/)", "", str(get_plotlyjs()))
    return library.replace("</script", "<\\/script")


def _point(store: xr.Dataset, dot: Dot, note: str | None) -> dict[str, Any]:
    """Return the results at a dot for its page: table, shapes and plane of motion."""
    point_data = store.isel(dict(dot.index))
    coordinates = ((name, point_data[name]) for name in axes_of(store))
    figures = [(name, f"{float(value):.6g}{_physical(value)}") for name, value in coordinates]
    if dot.of > 1:
        figures.append(("tries", f"{dot.tries} of {dot.of} end so, the first is told"))
    if note is not None:
        figures.append(("contradicts", note))
    for name, value in point_data.data_vars.items():
        if value.ndim == 0 and name not in _NO_FIGURES:
            figures += _figure(str(name), value)
    point: dict[str, Any] = {"figures": figures}
    shapes = stored_shapes(store, dot.index) if "shapes" in store and dot.verdict else None
    if shapes is not None:
        point |= {"shapes": _packed(shapes), "angle": _plane(shapes)}
    return point


def _figure(name: str, value: xr.DataArray) -> list[tuple[str, str]]:
    """Return a variable as a row of a table, no row without a value."""
    unit = str(value.attrs.get("units", ""))
    if np.issubdtype(value.dtype, np.number):
        number = float(value)
        text = f"{number:.6g} {unit}".rstrip() + _physical(value)
        return [(name, text)] if np.isfinite(number) else []
    return [(name, str(value.item()))] if str(value.item()) else []


def _physical(value: xr.DataArray) -> str:
    """Return a number in its physical unit, in brackets after a blank; empty without."""
    if "physical_unit" not in value.attrs:
        return ""
    number = float(value) * float(value.attrs["physical_factor"])
    return f" ({number:.4g} {value.attrs['physical_unit']})"


def _packed(shapes: Array) -> str:
    whole = np.clip(np.rint(shapes * _PER_LENGTH), -32768, 32767).astype("<i2")
    return base64.b64encode(whole.tobytes()).decode("ascii")


def _plane(shapes: Array) -> float:
    """Return the azimuth of the best plane of a motion [rad]."""
    return round(float(0.5 * np.angle(np.sum(transverse(shapes) ** 2))), 4)


def _extent(store: xr.Dataset) -> dict[str, float]:
    """Return the extent of shapes to the sides and downwards [L]."""
    if "shapes" not in store:
        return {"reach": 1.0, "lowest": 0.0}
    positions = store["shapes"].transpose(..., "axis").values
    sides = np.hypot(positions[..., 0], positions[..., 1])
    reach, lowest = np.nanmax(sides, initial=0.3), np.nanmin(positions[..., 2], initial=0.0)
    return {"reach": round(1.08 * float(reach), 3), "lowest": round(float(lowest), 3)}
