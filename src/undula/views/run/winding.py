"""Winding of motions about the axis: shapes, and angle and height of the tip, side by side.

After the last figure of Ling, Guo & Kanso (2018).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from undula.analysis.observables.shapes import tip_height
from undula.errors import InputError
from undula.views.common import style
from undula.views.run.scene import Floats
from undula.views.run.space import draw_shapes, space_axes

_LEFT, _COLUMN, _RIGHT, _HEIGHT = 0.5, 3.1, 0.25, 6.4
_SHAPES = 24
# Bottom and height of the panels of a column in fractions of the figure: height, angle, shapes.
_LOWER, _MIDDLE, _UPPER = (0.085, 0.17), (0.315, 0.17), (0.53, 0.40)


@dataclass(frozen=True)
class TipAngleSeries:
    """A motion in the figure of winding.

    Attributes
    ----------
    title : str
        Title of its column.
    time : ndarray, shape (m,)
        Instants [T], rising.
    nodes : ndarray, shape (m, N + 1, 3)
        Positions of the nodes [L]; the tip turns by less than half a turn between instants.
    shown : float
        Length of the last part of the motion whose shapes are drawn [T].

    Examples
    --------
    >>> import numpy as np
    >>> from undula.views import TipAngleSeries
    >>> time = np.linspace(0.0, 1.0, 50)
    >>> angle = 2.0 * np.pi * time[:, None] * np.ones(5)
    >>> s = np.linspace(0.0, 1.0, 5)
    >>> x, y, z = 0.5 * s * np.cos(angle), 0.5 * s * np.sin(angle), 0.8 * s + 0.0 * angle
    >>> nodes = np.stack([x, y, z], axis=-1)
    >>> motion = TipAngleSeries("one turn", time, nodes, shown=0.5)
    """

    title: str
    time: Floats
    nodes: Floats
    shown: float


def winding_figure(motions: Sequence[TipAngleSeries]) -> Figure:
    """Draw motions side by side: shapes of the last part, angle of the tip about z, and its height.

    Parameters
    ----------
    motions : sequence of TipAngleSeries
        At least one motion.

    Returns
    -------
    matplotlib.figure.Figure
        Not registered with pyplot. The interval of the shapes is shaded.

    Raises
    ------
    InputError
        No motion is given.

    Examples
    --------
    >>> import numpy as np
    >>> from undula.views import TipAngleSeries, winding_figure
    >>> time = np.linspace(0.0, 1.0, 50)
    >>> angle = 2.0 * np.pi * time[:, None] * np.ones(5)
    >>> s = np.linspace(0.0, 1.0, 5)
    >>> x, y, z = 0.5 * s * np.cos(angle), 0.5 * s * np.sin(angle), 0.8 * s + 0.0 * angle
    >>> nodes = np.stack([x, y, z], axis=-1)
    >>> figure = winding_figure([TipAngleSeries("one turn", time, nodes, shown=0.5)])
    """
    if not motions:
        raise InputError("there are no motions to be drawn; give at least one")
    with style.figure_style():
        figure = Figure(figsize=(_LEFT + _COLUMN * len(motions) + _RIGHT, _HEIGHT))
        left, width = _LEFT / figure.get_figwidth(), _COLUMN / figure.get_figwidth()
        for k, motion in enumerate(motions):
            _draw_column(figure, motion, left + k * width, width, first=k == 0)
    return figure


def _draw_column(
    figure: Figure, motion: TipAngleSeries, left: float, width: float, *, first: bool
) -> None:
    figure.text(left + 0.5 * width, 0.965, motion.title, ha="center", fontsize=10.5)
    start = motion.time[-1] - motion.shown
    late = np.flatnonzero(motion.time >= start)
    selected = late[np.linspace(0, len(late) - 1, min(_SHAPES, len(late))).astype(int)]
    space = space_axes(figure, (left, _UPPER[0], 0.96 * width, _UPPER[1]), motion.nodes[late])
    draw_shapes(space, motion.nodes[selected])
    tip = motion.nodes[:, -1]
    angle = np.unwrap(np.arctan2(tip[:, 1], tip[:, 0]))
    rows = (
        (_MIDDLE, angle - angle[0], r"tip angle $\theta$  [rad]"),
        (_LOWER, tip_height(motion.nodes), r"tip height $z$  $[L]$"),
    )
    for (low, high), values, name in rows:
        axes = figure.add_axes((left + 0.2 * width, low, 0.72 * width, high))
        axes.axvspan(start, motion.time[-1], color=style.FOCUS, lw=0.0)
        axes.plot(motion.time, values, color=style.INK, lw=0.8, gid="trace")
        axes.set_xlim(motion.time[0], motion.time[-1])
        if first:
            axes.set_ylabel(name)
        if low == _LOWER[0]:
            axes.set_xlabel(style.SHORT_TIME_LABEL)
        else:
            axes.tick_params(labelbottom=False)
