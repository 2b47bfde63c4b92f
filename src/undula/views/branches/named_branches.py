"""Branches on a diagram: their names and colours, and their stable and unstable parts."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import cycle, pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from undula.analysis.states.branch import Branch
from undula.analysis.states.periodic_record import Periodic
from undula.analysis.states.records import Flapping, Spinning
from undula.arrays import Array
from undula.views.branches.branch_lines import BranchLine, branch_line
from undula.views.common.verdict_styles import look_of

_NAMES: Mapping[type[Any], str] = {
    Spinning: "spinning",
    Flapping: "planar flapping",
    Periodic: "modulated",
}
#: Colours of further branches of a name, from P. Tol's muted palette; no verdict has them.
_FURTHER = ("#44AA99", "#CC6677", "#DDCC77", "#117733", "#AA4499")
#: Verdicts that correspond to the names.
_VERDICTS = {"modulated": "modulated spinning"}
#: Line styles of stable and unstable parts.
DASHES: Any = {True: "-", False: (0, (2.6, 1.6))}
#: Width of both [points].
WIDTH = 1.8


@dataclass(frozen=True)
class NamedBranch:
    """A branch as it is drawn.

    Attributes
    ----------
    name, colour : str
        In the legend.
    branch : Branch
    line : BranchLine
        Its points.
    """

    name: str
    colour: str
    branch: Branch[Any]
    line: BranchLine

    @property
    def stable_throughout(self) -> bool:
        """True if no part of it is unstable."""
        return bool(np.all(self.line.stable)) and all(state.stable for state in self.branch.states)


def named_branches(branches: Sequence[Branch[Any]]) -> list[NamedBranch]:
    """Return branches with names, by the kind of their states and, of several, their number."""
    kinds = [type(branch.states[0]) for branch in branches]
    names = [_NAMES.get(kind, kind.__name__) for kind in kinds]
    numbers = [names[: place + 1].count(name) for place, name in enumerate(names)]
    several = Counter(names)
    return [
        NamedBranch(f"{name} {number}" if several[name] > 1 else name, colour, branch, line)
        for name, number, colour, branch, line in zip(
            names, numbers, _colours(names), branches, map(branch_line, branches), strict=True
        )
    ]


def _colours(names: Sequence[str]) -> list[str]:
    """Return the colours of branches: that of its verdict for the first branch of each name."""
    further = cycle(_FURTHER)
    return [
        next(further) if name in names[:place] else look_of(_VERDICTS.get(name, name)).colour
        for place, name in enumerate(names)
    ]


def draw_energy(axes: Axes, drawn: NamedBranch) -> None:
    """Draw the mean energy over a cycle and a band from its least to its greatest value."""
    line = drawn.line
    # Where the branch folds back a single area would cancel itself.
    turns = np.flatnonzero(np.diff(np.sign(np.diff(line.values)))) + 1
    for first, last in pairwise([0, *turns, line.values.size - 1]):
        part = slice(first, last + 1)
        look: Any = {"color": drawn.colour, "alpha": 0.16, "lw": 0, "gid": f"{drawn.name}, range"}
        if np.any(line.low[part] < line.high[part]):
            axes.fill_between(line.values[part], line.low[part], line.high[part], **look)
    if line.values.size == 1:
        axes.vlines(line.values, line.low, line.high, color=drawn.colour, lw=WIDTH)
    draw_line(axes, drawn, line.mean)


def draw_line(axes: Axes, drawn: NamedBranch, heights: Array) -> None:
    """Draw the stable and unstable parts of a quantity, and the bifurcations between them."""
    line = drawn.line
    draw_parts(axes, drawn, heights, {stable: (WIDTH, DASHES[stable]) for stable in DASHES})
    if line.values.size == 1:
        face = drawn.colour if drawn.branch.states[0].stable else "white"
        look: Any = {"mec": drawn.colour, "mfc": face, "ms": 6.0, "gid": f"{drawn.name}, point"}
        axes.plot(line.values, heights, "o", **look)
    look = {"mec": drawn.colour, "mfc": "white", "ms": 6.5, "mew": 1.6, "zorder": 4}
    look["gid"] = f"{drawn.name}, bifurcations"
    axes.plot(line.values[line.marks], heights[line.marks], "D", **look)
    for value in line.values[line.marks]:
        axes.axvline(value, color=drawn.colour, lw=0.7, alpha=0.5, zorder=1)


def draw_parts(
    axes: Axes, drawn: NamedBranch, heights: Array, styles: Mapping[bool, tuple[float, Any]]
) -> None:
    """Draw the stable and unstable parts of a quantity.

    Parameters
    ----------
    axes : Axes
        Axes of the parameter and the quantity.
    drawn : NamedBranch
        The branch, with k points.
    heights : ndarray of shape (k,)
        The quantity at the points of the line.
    styles : mapping of bool to (float, dashes)
        Width [points] and dashes of stable parts (True) and of unstable ones.
    """
    for part, stable in drawn.line.parts:
        width, dashes = styles[stable]
        look: Any = {"color": drawn.colour, "lw": width, "ls": dashes, "dash_capstyle": "butt"}
        look["gid"] = f"{drawn.name}, {'stable' if stable else 'unstable'}"
        axes.plot(drawn.line.values[part], heights[part], **look)
