"""Legends in the fewest rows that fit the width of a figure."""

from collections.abc import Sequence
from typing import Any

from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.legend import Legend

#: Right end of a legend in fractions of the figure's width.
_INSIDE = 0.985
#: Spacing of a legend with several rows, in the room that figures leave for one row.
_CLOSE: dict[str, Any] = {"labelspacing": 0.2, "borderpad": 0.2, "borderaxespad": 0.1}


def fitting_legend(
    figure: Figure, handles: Sequence[Artist], corner: tuple[float, float], **look: Any
) -> Legend:
    """Add a legend that fits into the figure.

    Parameters
    ----------
    figure : Figure
        The figure.
    handles : sequence of artist
        At least one handle, each with its label.
    corner : tuple of float
        Upper left corner in fractions of the figure.
    **look
        Further arguments of `Figure.legend`.

    Returns
    -------
    Legend
        The legend, in as few rows as fit.
    """
    place: Any = {"loc": "upper left", "bbox_to_anchor": corner} | look
    for rows in range(1, len(handles) + 1):
        columns = -(-len(handles) // rows)
        close = _CLOSE if rows > 1 else {}
        legend = figure.legend(handles=list(handles), ncols=columns, **close | place)
        if columns == 1 or legend.get_window_extent().x1 <= _INSIDE * figure.bbox.width:
            break
        legend.remove()
    return legend
