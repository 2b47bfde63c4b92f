"""Figures of solved states and of their branches."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from undula.analysis.states.branch import Branch
from undula.analysis.states.state import State
from undula.views.branches.bifurcation import bifurcation_diagram
from undula.views.common import style

# Number of shapes that are drawn over a period.
_SHAPES = 16
#: Kinds of states that the bifurcation diagram draws.
_MOVING = ("spinning", "flapping")


def state_figure(state: State, ax: Axes | None) -> Figure | Axes:
    """Draw the shapes of a state over a period, seen from the side.

    Parameters
    ----------
    state : State
        Any solved state.
    ax : matplotlib Axes or None
        Axes to draw into; a new figure without them.

    Returns
    -------
    matplotlib Figure or Axes
    """
    if ax is None:
        with style.figure_style():
            figure = Figure(figsize=(4.2, 4.0), layout="constrained")
            state_figure(state, figure.add_subplot())
        return figure
    shapes = _shapes(state)
    for colour, nodes in zip(style.shape_colours(len(shapes)), shapes, strict=True):
        ax.plot(nodes[:, 0], nodes[:, 2], color=colour, lw=1.2)
    tips = np.array([nodes[-1] for nodes in shapes])
    ax.plot(tips[:, 0], tips[:, 2], ".", color="0.3", ms=3)
    ax.set_aspect("equal", adjustable="datalim")
    ax.set_xlabel("x / L")
    ax.set_ylabel("z / L")
    word = "stable" if state.stable else "unstable"
    ax.set_title(f"{state.kind}, {word}, {state.frequency:.4g} cycles per T", fontsize="medium")
    return ax


def branch_figure(branch: Branch[Any], ax: Axes | None) -> Figure | Axes:
    """Draw a branch: its diagram, or into given axes its frequency over the parameter.

    Stable parts are solid, unstable ones dashed; dots are bifurcations.

    Parameters
    ----------
    branch : Branch
        Any branch.
    ax : matplotlib Axes or None
        Axes to draw into; a new figure without them.

    Returns
    -------
    matplotlib Figure or Axes
    """
    if ax is None and branch.states[0].kind in _MOVING and len(branch) > 1:
        return bifurcation_diagram([branch], title=f"{branch.states[0].kind} states")
    if ax is None:
        with style.figure_style():
            figure = Figure(figsize=(6.0, 4.0), layout="constrained")
            branch_figure(branch, figure.add_subplot())
        return figure
    heights = np.array([_height(state) for state in branch])
    stable = np.array([state.stable for state in branch])
    for flag, line in ((True, "-"), (False, "--")):
        part = np.where(stable == flag, heights, np.nan)
        ax.plot(branch.values, part, line, color="C0", label="stable" if flag else "unstable")
    for point in branch.bifurcations:
        ax.plot(point.value, _height(point.state), "o", color="C3", ms=4)
    ax.set_xlabel(style.parameter_label(branch.parameter))
    moves = branch.states[0].frequency > 0.0
    ax.set_ylabel("frequency [cycles per T]" if moves else "tip radius [L]")
    return ax


def _height(state: State) -> float:
    return state.frequency if state.frequency > 0.0 else state.tip_radius.mean


def _shapes(state: State) -> list[Any]:
    """Return shapes (N + 1, 3) over a period; of a constant shape at its turns about the axis."""
    if not state.steady:
        every = max(1, len(state.nodes) // _SHAPES)
        return list(state.nodes[::every])
    if state.frequency == 0.0:
        return [state.nodes]
    shapes = []
    for angle in np.linspace(0.0, 2.0 * np.pi, _SHAPES, endpoint=False):
        c, s = np.cos(angle), np.sin(angle)
        shapes.append(state.nodes @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]))
    return shapes
