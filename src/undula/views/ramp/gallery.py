"""Gallery of shapes: one cell for each of some steps, with the shapes over one another."""

from collections.abc import Sequence
from itertools import groupby
from textwrap import wrap
from typing import Any, NamedTuple

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse
from numpy.typing import NDArray

from undula.analysis.observables.shapes import transverse
from undula.views.common import style
from undula.views.run.scene import Floats

#: Largest number of links for which joints are drawn as dots.
FEW_LINKS = 12
# Elevation of the view above the ground [rad].
_ELEVATION = np.deg2rad(20.0)
_LEAST_HALF_WIDTH = 0.3
#: Distance between lines of words [inches].
LINE = 0.155
# Upper estimate of the width of a letter [inches].
_LETTER = 0.062


class Cell(NamedTuple):
    """A cell: shapes (k, N + 1, 3) in the order of time, lines of words below, and their colour."""

    shapes: Floats
    words: tuple[str, ...]
    colour: str


class View(NamedTuple):
    """Common frame of all cells of a figure: half of the width, lowest and highest end [L]."""

    half: float
    low: float
    high: float

    @property
    def aspect(self) -> float:
        """Height over width of a cell."""
        return (self.high - self.low) / (2.0 * self.half)


def chosen_steps(
    values: Floats, verdicts: Sequence[str], back: NDArray[np.bool_], count: int
) -> list[int]:
    """Choose steps for a gallery: one of each regime, the others far from one another.

    Steps on the way back are chosen only if their verdict differs from that on the way there.

    Parameters
    ----------
    values : ndarray of shape (m,)
        Values of the parameter, m at least 1.
    verdicts : sequence of str
        Verdict of each step.
    back : ndarray of shape (m,)
        True for steps on the way back.
    count : int
        Largest number of steps, exceeded only to show every verdict.

    Returns
    -------
    list of int
        Indices of the steps in their order.
    """
    there = {values[k]: verdicts[k] for k in range(back.size) if not back[k]}
    new = np.array([not back[k] or there.get(values[k]) != verdicts[k] for k in range(back.size)])
    chosen = _one_of_each(verdicts, new, count)
    # Distances are along the ramp, since steps there and back at one value are different.
    places = np.append(0.0, np.cumsum(np.abs(np.diff(values))))
    while len(chosen) < min(count, int(new.sum())):
        distance = np.abs(places[:, None] - places[chosen]).min(axis=1)
        distance[chosen], distance[~new] = -1.0, -1.0
        chosen.append(int(np.argmax(distance)))
    return sorted(chosen)


def seen_from_aside(shapes: Floats) -> Floats:
    """Project shapes (..., 3) onto a view slightly from above, across the plane of motion.

    Returns
    -------
    ndarray of shape (..., 2)
        Coordinates to the right and upwards [L].
    """
    sides = transverse(shapes)
    # The principal axis of the motion is half the argument of the sum of squares.
    turned = sides * np.exp(-0.5j * np.angle(np.sum(sides**2)))
    upwards = np.cos(_ELEVATION) * shapes[..., 2] + np.sin(_ELEVATION) * turned.imag
    return np.stack([turned.real, upwards], axis=-1)


def words_below(value: str, verdict: str, width: float) -> tuple[str, ...]:
    """Return lines of words: the value, and the verdict wrapped to a width in inches.

    Parameters
    ----------
    value
        The first line.
    verdict
        The verdict.
    width
        Width of the lines [inches].
    """
    return (value, *wrap(verdict, max(1, int(width / _LETTER))))


def common_view(cells: Sequence[Cell]) -> View:
    """Return the frame that contains the shapes of all cells and the ground."""
    seen = np.concatenate([seen_from_aside(cell.shapes).reshape(-1, 2) for cell in cells])
    half = max(_LEAST_HALF_WIDTH, 1.08 * float(np.abs(seen[:, 0]).max()))
    depth = np.sin(_ELEVATION) * half
    low = min(-depth, float(seen[:, 1].min()))
    return View(half, low - 0.03, max(depth, float(seen[:, 1].max())) + 0.03)


def draw_cell(figure: Figure, cell: Cell, view: View, place: tuple[float, float, float]) -> None:
    """Draw a cell; `place` is its left edge, bottom and width in fractions of the figure.

    Parameters
    ----------
    figure
        The figure.
    cell
        The cell.
    view
        Common frame of all cells.
    place
        Left edge, bottom and width in fractions of the figure.
    """
    left, bottom, width = place
    height = width * view.aspect * figure.get_figwidth() / figure.get_figheight()
    axes = figure.add_axes((left, bottom, width, height), gid="cell")
    axes.set(xlim=(-view.half, view.half), ylim=(view.low, view.high))
    axes.set_axis_off()
    flat = cell.shapes * [1.0, 1.0, 0.0]
    ground: Any = {"facecolor": style.GROUND, "edgecolor": "#dddddd", "lw": 0.6, "zorder": 0}
    depth = np.sin(_ELEVATION)
    axes.add_patch(Ellipse((0.0, 0.0), 2.0 * view.half, 2.0 * view.half * depth, **ground))
    seen, shadow = seen_from_aside(cell.shapes), seen_from_aside(flat)
    axes.add_collection(LineCollection(list(shadow), colors=style.SHADOW, lw=0.5, alpha=0.5))
    colours: NDArray[Any] = style.shape_colours(len(seen))
    widths = np.append(np.full(len(seen) - 1, 0.8), 1.8)
    lines = LineCollection(list(seen), colors=list(colours), linewidths=widths, zorder=3)
    lines.set_capstyle("round")
    axes.add_collection(lines)
    if cell.shapes.shape[1] <= FEW_LINKS + 1:
        axes.plot(*seen[-1].T, "o", ms=2.8, color=colours[-1], zorder=4)
    axes.plot([0.0], [0.0], "s", ms=3.2, color=style.INK, zorder=5)
    below: Any = {"ha": "center", "fontsize": 8.5, "color": cell.colour, "gid": "cell words"}
    for number, words in enumerate(cell.words, start=1):
        # Separate texts keep their line spacing for letters with descenders.
        foot = bottom - number * LINE / figure.get_figheight()
        figure.text(left + 0.5 * width, foot, words, **below)


def _one_of_each(verdicts: Sequence[str], new: NDArray[np.bool_], count: int) -> list[int]:
    """Return the middle steps of regimes; the longest regime of each verdict comes first."""
    places = np.flatnonzero(new).tolist()
    rows = [list(row) for _, row in groupby(places, key=lambda k: verdicts[k])]
    rows.sort(key=len, reverse=True)
    first = {verdicts[row[0]]: row for row in reversed(rows)}
    others = [row for row in rows if first[verdicts[row[0]]] is not row]
    selected = [*first.values(), *others[: max(0, count - len(first))]]
    return [row[(len(row) - 1) // 2] for row in selected]
