"""Panels of figures without a title: their letters, and the legend above them."""

from collections.abc import Sequence

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from undula.views.common import style
from undula.views.common.legends import fitting_legend

# Inches: from the left edge of a panel and from its top to its letter.
_ASIDE, _ABOVE = 0.5, 0.09


def letter(figure: Figure, place: tuple[float, float], which: str) -> None:
    """Write a letter in brackets, its lower left corner at a place in parts of the figure."""
    figure.text(*place, f"({which})", fontsize=10.5, fontweight="bold", gid="letter")


def letter_axes(figure: Figure, axes: Axes, which: str, aside: float = _ASIDE) -> None:
    """Write the letter of a panel above its upper left corner, so many inches aside."""
    box = axes.get_position()
    width, height = figure.get_size_inches()
    letter(figure, (box.x0 - aside / width, box.y1 + _ABOVE / height), which)


def legend_above(figure: Figure, handles: Sequence[Artist], left: float) -> float:
    """Name lines along the upper edge of a figure, in as few rows as hold them.

    Returns
    -------
    float
        Where the names end below, in parts of the figure's height.
    """
    legend = fitting_legend(figure, handles, (left - 0.01, 0.995), handlelength=2.6)
    return float(legend.get_window_extent().y0 / figure.bbox.height)


def quiet_line(axes: Axes, height: float = 0.0) -> None:
    """Draw the line of zero, or another level, thin and behind everything."""
    axes.axhline(height, color=style.QUIET, lw=0.7, zorder=0)
