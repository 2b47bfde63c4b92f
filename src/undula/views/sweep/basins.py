"""Shares of starts with each verdict: pies over two axes, stacked bars over one axis."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.path import Path

from undula.arrays import Array
from undula.errors import InputError
from undula.views.common import style
from undula.views.common.renamed_keyword import renamed_keyword
from undula.views.common.verdict_styles import look_of, ordered
from undula.views.sweep.axes import (
    Border,
    diagram_on,
    draw_borders,
    place_legend,
    set_scale,
    steps_in_points,
)
from undula.views.sweep.points import axis_label, laid_out, units_of

_SIZE = (10.0, 7.0)
_LEFT, _RIGHT, _BOTTOM = 0.085, 0.975, 0.085
# Width of a pie or bar over the distance of its neighbours, and largest width of a pie [points].
_FILLED, _WIDEST = 0.8, 40.0
# Number of corners of a whole pie.
_CORNERS = 96


@renamed_keyword("borders", "boundaries")
def basin_diagram(
    basins: xr.Dataset, boundaries: Sequence[Border] = (), *, title: str | None = None
) -> Figure:
    """Draw the share of starts that end in each verdict.

    Parameters
    ----------
    basins : xarray.Dataset
        Shares over one or two varied axes, as `undula.basins` returns them.
    boundaries : sequence of (str, ndarray, ndarray)
        As for `phase_diagram`; for pies only.
    title : str, optional
        Title of the figure.

    Returns
    -------
    matplotlib.figure.Figure
        10 by 7 inches, not registered with pyplot. The shares of a pie run clockwise from the top,
        in the order of the legend; a panel below the bars shows them with their Wilson intervals.

    Raises
    ------
    InputError
        The dataset holds no shares, varies more than two axes, or has no results.

    Examples
    --------
    >>> import undula
    >>> from undula.views import basin_diagram
    >>> stored = undula.load("results/starts.zarr")
    >>> basin_diagram(undula.basins(stored)).savefig("basins.png")
    """
    if "fraction" not in basins or not int(basins["tries"].sum()):
        raise InputError("there are no shares of verdicts; give those of a sweep with answers")
    names = [str(name) for name in basins["tries"].dims]
    x, y = laid_out([name for name in names if basins.sizes[name] > 1] or names[:1])
    with style.figure_style(basins):
        figure = Figure(figsize=_SIZE)
        style.write_title(figure, title or "", (0.022, 0.962))
        verdicts = ordered(str(name) for name in basins["verdict"].values)
        patches = [Patch(color=look_of(verdict).colour, label=verdict) for verdict in verdicts]
        if y is None:
            top = place_legend(figure, [patches], _LEFT, 0.945) - 0.012
            middle = _BOTTOM + 0.5 * (top - _BOTTOM)
            upper = figure.add_axes((_LEFT, middle + 0.025, _RIGHT - _LEFT, top - middle - 0.025))
            lower = figure.add_axes((_LEFT, _BOTTOM, _RIGHT - _LEFT, middle - _BOTTOM - 0.025))
            _draw_bars(upper, lower, basins, x, verdicts)
            lower.set_xlabel(axis_label(x, units_of(basins)))
            upper.set_ylabel("share of starts")
            confidence = float(basins.attrs.get("confidence", np.nan))
            lower.set_ylabel(f"share of starts,\nto {confidence:.0%}")
        else:
            axes = diagram_on(figure, basins, (x, y), (_LEFT, _BOTTOM, _RIGHT - _LEFT, 0.8))
            rows: list[Sequence[Artist]] = [patches, draw_borders(axes, boundaries)]
            top = place_legend(figure, rows, _LEFT, 0.945) - 0.012
            axes.set_position((_LEFT, _BOTTOM, _RIGHT - _LEFT, top - _BOTTOM))
            _draw_pies(axes, basins, (x, y), verdicts)
    return figure


def _draw_pies(
    axes: Axes, basins: xr.Dataset, names: tuple[str, str], verdicts: Sequence[str]
) -> None:
    width = min(_WIDEST, _FILLED * min(steps_in_points(axes, basins, names)))
    shares = basins["fraction"].sel(verdict=list(verdicts)).squeeze(drop=True)
    for x in basins[names[0]].values:
        for y in basins[names[1]].values:
            parts = shares.sel({names[0]: x, names[1]: y}).values
            if not np.all(np.isfinite(parts)):
                continue
            ends = np.concatenate([[0.0], np.cumsum(parts)])
            for verdict, start, end in zip(verdicts, ends[:-1], ends[1:], strict=True):
                if end > start:
                    _draw_slice(axes, (x, y), (start, end), width, verdict)


def _draw_slice(
    axes: Axes, place: tuple[float, float], part: tuple[float, float], width: float, verdict: str
) -> None:
    """Draw the slice of a pie between two fractions of its circumference."""
    count = max(2, round(_CORNERS * (part[1] - part[0])) + 1)
    angles = 2.0 * np.pi * np.linspace(*part, count)
    rim = np.stack([np.sin(angles), np.cos(angles)], axis=1)
    whole = part[1] - part[0] > 1.0 - 1e-9
    corners = rim if whole else np.concatenate([[[0.0, 0.0]], rim, [[0.0, 0.0]]])
    # Markers are scaled by their farthest corner, which lies on the rim.
    size = float(width * np.abs(corners).max()) ** 2
    look: Any = {"marker": Path(corners), "s": size, "gid": verdict, "zorder": 5}
    colour = look_of(verdict).colour
    axes.scatter(*place, facecolor=colour, edgecolor="white", linewidths=0.5, **look)


def _draw_bars(
    upper: Axes, lower: Axes, basins: xr.Dataset, name: str, verdicts: Sequence[str]
) -> None:
    """Draw stacked shares, and single shares with their intervals in a panel below."""
    values = np.asarray(basins[name].values, dtype=float)
    shares, low, high = (
        basins[part].sel(verdict=list(verdicts)).transpose(name, "verdict", ...).values
        for part in ("fraction", "low", "high")
    )
    shares, low, high = (part.reshape(values.size, -1) for part in (shares, low, high))
    for axes in (upper, lower):
        set_scale(axes, "x", values)
        axes.set_ylim(0.0, 1.0)
    upper.tick_params(labelbottom=False)
    widths, below = _widths(upper, values), np.zeros(values.size)
    for number, verdict in enumerate(verdicts):
        look, part = look_of(verdict), shares[:, number]
        upper.bar(values, part, widths, below, color=look.colour, edgecolor="white", gid=verdict)
        below = below + part
        # Small shifts keep the symbols from overlapping.
        shifted = values + widths * ((number + 1.0) / (len(verdicts) + 1.0) - 0.5)
        ends = np.stack([part - low[:, number], high[:, number] - part])
        points: Any = {"fmt": look.marker, "ms": 5.0, "color": look.colour, "capsize": 2.0}
        # Round-off may make the ends of shares 0 and 1 negative.
        occurs = part > 0.0
        ends = np.maximum(ends, 0.0)[:, occurs]
        lower.errorbar(shifted[occurs], part[occurs], ends, clip_on=False, zorder=4, **points)


def _widths(axes: Axes, values: Array) -> Array:
    """Return the widths of bars, which appear equal on the scale of the axis."""
    low, high = axes.get_xlim()
    if axes.get_xscale() == "log":
        steps = np.diff(np.unique(np.log(values)))
        ratio = np.exp(0.5 * _FILLED * float(steps.min())) if steps.size else 1.2
        return np.asarray(values * (ratio - 1.0 / ratio))
    steps = np.diff(np.unique(values))
    return np.full(values.size, _FILLED * (float(steps.min()) if steps.size else high - low))
