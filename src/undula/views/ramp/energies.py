"""Energies along ramps over the parameter, with thresholds as vertical lines."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from undula.views.common import style
from undula.views.common.labels import Label
from undula.views.ramp.series import StepSeries

# Sizes of symbols [points]: where both directions agree, a dot lies in a ring.
_DOT, _RING, _EDGE = 3.0, 5.4, 0.9
#: Factor by which dots are larger in a legend.
LEGEND_SCALE = 5.0 / _DOT


def draw_energies(
    figure: Figure, axes: Axes, series: StepSeries, colours: Mapping[str, str]
) -> None:
    """Draw least and greatest energy of each step, joined, in the colour of its verdict.

    The group identity of points is verdict and direction, as in "spinning, up".

    Parameters
    ----------
    figure
        The figure.
    axes
        The axes.
    series
        The ramp.
    colours
        Colours of the verdicts.
    """
    names = np.array(series.verdicts)
    # Rings of neighbouring steps must not overlap.
    width = 72.0 * axes.get_position().width * figure.get_figwidth()
    size = min(1.0, max(0.3, width / np.unique(series.values).size / _RING))
    for verdict in dict.fromkeys(series.verdicts):
        colour = colours[verdict]
        for up in (True, False):
            steps = (names == verdict) & (series.up == up)
            if steps.any():
                look = marker(colour, up=up, size=size)
                look["gid"] = f"{verdict}, {'up' if up else 'down'}"
                for bound in (series.low, series.high):
                    axes.plot(series.values[steps], bound[steps], **look)
        steps = names == verdict
        bounds = series.values[steps], series.low[steps], series.high[steps]
        axes.vlines(*bounds, color=colour, lw=0.8, alpha=0.4, zorder=2, gid=f"{verdict}, range")
    axes.set_xlim(*series.span)
    axes.margins(y=0.06)
    axes.yaxis.set_major_locator(MaxNLocator(5))
    axes.set_xlabel(parameter_label(series))


def draw_thresholds(axes: Axes, thresholds: Mapping[str, float]) -> None:
    """Draw a line at each threshold, with the group identity "threshold".

    Parameters
    ----------
    axes
        The axes.
    thresholds
        Forces of the thresholds by name.
    """
    for value in thresholds.values():
        axes.axvline(value, color=style.INK, lw=0.8, ls="--", zorder=1, gid="threshold")


def threshold_labels(
    series: StepSeries, thresholds: Mapping[str, float], left: float, right: float
) -> list[Label]:
    """Return labels of thresholds for a panel between two edges.

    Parameters
    ----------
    series
        The ramp.
    thresholds
        Forces of the thresholds by name.
    left
        Left edge of the panel in fractions of the figure.
    right
        Right edge of the panel in fractions of the figure.
    """
    low, high = series.span
    scale = (right - left) / (high - low)
    return [
        Label(left + scale * (value - low), f"{name}\n{value:.4g}", style.INK)
        for name, value in thresholds.items()
    ]


def marker(colour: str, *, up: bool, size: float) -> Any:
    """Return the look of points in one direction: filled for up, open for down.

    Parameters
    ----------
    colour
        Colour of the points.
    up
        True for rising parameter.
    size
        Size relative to that of a dot.
    """
    if up:
        return {"ls": "", "marker": "o", "ms": _DOT * size, "mew": 0.0, "mfc": colour, "zorder": 3}
    edge = {"mec": colour, "mfc": "none", "mew": _EDGE * max(size, 0.5), "zorder": 4}
    return {"ls": "", "marker": "o", "ms": _RING * size} | edge


def parameter_label(series: StepSeries) -> str:
    """Return the name of the parameter with its unit."""
    if series.parameter == "load.force":
        return style.force_label(series.units)
    return style.parameter_label(series.parameter)
