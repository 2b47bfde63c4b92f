"""Frequencies of motions against the force, with the growth rate of the straight state.

After the figures "Frequency of oscillations versus linear stability analysis" and "Linear stability
of two-link and three-link chains" of Ling, Guo & Kanso (2018).
"""

import json
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from matplotlib.ticker import MaxNLocator

from undula.arrays import Array
from undula.errors import InputError, is_number
from undula.reproduction.figures.branch_panels import (
    STRAIGHT,
    Pair,
    branch_handles,
    draw_branch,
    draw_forces,
    force_labels,
    last_force,
    read_pair,
)
from undula.reproduction.figures.same_units import same_units
from undula.views.common import style
from undula.views.common.labels import Label, label_above
from undula.views.common.panels import legend_above, letter_axes, quiet_line
from undula.views.common.verdict_styles import look_of, ordered
from undula.views.run.reading import units_of

_BOTTOM = 0.125
_COLUMNS = ((0.072, 0.425), (0.572, 0.925))
_ALONE = ((0.072, 0.925),)
# The first panel ends at a third of the forces, as in the paper, but not below twice the onset; it
# is left out if that is nearly all forces.
_PARTS, _ONSETS, _NEARLY_ALL = 3.0, 2.0, 0.8
# Space below zero for rates of decay, at least and at most, and above the curves, as shares of the
# height above zero.
_LEAST_BELOW, _MOST_BELOW, _HEADROOM = 0.03, 0.3, 1.08

Rows = tuple[Array, Array, Array]


def frequencies(
    growth: Mapping[str, Any],
    spinning: Mapping[str, Any],
    flapping: Mapping[str, Any],
    *runs: xr.Dataset,
) -> Figure:
    """Draw growth rate and frequency of the straight state, and frequencies of both motions.

    Parameters
    ----------
    growth : mapping
        Answer of `undula stability --forces`.
    spinning, flapping : mapping
        Answers of `undula follow`; their last force is that of the figure.
    *runs : xarray.Dataset
        Stored runs, drawn as dots by verdict; straight ones and those without a frequency are not.

    Returns
    -------
    matplotlib.figure.Figure
        10 by 4.9 inches, not registered with pyplot: (a) the first third of the forces, (b) all of
        them; or all in one panel if motions begin later.

    Raises
    ------
    InputError
        An answer is of another kind, or the answers are in different units.
    """
    pair = read_pair(spinning, flapping)
    units = same_units(growth["units"], spinning["units"], flapping["units"])
    if growth.get("paper_time") or "points" not in growth:
        raise InputError(
            "growth is no answer of `undula stability --forces` in the package's own time unit;"
            " give one"
        )
    rows, ends = _rows(growth), _last_forces(pair)
    places = _COLUMNS if len(ends) == 2 else _ALONE
    dots = _dots(runs, units)
    with style.figure_style():
        figure = Figure(figsize=(10.0, 4.9))
        labels = [_labels(rows, pair, end, edges) for end, edges in zip(ends, places, strict=True)]
        top = min(
            label_above(figure, names, *edges) for names, edges in zip(labels, places, strict=True)
        )
        panels = []
        for end, (left, right) in zip(ends, places, strict=True):
            axes = figure.add_axes((left, _BOTTOM, right - left, top - _BOTTOM))
            panels.append(axes)
            _draw_panel(axes, rows, pair, dots, end)
            axes.set_xlabel(style.force_label(units))
            axes.set_ylabel(style.frequency_label(paper_time=False))
        if len(panels) == 2:
            _box(panels[1], ends[0], panels[0].get_ylim()[1])
            for axes, which in zip(panels, "ab", strict=True):
                letter_axes(figure, axes, which, 0.6)
        legend_above(figure, _handles(pair, dots), places[0][0])
    return figure


def _last_forces(pair: Pair) -> tuple[float, ...]:
    """Return the last force of each panel."""
    last = last_force(pair)
    onset = min(float(branch.line.values.min()) for branch in pair)
    first = max(last / _PARTS, math.ceil(_ONSETS * onset))
    return (first, last) if first < _NEARLY_ALL * last else (last,)


def _rows(growth: Mapping[str, Any]) -> Rows:
    """Return forces, rates and frequencies of the straight state, by force; NaN for null."""
    points = sorted(growth["points"], key=lambda point: float(point["force"]))
    table = [
        [np.nan if point[key] is None else float(point[key]) for point in points]
        for key in ("force", "rate", "frequency")
    ]
    forces, rates, turns = np.array(table)
    return forces, rates, turns


def _dots(runs: Sequence[xr.Dataset], units: style.UnitNames) -> list[tuple[float, float, str]]:
    """Return force, frequency and verdict of the runs that do not end straight."""
    summaries = [json.loads(run.attrs["summary"]) for run in runs]
    for summary in summaries:
        same_units(units, units_of(summary))
    return [
        (float(summary["force"]), abs(float(summary["frequency"])), str(summary["verdict"]))
        for summary in summaries
        if is_number(summary.get("frequency")) and summary["verdict"] != "straight"
    ]


