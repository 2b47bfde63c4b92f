"""Panels of figures without a title: their letters, and a legend above them."""

from collections.abc import Sequence

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from undula.views.common import style
from undula.views.common.legends import fitting_legend

# Distances of a letter from the left edge and the top of its panel [inches].
_LETTER_OFFSET, _ABOVE = 0.5, 0.09


def letter(figure: Figure, place: tuple[float, float], which: str) -> None:
    """Write a letter in brackets; `place` is its lower left corner in fractions of the figure.

    Parameters
    ----------
    figure
        The figure.
    place
        Lower left corner in fractions of the figure.
    which
        The letter.
    """
    figure.text(*place, f"({which})", fontsize=10.5, fontweight="bold", gid="letter")


def letter_axes(figure: Figure, axes: Axes, which: str, aside: float = _LETTER_OFFSET) -> None:
    """Write the letter of a panel above its upper left corner, `aside` inches to the left.

    Parameters
    ----------
    figure
        The figure.
    axes
        Axes of the panel.
    which
        The letter.
    aside
        Distance from the left edge of the panel [inches].
    """
    box = axes.get_position()
    width, height = figure.get_size_inches()
    letter(figure, (box.x0 - aside / width, box.y1 + _ABOVE / height), which)


def legend_above(figure: Figure, handles: Sequence[Artist], left: float) -> float:
    """Add a legend along the upper edge of a figure, in the fewest rows that fit.

    Parameters
    ----------
    figure
        The figure.
    handles
        Handles of the legend, at least one.
    left
        Left edge of the panels in fractions of the figure.

    Returns
    -------
    float
        Lower end of the legend in fractions of the figure's height.
    """
    legend = fitting_legend(figure, handles, (left - 0.01, 0.995), handlelength=2.6)
    return float(legend.get_window_extent().y0 / figure.bbox.height)


def quiet_line(axes: Axes, height: float = 0.0) -> None:
    """Draw a thin horizontal line, by default at zero, behind all other lines.

    Parameters
    ----------
    axes
        Axes of the panel.
    height
        Height of the line on the y axis.
    """
    axes.axhline(height, color=style.QUIET, lw=0.7, zorder=0)
