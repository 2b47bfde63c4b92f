"""Intervals of force on which states are stable, and those on which two of them are."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from undula.reproduction.figures.branch_panels import STRAIGHT, Pair, last_force, read_pair
from undula.reproduction.figures.same_units import same_units
from undula.views.common import style
from undula.views.common.panels import legend_above, letter_axes

_ROWS = ("straight", "spinning", "planar flapping")
#: Widths of the bars of stable and unstable parts [points].
_STABLE, _UNSTABLE = 9.0, 1.4
#: Margin of the close-up on either side of the common interval, in widths of it.
_AROUND = 1.0

Interval = tuple[float, float]


def bistability(spinning: Mapping[str, Any], flapping: Mapping[str, Any]) -> Figure:
    """Draw the intervals of force on which straight, spinning and flapping are stable.

    Parameters
    ----------
    spinning, flapping : mapping
        Answers of `undula follow`. One that begins at the onset gives the force up to which the
        straight state is stable.

    Returns
    -------
    matplotlib.figure.Figure
        9 by 3.4 inches, not registered with pyplot: (a) all forces, (b) those around the interval
        on which both are stable, if there is one.

    Raises
    ------
    InputError
        An answer is of another kind, or the answers are in different units.
    """
    pair = read_pair(spinning, flapping)
    units = same_units(spinning["units"], flapping["units"])
    common = common_intervals(pair)
    end = last_force(pair)
    edges = ((0.13, 0.6), (0.68, 0.975)) if common else ((0.13, 0.975),)
    spans = [(0.0, end)]
    if common:
        low, high = common[0]
        margin = _AROUND * (high - low)
        spans.append((low - margin, high + margin))
    with style.figure_style():
        figure = Figure(figsize=(9.0, 3.4))
        for (left, right), span, which in zip(edges, spans, "ab", strict=False):
            axes = figure.add_axes((left, 0.175, right - left, 0.6))
            _draw(axes, pair, common)
            axes.set(xlim=span, ylim=(-0.55, 2.55))
            axes.invert_yaxis()
            axes.set_xlabel(style.force_label(units))
            axes.set_yticks(range(3), _ROWS if which == "a" else [""] * 3)
            axes.tick_params(axis="y", length=0.0, labelsize=9.0, labelcolor=style.INK)
            if common:
                letter_axes(figure, axes, which, 0.2)
        if common:
            _annotate(figure.axes[-1], common[0])
        bifurcations = any(branch.branch.bifurcations for branch in pair)
        legend_above(figure, _handles(bifurcations=bifurcations, both=bool(common)), 0.13)
    return figure


def common_intervals(pair: Pair) -> list[Interval]:
    """Return the intervals of force on which both branches are stable."""
    first, second = (branch.line.stable_intervals for branch in pair)
    common = [(max(a[0], b[0]), min(a[1], b[1])) for a in first for b in second]
    return sorted(interval for interval in common if interval[0] < interval[1])


def _draw(axes: Axes, pair: Pair, common: list[Interval]) -> None:
    for low, high in common:
        axes.axvspan(low, high, color=style.FOCUS, lw=0.0, gid="both", zorder=0)
    onsets = [drawn.branch.onset for drawn in pair if drawn.branch.onset is not None]
    if onsets:
        onset = float(np.mean(onsets))
        _bar(axes, 0, (0.0, onset), STRAIGHT[0], stable=True)
        _bar(axes, 0, (onset, last_force(pair)), STRAIGHT[0], stable=False)
    for row, branch in enumerate(pair, start=1):
        for part, stable in branch.line.parts:
            forces = branch.line.values[part]
            interval = float(forces.min()), float(forces.max())
            _bar(axes, row, interval, branch.colour, stable=stable)
        places = [bifurcation.value for bifurcation in branch.branch.bifurcations]
        look: Any = {"mec": branch.colour, "mfc": "white", "ms": 7.0, "mew": 1.6, "zorder": 4}
        axes.plot(places, [row] * len(places), "D", gid=f"{_ROWS[row]}, bifurcations", **look)


def _bar(axes: Axes, row: int, interval: Interval, colour: str, *, stable: bool) -> None:
    look: Any = {"color": colour, "lw": _STABLE if stable else _UNSTABLE, "zorder": 3}
    look |= {"ls": "-" if stable else (0, (3.6, 2.0)), "solid_capstyle": "butt"}
    gid = f"{_ROWS[row]}, {'stable' if stable else 'unstable'}"
    axes.plot(interval, [row, row], gid=gid, dash_capstyle="butt", **look)


def _annotate(axes: Axes, interval: Interval) -> None:
    for force, side in zip(interval, ("right", "left"), strict=True):
        axes.annotate(
            f"{force:.5g}",
            (force, 1.0),
            xycoords=axes.get_xaxis_transform(),
            xytext=(4 if side == "right" else -4, 4),
            textcoords="offset points",
            ha=side,
            gid="end of both",
        )


def _handles(*, bifurcations: bool, both: bool) -> list[Any]:
    look: Any = {"color": style.QUIET}
    handles: list[Any] = [
        Line2D([], [], lw=_STABLE, solid_capstyle="butt", label="stable", **look),
        Line2D([], [], lw=_UNSTABLE, ls=(0, (3.6, 2.0)), label="unstable", **look),
    ]
    if bifurcations:
        mark: Any = {"ls": "", "marker": "D", "mfc": "white", "mew": 1.6}
        handles.append(Line2D([], [], label="bifurcation", **mark, **look))
    if both:
        handles.append(Patch(color=style.FOCUS, label="spinning and flapping both stable"))
    return handles
