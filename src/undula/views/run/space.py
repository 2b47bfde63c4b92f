"""Filament in space: axes of equal scale, shapes, and their shadow on the ground."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d import proj3d
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

from undula.views.common import style
from undula.views.run.scene import Floats

# Least half width of the ground [L].
_LEAST_HALF_WIDTH = 0.3


def space_axes(figure: Figure, place: tuple[float, float, float, float], points: Floats) -> Any:
    """Add three-dimensional axes of equal scale that contain all given points.

    Parameters
    ----------
    figure : Figure
        The figure.
    place : tuple of 4 floats
        Left, bottom, width and height in fractions of the figure; numbers and names of the axes
        lie slightly outside.
    points : ndarray of shape (..., 3)
        Points that have to be visible [L].

    Returns
    -------
    Axes3D
        The axes, with the ground drawn at z = 0 or at the lowest point, if it is below.
    """
    axes: Any = figure.add_axes((0, 0, 1, 1), projection="3d", computed_zorder=False)
    half = max(_LEAST_HALF_WIDTH, 1.08 * float(np.abs(points[..., :2]).max()))
    low = min(0.0, float(points[..., 2].min()))
    high = np.ceil(10 * max(float(points[..., 2].max()), low + half) - 1e-6) / 10
    axes.set(xlim=(-half, half), ylim=(-half, half), zlim=(low, high))
    axes.set_xlabel(r"$x$  $[L]$", labelpad=1)
    axes.set_ylabel(r"$y$  $[L]$", labelpad=1)
    axes.set_zlabel(r"$z$  $[L]$", labelpad=-2)
    axes.view_init(elev=24, azim=-58)
    _clean(axes, half)
    _ground(axes, half, low)
    corners = [(x, y, low) for x in (-half, half) for y in (-half, half)]
    _fit(axes, place, np.concatenate([points.reshape(-1, 3), corners, [(half, half, high)]]))
    return axes


def ground(axes: Any) -> float:
    """Return the height of the ground [L], which carries the shadows."""
    return float(axes.get_zlim()[0])


def draw_shapes(axes: Any, shapes: Floats) -> None:
    """Draw shapes (k, n, 3) in the order of time, the last one bold, each with its shadow.

    The group identity of each shape is "shape", that of each shadow "shadow".

    Parameters
    ----------
    axes
        Axes of `space_axes`.
    shapes
        Shapes in the order of time [L], shape (k, n, 3).
    """
    floor = ground(axes)
    shadow = {"color": style.SHADOW, "lw": 0.8, "alpha": 0.55, "zorder": 2, "gid": "shadow"}
    for shape in shapes:
        axes.plot(shape[:, 0], shape[:, 1], floor, **shadow)
    for place, (shape, colour) in enumerate(
        zip(shapes, style.shape_colours(len(shapes)), strict=True)
    ):
        last = place == len(shapes) - 1
        axes.plot(*shape.T, color=colour, lw=2.8 if last else 1.1, zorder=5 + last, gid="shape")
    tip = shapes[-1, -1]
    axes.plot(*tip[:, None], "o", ms=5, color=style.shape_colours(1)[0], zorder=7)
    axes.plot([0], [0], [0], "s", ms=5, color=style.INK, zorder=7)


def draw_tip_path(axes: Any, path: Floats, *, joined: bool) -> None:
    """Draw the path of the tip (k, 3) and its shadow, as lines or as points.

    Parameters
    ----------
    axes
        Axes of `space_axes`.
    path
        Positions [L], shape (k, 3).
    joined
        If true, the path is a line, else points.
    """
    look = "-" if joined else "."
    axes.plot(path[:, 0], path[:, 1], ground(axes), look, color=style.QUIET, lw=0.9, ms=3, zorder=3)
    axes.plot(*path.T, look, color=style.Y_COLOUR, lw=1.0, ms=4, zorder=4, gid="tip path")


def fading_trail(axes: Any, pieces: int) -> Any:
    """Add an empty trail of line segments, the oldest ones nearly transparent.

    Parameters
    ----------
    axes
        Axes of `space_axes`.
    pieces
        Number of segments.
    """
    # Vermilion as the tip, `style.Y_COLOUR`.
    colours = np.tile(np.array([0.835, 0.369, 0.0, 1.0]), (pieces, 1))
    colours[:, 3] = np.linspace(0.03, 0.95, pieces)
    empty = np.zeros((pieces, 2, 3))
    trail = Line3DCollection(empty, colors=colours, linewidths=1.8, zorder=4)
    return axes.add_collection3d(trail, autolim=False)


def _fit(axes: Any, place: tuple[float, float, float, float], points: Floats) -> None:
    """Scale and move the axes so that the projected points just fill the place."""
    figure, zoom = axes.figure, 1.0
    left, bottom, width, height = place
    shape = figure.get_figheight() / figure.get_figwidth()
    spans = [np.ptp(limits) for limits in (axes.get_xlim(), axes.get_ylim(), axes.get_zlim())]
    axes.set_position((0.0, 0.0, shape, 1.0))
    # With perspective the size is not proportional to the zoom; after three iterations the error is
    # below a pixel.
    for _ in range(3):
        axes.set_box_aspect(spans, zoom=zoom)
        low, high = _seen(axes, points)
        zoom *= min(width / (high[0] - low[0]), height / (high[1] - low[1]))
    middle = (low + high) / 2
    axes.set_position((left + width / 2 - middle[0], bottom + height / 2 - middle[1], shape, 1.0))


def _seen(axes: Any, points: Floats) -> tuple[Floats, Floats]:
    """Return lower left and upper right corner of projected points in fractions of the figure."""
    flat = proj3d.proj_transform(*points.T, axes.get_proj())[:2]
    to_figure = axes.transData - axes.figure.transFigure
    seen = to_figure.transform(np.column_stack(flat))
    return seen.min(axis=0), seen.max(axis=0)


def _clean(axes: Any, half: float) -> None:
    """Reduce the axes to three thin lines with few ticks, without panes and grid."""
    axes.grid(visible=False)
    axes.patch.set_alpha(0.0)
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        axis.pane.set_visible(False)
        axis.line.set_color(style.SHADOW)
        axis.set_tick_params(pad=-1, labelsize=7.5)
    # The ticks lie well inside, since the numbers of two axes would overlap at a corner.
    mark = float(f"{0.65 * half:.0e}")
    axes.set_xticks([-mark, 0, mark])
    axes.set_yticks([-mark, 0, mark])
    axes.zaxis.set_major_locator(MaxNLocator(3, steps=[1, 2, 5, 10]))


def _ground(axes: Any, half: float, low: float) -> None:
    corners = [(-half, -half, low), (half, -half, low), (half, half, low), (-half, half, low)]
    face = Poly3DCollection([corners], facecolor=style.GROUND, edgecolor="#dddddd", lw=0.6)
    face.set_zorder(0)
    axes.add_collection3d(face, autolim=False)
    for across in ([(-half, 0), (half, 0)], [(0, -half), (0, half)]):
        xs, ys = zip(*across, strict=True)
        axes.plot(xs, ys, low, color="#dddddd", lw=0.6, zorder=1)
