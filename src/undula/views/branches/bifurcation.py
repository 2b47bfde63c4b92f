"""The bifurcation diagram: frequency and bending energy of states along a parameter."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator
from numpy.typing import ArrayLike

from undula.analysis.states.branch import Branch
from undula.errors import InputError
from undula.models.scales import Scales
from undula.views.branches.named_branches import (
    DASHES,
    WIDTH,
    NamedBranch,
    draw_energy,
    draw_line,
    named_branches,
)
from undula.views.branches.stored_points import StoredPoint, stored_points
from undula.views.common import style
from undula.views.common.labels import Label, label_above
from undula.views.common.legends import fitting_legend

# Edges of the panels in fractions of the figure.
_LEFT, _RIGHT, _BOTTOM = 0.09, 0.975, 0.105
# Margin at both ends of the parameter axis in fractions of its span, for marks that lie there.
_MARGIN = 0.02


def bifurcation_diagram(
    branches: Sequence[Branch[Any]],
    *,
    title: str,
    runs: Sequence[xr.Dataset] = (),
    scales: Scales | None = None,
) -> Figure:
    """Draw states along a parameter, with their stability and their bifurcations.

    Parameters
    ----------
    branches : sequence of Branch
        At least one, all along the same parameter; each is drawn in the order of following.
    title : str
        Title of the figure.
    runs : sequence of xarray.Dataset
        Stored runs to compare with, as `undula.load_result` returns them. Runs that end straight,
        have no frequency, lack the parameter or have other units are only counted in a note.
    scales : Scales, optional
        SI values of the dimensionless units, which the labels then state.

    Returns
    -------
    matplotlib.figure.Figure
        10 by 5.5 inches, not registered with pyplot. Stable parts are solid, unstable ones dashed.

    Raises
    ------
    InputError
        No branch is given, or the branches have different parameters or units.

    Examples
    --------
    >>> import undula as un
    >>> state = un.find(un.Filament(8, un.TipLoad(60.0)), "spinning")
    >>> branch = un.follow(state, "load.force", 80.0)
    >>> figure = un.views.bifurcation_diagram([branch], title="spinning")
    >>> figure.savefig("branch.pdf")
    """
    parameter, units = _common_parameter(branches), _common_units(branches)
    drawn = named_branches(branches)
    points = stored_points(runs, parameter, units)
    span = _span([*(branch.line.values for branch in drawn), [point.value for point in points]])
    with style.figure_style(scales):
        figure = style.headed_figure(title, paper_time=False)
        top = label_above(figure, _labels(drawn, span), _LEFT, _RIGHT)
        grid = figure.add_gridspec(
            2, 1, left=_LEFT, right=_RIGHT, bottom=_BOTTOM, top=top, hspace=0.12
        )
        upper = figure.add_subplot(grid[0], xlim=span)
        lower = figure.add_subplot(grid[1], sharex=upper)
        for branch in drawn:
            draw_line(upper, branch, branch.line.frequencies)
            draw_energy(lower, branch)
        _draw_runs(upper, lower, points)
        _name_axes(figure, upper, lower, parameter, units)
        _add_legend(figure, drawn, points, len(runs) - len(points))
    return figure


def _common_parameter(branches: Sequence[Branch[Any]]) -> str:
    parameters = sorted({branch.parameter for branch in branches})
    if not parameters:
        raise InputError("branches is empty: give at least one branch")
    if len(parameters) > 1:
        raise InputError(
            f"branches are along {' and '.join(parameters)}: give branches along one parameter"
        )
    return parameters[0]


def _common_units(branches: Sequence[Branch[Any]]) -> style.UnitNames:
    # States without a model, of which only numbers are known, are taken as a filament's.
    models = [getattr(branch.states[0], "model", None) for branch in branches]
    units = [style.FILAMENT if model is None else model.units.names() for model in models]
    others = [names["force"] for names in units if names != units[0]]
    if others:
        raise InputError(
            f"branches have forces in {units[0]['force']} and in {others[0]}: give branches in the"
            " same units"
        )
    return units[0]


def _span(places: Sequence[ArrayLike]) -> tuple[float, float]:
    """Return the ends of the parameter axis; a single value lies in its middle."""
    values = np.concatenate([np.asarray(part, dtype=np.float64) for part in places])
    low, high = float(values.min()), float(values.max())
    margin = _MARGIN * (high - low) or max(0.1 * abs(low), 0.1)
    return low - margin, high + margin


def _labels(drawn: Sequence[NamedBranch], span: tuple[float, float]) -> list[Label]:
    scale = (_RIGHT - _LEFT) / (span[1] - span[0])
    return [
        Label(
            _LEFT + scale * (point.value - span[0]),
            f"{point.kind}\nat {point.value:.4g}",
            branch.colour,
        )
        for branch in drawn
        for point in branch.branch.bifurcations
    ]


def _draw_runs(upper: Axes, lower: Axes, points: Sequence[StoredPoint]) -> None:
    places = [point.value for point in points]
    look: Any = {"color": style.INK, "ms": 4.5, "zorder": 5, "gid": "runs"}
    upper.plot(places, [point.frequency for point in points], "o", **look)
    lower.plot(places, [point.energy.mean for point in points], "o", **look)
    bounds = [(p.energy.min, p.energy.max) for p in points]
    lows, highs = np.array(bounds).reshape(-1, 2).T
    lower.vlines(places, lows, highs, color=style.INK, lw=1.1, zorder=5, gid="runs, range")


def _name_axes(
    figure: Figure, upper: Axes, lower: Axes, parameter: str, units: style.UnitNames
) -> None:
    for axes in (upper, lower):
        axes.margins(y=0.08)
        axes.yaxis.set_major_locator(MaxNLocator(5))
    upper.tick_params(labelbottom=False)
    upper.set_ylabel(style.frequency_label(paper_time=False))
    lower.set_ylabel(style.energy_label(units))
    is_force = parameter == "load.force"
    lower.set_xlabel(style.force_label(units) if is_force else style.parameter_label(parameter))
    figure.align_ylabels([upper, lower])


def _add_legend(
    figure: Figure, drawn: Sequence[NamedBranch], points: Sequence[StoredPoint], left_out: int
) -> None:
    """Add the legend, and a note on the number of runs that are left out."""
    handles: list[Artist] = [
        Line2D([], [], color=branch.colour, lw=WIDTH, label=branch.name) for branch in drawn
    ]
    if not all(branch.stable_throughout for branch in drawn):
        dashes = DASHES[False]
        handles.append(Line2D([], [], color=style.QUIET, lw=WIDTH, ls=dashes, label="unstable"))
    if any(np.any(branch.line.low < branch.line.high) for branch in drawn):
        handles.append(Patch(color=style.SHADOW, label="range over a cycle"))
    if points:
        handles.append(Line2D([], [], color=style.INK, ls="", marker="o", ms=4.5, label="runs"))
    fitting_legend(figure, handles, (_LEFT - 0.01, 0.945), handlelength=2.4)
    if left_out:
        all_runs = left_out + len(points)
        note = f"{left_out} of {all_runs} runs left out: no frequency or value in these units"
        figure.text(_RIGHT, 0.025, note, ha="right", color=style.QUIET, fontsize=8)
