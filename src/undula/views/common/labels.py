"""Labels above a panel for places on its axis, shifted so that they do not overlap."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.text import Text

from undula.arrays import Array

# In fractions of the figure's height: top of the labels, and their distance from the panel.
_TOP, _LEADER = 0.875, 0.035
# In fractions of the figure's width: gap between labels, and their reach beyond the panel.
_GAP, _OVERHANG = 0.018, 0.02


class Label(NamedTuple):
    """A label: its place in fractions of the figure's width, its text, and its leader's colour."""

    place: float
    text: str
    colour: str


def label_above(figure: Figure, labels: Sequence[Label], left: float, right: float) -> float:
    """Write labels in a row, each with a leader from its place at the top of the panel.

    Labels that do not fit side by side are rotated by 90 degrees.

    Parameters
    ----------
    figure : Figure
        Figure with room for the labels below its legend.
    labels : sequence of Label
        The labels in any order.
    left, right : float
        Edges of the panel in fractions of the figure's width.

    Returns
    -------
    float
        Top of the panel in fractions of the figure's height.
    """
    if not labels:
        return _TOP
    ordered = sorted(labels, key=lambda label: label.place)
    bounds = left - _OVERHANG, right + _OVERHANG
    texts = [_write(figure, label.text) for label in ordered]
    if _sizes(figure, texts)[:, 0].sum() > bounds[1] - bounds[0]:
        for text in texts:
            text.set_rotation(90)
    sizes = _sizes(figure, texts)
    panel = _TOP - float(sizes[:, 1].max())
    places = spread(np.array([label.place for label in ordered]), sizes[:, 0], *bounds)
    for label, text, place in zip(ordered, texts, places, strict=True):
        text.set_position((place, panel + _LEADER))
        ends = [label.place, place], [panel, panel + 0.85 * _LEADER]
        figure.add_artist(Line2D(*ends, color=label.colour, lw=0.8))
    return panel


def spread(wanted: Array, widths: Array, left: float, right: float) -> Array:
    """Move centres of labels apart, in their order and within bounds.

    Parameters
    ----------
    wanted : ndarray of shape (m,)
        Best places of the centres, not decreasing.
    widths : ndarray of shape (m,)
        Widths of the labels; labels overlap if they are wider than the bounds.
    left, right : float
        Bounds of all labels.

    Returns
    -------
    ndarray of shape (m,)
        Centres of labels that do not overlap.
    """
    # The mean of two arrangements without overlap is one without overlap, and favours no side.
    rightwards = _pushed(wanted, widths, left, right)
    leftwards = -_pushed(-wanted[::-1], widths[::-1], -right, -left)[::-1]
    return 0.5 * (rightwards + leftwards)


def _pushed(wanted: Array, widths: Array, left: float, right: float) -> Array:
    """Shift centres to the right as far as needed, and back at the right bound."""
    centres = wanted.copy()
    edge = left
    for place, half in enumerate(0.5 * widths):
        centres[place] = max(centres[place], edge + half)
        edge = centres[place] + half
    edge = right
    for place, half in reversed([*enumerate(0.5 * widths)]):
        centres[place] = min(centres[place], edge - half)
        edge = centres[place] - half
    return centres


def _write(figure: Figure, text: str) -> Text:
    look: Any = {
        "ha": "center",
        "va": "bottom",
        "fontsize": 8.5,
        "linespacing": 1.1,
        "gid": "label",
    }
    return figure.text(0.5, 0.5, text, **look)


def _sizes(figure: Figure, texts: Sequence[Text]) -> Array:
    """Return widths with a gap, and heights with a leader, in fractions of the figure."""
    extents = np.array([text.get_window_extent().size for text in texts])
    return np.asarray(extents / figure.bbox.size + [_GAP, _LEADER], dtype=np.float64)
