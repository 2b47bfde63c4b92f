"""Paths of the mean position at the points of a sweep, seen from above.

After the phase diagram of Ling, Guo & Kanso (2018), where shades of grey represent time.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.transforms import Affine2D

from undula.arrays import Array
from undula.errors import InputError
from undula.views.common import style
from undula.views.common.renamed_keyword import renamed_keyword
from undula.views.sweep.axes import (
    Border,
    diagram_on,
    draw_borders,
    place_legend,
    steps_in_points,
)
from undula.views.sweep.points import (
    Dot,
    check_shapes,
    diagram_axes,
    dots_of,
    even_selection,
    heading,
)

_SIZE = (10.0, 7.0)
_LEFT, _RIGHT, _BOTTOM = 0.085, 0.975, 0.085
# Largest number of paths to the right and upwards.
_ACROSS, _UP = 14, 10
# Width of the widest path over the distance of paths.
_FILLED = 0.86
# Largest distance from the axis of a mean position that is drawn as a dot [L].
_AT_REST = 1e-3
# Grey of the first and the last instant.
_PALE, _DARK = 0.82, 0.05


@renamed_keyword("borders", "boundaries")
def mean_paths(
    store: xr.Dataset, boundaries: Sequence[Border] = (), *, title: str | None = None
) -> Figure:
    """Draw the path of the mean position over some periods, seen from above, at many points.

    Parameters
    ----------
    store : xarray.Dataset
        A stored sweep with last periods that varies two axes. Of many points an even selection is
        drawn, of several replicates the first.
    boundaries : sequence of (str, ndarray, ndarray)
        As for `phase_diagram`.
    title : str, optional
        Title of the figure; by default the load, and the values of axes that do not vary.

    Returns
    -------
    matplotlib.figure.Figure
        10 by 7 inches, not registered with pyplot. All paths have one scale, which a bar shows.

    Raises
    ------
    InputError
        The dataset is not a stored sweep, does not vary two axes, or has no last periods.

    Examples
    --------
    >>> import undula
    >>> from undula.views import mean_paths
    >>> stored = undula.load("results/point-loads.zarr")
    >>> mean_paths(stored).savefig("paths.png")
    """
    check_shapes(store)
    x, y = diagram_axes(store)
    if y is None:
        raise InputError(f"the store varies {x} only; paths are laid out over two axes")
    drawn = store.sel(
        {x: even_selection(store[x].values, _ACROSS), y: even_selection(store[y].values, _UP)}
    )
    paths = [(dot, _path(drawn, dot)) for dot in dots_of(drawn) if dot.verdict and dot.place == 0]
    shown = [(dot, path) for dot, path in paths if path is not None]
    if not shown:
        raise InputError("no point of the store has kept its path yet; let the sweep go on")
    with style.figure_style(store):
        figure = Figure(figsize=_SIZE)
        style.write_title(figure, heading(store) if title is None else title, (0.022, 0.962))
        axes = diagram_on(figure, drawn, (x, y), (_LEFT, _BOTTOM, _RIGHT - _LEFT, 0.8))
        top = place_legend(figure, [draw_borders(axes, boundaries)], _LEFT, 0.905) - 0.01
        axes.set_position((_LEFT, _BOTTOM, _RIGHT - _LEFT, top - _BOTTOM))
        widest = max(float(np.abs(path).max()) for _, path in shown)
        scale = 0.5 * _FILLED * min(steps_in_points(axes, drawn, (x, y))) / max(widest, _AT_REST)
        for dot, path in shown:
            _draw(axes, dot, path, scale)
        _draw_key(figure, scale)
    return figure


def _path(store: xr.Dataset, dot: Dot) -> Array | None:
    """Return the path (k, 2) of the mean position; None if it is not stored."""
    stored = store["path"].isel(dict(dot.index)).transpose("instant", "axis")
    path = np.asarray(stored.values)[:, :2]
    return path if np.isfinite(path).all() else None


def _draw(axes: Axes, dot: Dot, path: Array, scale: float) -> None:
    """Draw a path around its point, with a scale in points of type per L."""
    if np.abs(path).max() < _AT_REST:
        axes.plot([dot.x], [dot.y], ".", color=style.QUIET, ms=4, zorder=3, gid="mean path")
        return
    pieces = np.stack([path[:-1], path[1:]], axis=1)
    shades = np.linspace(_PALE, _DARK, len(pieces))
    look: Any = {
        "colors": [(shade, shade, shade) for shade in shades],
        "linewidths": 1.3,
        "capstyle": "round",
        "offsets": [(dot.x, dot.y)],
        "offset_transform": axes.transData,
        "transform": Affine2D().scale(scale / 72.0) + axes.figure.dpi_scale_trans,
        "zorder": 3,
        "gid": "mean path",
    }
    lines = LineCollection(list(pieces), **look)
    # Paths at the edge extend beyond the axes.
    lines.set_clip_on(False)
    axes.add_collection(lines, autolim=False)


def _draw_key(figure: Figure, scale: float) -> None:
    """Draw a bar of a round length, and a key of the shades, in the upper right corner."""
    # The length is the largest of 1, 2 and 5 times a power of ten that fits into 42 points of type.
    longest = 42.0 / scale
    power = 10.0 ** np.floor(np.log10(longest))
    length = max(step * power for step in (1.0, 2.0, 5.0) if step * power <= longest)
    axes = figure.add_axes((0.6, 0.915, 0.375, 0.035))
    axes.set_axis_off()
    axes.set(xlim=(0.0, 0.375 * _SIZE[0] * 72.0), ylim=(-1.0, 1.0))
    axes.plot([4.0, 4.0 + scale * length], [0.0, 0.0], color=style.INK, lw=1.6, gid="scale")
    words: Any = {"va": "center", "fontsize": 8.5}
    axes.text(10.0 + scale * length, 0.0, rf"{length:g} $L$", **words)
    axes.text(118.0, 0.0, "earlier", color=style.QUIET, ha="right", **words)
    ends = np.linspace(122.0, 172.0, 26)
    pieces = [[(left, 0.0), (right, 0.0)] for left, right in pairwise(ends)]
    greys = [(shade,) * 3 for shade in np.linspace(_PALE, _DARK, 25)]
    shades = LineCollection(pieces, colors=greys, linewidths=2.4, capstyle="projecting")
    axes.add_collection(shades)
    axes.text(176.0, 0.0, "later", color=style.QUIET, **words)
