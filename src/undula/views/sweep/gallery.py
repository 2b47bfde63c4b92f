"""Gallery of a sweep: shapes over a period at some points, arranged as in its diagram.

After the gallery of oscillations of Ling, Guo & Kanso (2018).
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from undula.errors import InputError
from undula.views.common import style
from undula.views.common.verdict_styles import look_of
from undula.views.ramp.gallery import LINE, Cell, common_view, draw_cell, words_below
from undula.views.sweep.points import (
    Dot,
    axis_label,
    check_shapes,
    diagram_axes,
    dots_of,
    even_selection,
    heading,
    stored_shapes,
    units_of,
)

_WIDTH, _HEIGHT = 10.0, 7.0
# Edges of the cells in fractions of the figure; the numbers of the axes lie outside.
_LEFT, _RIGHT, _BOTTOM, _TOP = 0.11, 0.985, 0.1, 0.935
# Largest number of cells to the right and upwards.
_ACROSS, _UP = 8, 5
# Size of a cell over the distance of cells.
_FILLED = 0.95


class _Place(NamedTuple):
    """A dot, its column and row from the lower left, and a value in words above the verdict."""

    dot: Dot
    column: int
    row: int
    value: str = ""


def gallery(store: xr.Dataset, *, title: str | None = None) -> Figure:
    """Draw the stored shapes of points of a sweep, one cell for each point.

    Parameters
    ----------
    store : xarray.Dataset
        A stored sweep with shapes that varies one or two axes. Of many points an even selection is
        drawn, of several replicates the first.
    title : str, optional
        Title of the figure; by default the load, and the values of axes that do not vary.

    Returns
    -------
    matplotlib.figure.Figure
        10 by 7 inches, not registered with pyplot. Cells are in the order of their values, not to
        scale.

    Raises
    ------
    InputError
        The dataset is not a stored sweep, varies more than two axes, or has no shapes.

    Examples
    --------
    >>> import undula
    >>> from undula.views import gallery
    >>> stored = undula.load("results/point-loads.zarr")
    >>> gallery(stored).savefig("gallery.png")
    """
    check_shapes(store)
    dots = [dot for dot in dots_of(store) if dot.verdict and dot.place == 0]
    dots = [dot for dot in dots if stored_shapes(store, dot.index) is not None]
    if not dots:
        raise InputError("no point of the store has kept shapes yet; let the sweep go on")
    x, y = diagram_axes(store)
    across = even_selection(store[x].values, _ACROSS if y else _ACROSS * _UP)
    up = [0.0] if y is None else even_selection(store[y].values, _UP)
    with style.figure_style(store):
        figure = Figure(figsize=(_WIDTH, _HEIGHT))
        style.write_title(figure, heading(store) if title is None else title, (0.022, 0.962))
        if y is None:
            size = _size_of_rows(len(across))
            _draw_cells(figure, store, _in_rows(dots, across, size), size)
        else:
            places = [
                _Place(dot, across.index(dot.x), up.index(dot.y))
                for dot in dots
                if dot.x in across and dot.y in up
            ]
            size = len(across), len(up)
            _draw_cells(figure, store, places, size)
            _name_places(figure, across, up)
            label = axis_label(y, units_of(store))
            figure.text(0.02, 0.5 * (_BOTTOM + _TOP), label, rotation=90, va="center")
        label = axis_label(x, units_of(store))
        figure.text(0.5 * (_LEFT + _RIGHT), 0.025, label, ha="center")
    return figure


def _size_of_rows(count: int) -> tuple[int, int]:
    """Return the numbers of columns and rows for which `count` cells are largest."""
    room = (_RIGHT - _LEFT) * _WIDTH, (_TOP - _BOTTOM) * _HEIGHT
    sizes = [(columns, -(-count // columns)) for columns in range(1, _ACROSS + 1)]
    # With its words, a cell is about as high as wide.
    return max(sizes, key=lambda size: min(room[0] / size[0], room[1] / size[1]))


def _in_rows(dots: Sequence[Dot], across: list[float], size: tuple[int, int]) -> list[_Place]:
    """Return the places of the points of one axis, row by row from above."""
    places = []
    for dot in dots:
        if dot.x in across:
            below, column = divmod(across.index(dot.x), size[0])
            places.append(_Place(dot, column, size[1] - below - 1, f"{dot.x:.4g}"))
    return places


def _draw_cells(
    figure: Figure, store: xr.Dataset, places: Sequence[_Place], size: tuple[int, int]
) -> None:
    pitch = (_RIGHT - _LEFT) / size[0], (_TOP - _BOTTOM) / size[1]
    cells = [_cell(store, place, pitch[0] * _WIDTH) for place in places]
    view = common_view(cells)
    words = LINE * max(len(cell.words) for cell in cells)
    room = _FILLED * pitch[1] * _HEIGHT - words
    width = min(_FILLED * pitch[0] * _WIDTH, room / view.aspect)
    for place, cell in zip(places, cells, strict=True):
        left = _LEFT + (place.column + 0.5) * pitch[0] - 0.5 * width / _WIDTH
        spare = _FILLED * pitch[1] * _HEIGHT - words - width * view.aspect
        foot = _BOTTOM + place.row * pitch[1] + (words + 0.5 * spare) / _HEIGHT
        draw_cell(figure, cell, view, (left, foot, width / _WIDTH))


def _cell(store: xr.Dataset, place: _Place, inches: float) -> Cell:
    verdict = place.dot.verdict
    words = words_below(place.value, verdict, inches)
    shapes = stored_shapes(store, place.dot.index)
    return Cell(shapes, words if place.value else words[1:], look_of(verdict).colour)


def _name_places(figure: Figure, across: Sequence[float], up: Sequence[float]) -> None:
    """Write the values of the columns below and of the rows to the left."""
    rights = np.linspace(_LEFT, _RIGHT, 2 * len(across) + 1)[1::2]
    for value, place in zip(across, rights, strict=True):
        figure.text(place, 0.067, f"{value:.4g}", ha="center", color=style.QUIET)
    heights = np.linspace(_BOTTOM, _TOP, 2 * len(up) + 1)[1::2]
    for value, place in zip(up, heights, strict=True):
        figure.text(
            _LEFT - 0.015, place, f"{value:.4g}", ha="right", va="center", color=style.QUIET
        )
