"""Which states are stable at which force, and where there are two."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from undula.reproduction.figures.answered_branches import (
    AnsweredBranch,
    parts,
    read_branch,
    same_units,
)
from undula.reproduction.figures.branch_panels import FLAPPING, SPINNING
from undula.views.common import style
from undula.views.common.panels import legend_above, letter_axes

_ROWS = ("straight", "spinning", "planar flapping")
_STABLE, _UNSTABLE = 9.0, 1.4
#: A close-up shows the common stretch with so much of its width on either side.
_AROUND = 1.0

Stretch = tuple[float, float]


def bistability(spinning: Mapping[str, Any], flapping: Mapping[str, Any]) -> Figure:
    """Draw the stretches of force on which straight, spinning and flapping are stable.

    Parameters
    ----------
    spinning, flapping : mapping
        Answers of `undula follow`; from one that begins at the onset it is known how far the
        straight state is stable.

    Returns
    -------
    matplotlib.figure.Figure
        9 by 3.4 inches, not known to pyplot: (a) all forces, (b) those around the stretch on which
        both are stable, if there is one.

    Raises
    ------
    InputError
        An answer is of another kind, or the answers are in different units.
    """
    branches = read_branch(spinning), read_branch(flapping)
    units = same_units(*(one.units for one in branches))
    both = common_stretches(*branches)
    end = max(float(one.forces.max()) for one in branches)
    edges = ((0.13, 0.6), (0.68, 0.975)) if both else ((0.13, 0.975),)
    spans = [(0.0, end)]
    if both:
        wide = _AROUND * (both[0][1] - both[0][0])
        spans.append((both[0][0] - wide, both[0][1] + wide))
    with style.figure_style():
        figure = Figure(figsize=(9.0, 3.4))
        for (left, right), span, which in zip(edges, spans, "ab", strict=False):
            axes = figure.add_axes((left, 0.175, right - left, 0.6))
            _draw(axes, branches, both)
            axes.set(xlim=span, ylim=(-0.55, 2.55))
            axes.invert_yaxis()
            axes.set_xlabel(style.force_label(units))
            axes.set_yticks(range(3), _ROWS if which == "a" else [""] * 3)
            axes.tick_params(axis="y", length=0.0, labelsize=9.0, labelcolor=style.INK)
            if both:
                letter_axes(figure, axes, which, 0.2)
        if both:
            _tell(figure.axes[-1], both[0])
        turns = any(one.turns for one in branches)
        legend_above(figure, _handles(turns=turns, both=bool(both)), 0.13)
    return figure


def common_stretches(one: AnsweredBranch, other: AnsweredBranch) -> list[Stretch]:
    """Return the stretches of force on which both are stable."""
    pairs = [(a, b) for a in one.stable_stretches for b in other.stable_stretches]
    common = [(max(a[0], b[0]), min(a[1], b[1])) for a, b in pairs]
    return sorted(stretch for stretch in common if stretch[0] < stretch[1])


def _draw(axes: Axes, branches: tuple[AnsweredBranch, AnsweredBranch], both: list[Stretch]) -> None:
    for low, high in both:
        axes.axvspan(low, high, color=style.FOCUS, lw=0.0, gid="both", zorder=0)
    onsets = [one.onset for one in branches if one.onset is not None]
    if onsets:
        onset, end = float(np.mean(onsets)), max(float(one.forces.max()) for one in branches)
        _bar(axes, 0, (0.0, onset), style.INK, stable=True)
        _bar(axes, 0, (onset, end), style.INK, stable=False)
    for row, (branch, (colour, _)) in enumerate(
        zip(branches, (SPINNING, FLAPPING), strict=True), start=1
    ):
        for start, last, stable in parts(branch.stable):
            some = branch.forces[start : last + 1]
            _bar(axes, row, (float(some.min()), float(some.max())), colour, stable=stable)
        forces = [turn.force for turn in branch.turns]
        look: Any = {"mec": colour, "mfc": "white", "ms": 7.0, "mew": 1.6, "zorder": 4}
        axes.plot(forces, [row] * len(forces), "D", gid=f"{_ROWS[row]}, bifurcations", **look)


def _bar(axes: Axes, row: int, stretch: Stretch, colour: str, *, stable: bool) -> None:
    look: Any = {"color": colour, "lw": _STABLE if stable else _UNSTABLE, "zorder": 3}
    look |= {"ls": "-" if stable else (0, (3.6, 2.0)), "solid_capstyle": "butt"}
    gid = f"{_ROWS[row]}, {'stable' if stable else 'unstable'}"
    axes.plot(stretch, [row, row], gid=gid, dash_capstyle="butt", **look)


def _tell(axes: Axes, stretch: Stretch) -> None:
    for force, side in zip(stretch, ("right", "left"), strict=True):
        axes.annotate(
            f"{force:.5g}",
            (force, 1.0),
            xycoords=axes.get_xaxis_transform(),
            xytext=(4 if side == "right" else -4, 4),
            textcoords="offset points",
            ha=side,
            gid="end of both",
        )


def _handles(*, turns: bool, both: bool) -> list[Any]:
    look: Any = {"color": style.QUIET}
    handles: list[Any] = [
        Line2D([], [], lw=_STABLE, solid_capstyle="butt", label="stable", **look),
        Line2D([], [], lw=_UNSTABLE, ls=(0, (3.6, 2.0)), label="unstable", **look),
    ]
    if turns:
        mark: Any = {"ls": "", "marker": "D", "mfc": "white", "mew": 1.6}
        handles.append(Line2D([], [], label="bifurcation", **mark, **look))
    if both:
        handles.append(Patch(color=style.FOCUS, label="spinning and flapping both stable"))
    return handles
