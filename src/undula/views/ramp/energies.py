"""The energies of series of steps against the parameter, with thresholds as vertical lines."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from undula.views.common import style
from undula.views.common.labels import Label
from undula.views.ramp.series import StepSeries

# Points: where the two ways agree, the dot of the one lies in the ring of the other.
_DOT, _RING, _EDGE = 3.0, 5.4, 0.9
#: By how much dots are larger that stand for themselves.
ALONE = 5.0 / _DOT


def draw_energies(
    figure: Figure, axes: Axes, series: StepSeries, colours: Mapping[str, str]
) -> None:
    """Draw least and greatest energy of each step, joined, in the colour of its verdict.

    Points have the group identity of their verdict and direction, as "spinning, up".
    """
    names = np.array(series.verdicts)
    # Rings of neighbours should not cover one another.
    width = 72.0 * axes.get_position().width * figure.get_figwidth()
    size = min(1.0, max(0.3, width / np.unique(series.values).size / _RING))
    for verdict in dict.fromkeys(series.verdicts):
        colour = colours[verdict]
        for up in (True, False):
            here = (names == verdict) & (series.up == up)
            if here.any():
                look = marker(colour, up=up, size=size)
                look["gid"] = f"{verdict}, {'up' if up else 'down'}"
                for bound in (series.low, series.high):
                    axes.plot(series.values[here], bound[here], **look)
        here = names == verdict
        bounds = series.values[here], series.low[here], series.high[here]
        axes.vlines(*bounds, color=colour, lw=0.8, alpha=0.4, zorder=2, gid=f"{verdict}, range")
    axes.set_xlim(*series.span)
    axes.margins(y=0.06)
    axes.yaxis.set_major_locator(MaxNLocator(5))
    axes.set_xlabel(parameter_label(series))


def draw_thresholds(axes: Axes, known: Mapping[str, float]) -> None:
    """Draw a line at each threshold, with the group identity "threshold"."""
    for value in known.values():
        axes.axvline(value, color=style.INK, lw=0.8, ls="--", zorder=1, gid="threshold")


def threshold_labels(
    series: StepSeries, known: Mapping[str, float], left: float, right: float
) -> list[Label]:
    """Return names and values of thresholds for the panel between these edges."""
    low, high = series.span
    scale = (right - left) / (high - low)
    return [
        Label(left + scale * (value - low), f"{name}\n{value:.4g}", style.INK)
        for name, value in known.items()
    ]


def marker(colour: str, *, up: bool, size: float) -> Any:
    """Return the look of the points of one way: filled for up, open for down."""
    if up:
        return {"ls": "", "marker": "o", "ms": _DOT * size, "mew": 0.0, "mfc": colour, "zorder": 3}
    edge = {"mec": colour, "mfc": "none", "mew": _EDGE * max(size, 0.5), "zorder": 4}
    return {"ls": "", "marker": "o", "ms": _RING * size} | edge


def parameter_label(series: StepSeries) -> str:
    """Name the parameter with its unit."""
    if series.parameter == "load.force":
        return style.force_label(series.units)
    return style.parameter_label(series.parameter)
