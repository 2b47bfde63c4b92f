"""Spinning and flapping branches in panels over the force: their lines and their bifurcations."""

from collections.abc import Mapping
from typing import Any

from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from undula.analysis.parameters import FORCE
from undula.analysis.states.branch import Bifurcation
from undula.analysis.states.branch_json import read_branch
from undula.arrays import Array
from undula.views.branches.named_branches import NamedBranch, draw_parts
from undula.views.branches.smooth_lines import smooth_line
from undula.views.common import style
from undula.views.common.labels import Label
from undula.views.common.verdict_styles import look_of

#: Colour and name of each kind of state.
STRAIGHT, SPINNING, FLAPPING = (
    (look_of(verdict).colour, verdict) for verdict in ("straight", "spinning", "planar flapping")
)
#: Width [points] and dashes of stable and of unstable parts.
_PARTS: Mapping[bool, tuple[float, Any]] = {True: (2.1, "-"), False: (1.2, (0, (3.6, 2.0)))}

Pair = tuple[NamedBranch, NamedBranch]


def read_pair(spinning: Mapping[str, Any], flapping: Mapping[str, Any]) -> Pair:
    """Return the branches of spinning and flapping that two answers hold.

    Parameters
    ----------
    spinning, flapping : mapping
        Answers of `undula follow --json` along the force.

    Returns
    -------
    tuple of NamedBranch
        As smooth lines.

    Raises
    ------
    InputError
        An answer has fewer than two states, or they are along another parameter.
    """
    branches = read_branch(spinning, FORCE), read_branch(flapping, FORCE)
    first, second = (
        NamedBranch(name, colour, branch, smooth_line(branch))
        for (colour, name), branch in zip((SPINNING, FLAPPING), branches, strict=True)
    )
    return first, second


def last_force(pair: Pair) -> float:
    """Return the greatest force of two branches."""
    return max(float(branch.line.values.max()) for branch in pair)


def draw_branch(axes: Axes, branch: NamedBranch, heights: Array) -> None:
    """Draw a quantity of a branch, in its colour and with its name."""
    draw_parts(axes, branch, heights, _PARTS)


def branch_handles(pair: Pair) -> list[Line2D]:
    """Return the legend's handles of spinning, flapping and, if there are any, unstable parts."""
    handles = [
        Line2D([], [], color=branch.colour, lw=_PARTS[True][0], label=branch.name)
        for branch in pair
    ]
    if not all(branch.stable_throughout for branch in pair):
        width, dashes = _PARTS[False]
        look: Any = {"color": style.QUIET, "lw": width, "ls": dashes, "label": "unstable"}
        handles.append(Line2D([], [], **look))
    return handles


def force_labels(pair: Pair, span: tuple[float, float], edges: tuple[float, float]) -> list[Label]:
    """Return names and forces of the bifurcations within a span, for a panel between two edges."""
    scale = (edges[1] - edges[0]) / (span[1] - span[0])
    return [
        Label(
            edges[0] + scale * (bifurcation.value - span[0]),
            f"{branch.name.split()[-1]} {_event(bifurcation)}\n{bifurcation.value:#.4g}",
            branch.colour,
        )
        for branch in pair
        for bifurcation in branch.branch.bifurcations
        if span[0] <= bifurcation.value <= span[1]
    ]


def _event(bifurcation: Bifurcation[Any]) -> str:
    """Return the change of stability at a bifurcation; without a change, its kind."""
    unchanged = bifurcation.stability == "unchanged"
    return bifurcation.kind if unchanged else bifurcation.stability


def draw_forces(axes: Axes, pair: Pair) -> None:
    """Draw a thin line at the force of each bifurcation."""
    for branch in pair:
        for bifurcation in branch.branch.bifurcations:
            look: Any = {"color": branch.colour, "lw": 0.8, "alpha": 0.6, "zorder": 1}
            axes.axvline(bifurcation.value, gid=f"{branch.name}, bifurcation", **look)
