"""Answered branches in panels over the force: their lines, and the forces of their bifurcations."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from undula.arrays import Array
from undula.reproduction.figures.answered_branches import AnsweredBranch, Turn, parts
from undula.views.common import style
from undula.views.common.labels import Label

#: Colour and name of each kind of branch.
SPINNING, FLAPPING = (style.X_COLOUR, "spinning"), (style.Y_COLOUR, "planar flapping")
#: Width and dashes of stable and of unstable parts.
_PARTS: Any = {True: (2.1, "-"), False: (1.2, (0, (3.6, 2.0)))}


def draw_branch(axes: Axes, branch: AnsweredBranch, heights: Array, look: tuple[str, str]) -> None:
    """Draw a quantity of a branch, in the colour and with the name of a look."""
    colour, name = look
    for start, end, stable in parts(branch.stable):
        width, dashes = _PARTS[stable]
        how: Any = {"color": colour, "lw": width, "ls": dashes, "dash_capstyle": "butt"}
        how["gid"] = f"{name}, {'stable' if stable else 'unstable'}"
        axes.plot(branch.forces[start : end + 1], heights[start : end + 1], **how)


def branch_handles(branches: Sequence[AnsweredBranch]) -> list[Line2D]:
    """Return what names spinning, flapping and, where there are any, unstable parts in a legend."""
    handles = [
        Line2D([], [], color=c, lw=_PARTS[True][0], label=n) for c, n in (SPINNING, FLAPPING)
    ]
    if not all(np.all(one.stable) for one in branches):
        width, dashes = _PARTS[False]
        look: Any = {"color": style.QUIET, "lw": width, "ls": dashes, "label": "unstable"}
        handles.append(Line2D([], [], **look))
    return handles


def force_labels(
    spinning: AnsweredBranch,
    flapping: AnsweredBranch,
    span: tuple[float, float],
    edges: tuple[float, float],
) -> list[Label]:
    """Return names and forces of the bifurcations within a span, for a panel between two edges."""
    scale = (edges[1] - edges[0]) / (span[1] - span[0])
    return [
        Label(
            edges[0] + scale * (turn.force - span[0]),
            f"{name.split()[-1]} {_what(turn)}\n{turn.force:#.4g}",
            colour,
        )
        for branch, (colour, name) in ((spinning, SPINNING), (flapping, FLAPPING))
        for turn in branch.turns
        if span[0] <= turn.force <= span[1]
    ]


def _what(turn: Turn) -> str:
    return turn.stability if turn.stability in ("lost", "gained") else turn.kind


def draw_forces(axes: Axes, spinning: AnsweredBranch, flapping: AnsweredBranch) -> None:
    """Draw a thin line at the force of each bifurcation."""
    for branch, (colour, name) in ((spinning, SPINNING), (flapping, FLAPPING)):
        for turn in branch.turns:
            look: Any = {"color": colour, "lw": 0.8, "alpha": 0.6, "zorder": 1}
            axes.axvline(turn.force, gid=f"{name}, bifurcation", **look)