def _labels(rows: Rows, pair: Pair, end: float, edges: tuple[float, float]) -> list[Label]:
    labels = force_labels(pair, (0.0, end), edges)
    force = _loss(rows)
    if force is not None and force <= end:
        place = edges[0] + (edges[1] - edges[0]) * force / end
        labels.append(Label(place, f"straight lost\n{force:#.4g}", STRAIGHT[0]))
    return labels


def _loss(rows: Rows) -> float | None:
    """Return the least force at which the rate of the straight state rises through zero."""
    forces, rates, _ = rows
    rising = np.flatnonzero((rates[:-1] < 0.0) & (rates[1:] >= 0.0))
    if not rising.size:
        return None
    k = rising[0]
    part = rates[k] / (rates[k] - rates[k + 1])
    return float(forces[k] + part * (forces[k + 1] - forces[k]))


def _draw_panel(
    axes: Axes,
    rows: Rows,
    pair: Pair,
    dots: Sequence[tuple[float, float, str]],
    end: float,
) -> None:
    """Draw everything up to a force: frequencies on the left axis, rates on the right one."""
    forces, rates, turns = (values[rows[0] <= end] for values in rows)
    tops = [float(turns[np.isfinite(turns)].max(initial=0.0))]
    lines = [branch.line for branch in pair]
    tops += [float(line.frequencies[line.values <= end].max(initial=0.0)) for line in lines]
    tops += [height for force, height, _ in dots if force <= end]
    top = _HEADROOM * (max(tops) or 1.0)
    finite = rates[np.isfinite(rates)]
    greatest = _HEADROOM * (float(finite.max(initial=0.0)) or 1.0)
    deepest = -_HEADROOM * float(finite.min(initial=0.0))
    below = min(max(deepest / greatest, _LEAST_BELOW), _MOST_BELOW)
    _draw_rates(axes, forces, rates, (-below * greatest, greatest))
    axes.plot(forces, turns, color=STRAIGHT[0], lw=1.6, gid="straight, frequency")
    for branch in pair:
        draw_branch(axes, branch, branch.line.frequencies)
    for force, height, verdict in dots:
        mark = look_of(verdict)
        how: Any = {"color": mark.colour, "marker": mark.marker, "mec": "white", "mew": 0.7}
        axes.plot([force], [height], ls="", ms=6.5, zorder=6, gid=f"run, {verdict}", **how)
    draw_forces(axes, pair)
    loss = _loss(rows)
    if loss is not None:
        how = {"color": STRAIGHT[0], "lw": 0.8, "alpha": 0.6, "zorder": 1}
        axes.axvline(loss, gid="straight, loss", **how)
    quiet_line(axes)
    axes.set_xlim(0.0, end)
    axes.set_ylim(-below * top, top)
    axes.yaxis.set_major_locator(MaxNLocator(6))


def _draw_rates(axes: Axes, forces: Array, rates: Array, limits: tuple[float, float]) -> None:
    """Draw the growth rate of the straight state on an axis at the right, behind all else."""
    right = axes.twinx()
    look: Any = {"color": STRAIGHT[0], "lw": 1.3, "dash_capstyle": "butt", "ls": (0, (7.0, 2.5))}
    right.plot(forces, rates, gid="straight, growth rate", **look)
    right.set_ylim(*limits)
    right.set_ylabel(style.growth_rate_label(paper_time=False))
    right.spines["right"].set_visible(True)
    right.yaxis.set_major_locator(MaxNLocator(6))
    axes.set_zorder(right.get_zorder() + 1)
    axes.patch.set_visible(False)


def _box(axes: Axes, width: float, height: float) -> None:
    """Draw the outline of the other panel."""
    look: Any = {"fill": False, "ec": style.QUIET, "lw": 0.9, "ls": (0, (2.0, 2.0))}
    axes.add_patch(Rectangle((0.0, 0.0), width, height, gid="panel a", zorder=2, **look))


def _handles(pair: Pair, dots: Sequence[tuple[float, float, str]]) -> list[Line2D]:
    dashed: Any = {"ls": (0, (7.0, 2.5)), "lw": 1.3, "label": "straight: growth rate (right axis)"}
    handles = [
        Line2D([], [], color=STRAIGHT[0], lw=1.6, label="straight: frequency"),
        Line2D([], [], color=STRAIGHT[0], **dashed),
        *branch_handles(pair),
    ]
    for verdict in ordered(verdict for _, _, verdict in dots):
        mark = look_of(verdict)
        how: Any = {"color": mark.colour, "marker": mark.marker, "mec": "white", "mew": 0.7}
        handles.append(Line2D([], [], ls="", ms=6.5, label=f"run: {verdict}", **how))
    return handles
