"""Legends in as few lines as the width of a figure allows."""

from collections.abc import Sequence
from typing import Any

from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.legend import Legend

#: Part of the figure's width that a legend may reach to.
_INSIDE = 0.985
#: Of lines of a legend, where one would do for most figures and has its room.
_CLOSE: dict[str, Any] = {"labelspacing": 0.2, "borderpad": 0.2, "borderaxespad": 0.1}


def fitting_legend(
    figure: Figure, handles: Sequence[Artist], corner: tuple[float, float], **look: Any
) -> Legend:
    """Add a legend that stays on the page.

    Parameters
    ----------
    figure : Figure
    handles : sequence of artist
        At least one, each with its label.
    corner : tuple of float
        Its upper left corner, in parts of the figure.
    **look
        As `Figure.legend` takes them.

    Returns
    -------
    Legend
        In one line if that fits, otherwise in as few as do.
    """
    place: Any = {"loc": "upper left", "bbox_to_anchor": corner} | look
    for lines in range(1, len(handles) + 1):
        columns = -(-len(handles) // lines)
        close = _CLOSE if lines > 1 else {}
        legend = figure.legend(handles=list(handles), ncols=columns, **close | place)
        if columns == 1 or legend.get_window_extent().x1 <= _INSIDE * figure.bbox.width:
            break
        legend.remove()
    return legend
