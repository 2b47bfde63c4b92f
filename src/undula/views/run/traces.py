"""Quantities over time: the whole run on the left, its last few periods on the right."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from undula.views.common import style
from undula.views.run.quantities import Curve, Row
from undula.views.run.resample import curve_times
from undula.views.run.scene import PERIODS_IN_FOCUS, Floats, Scene, turning_points

# Number of samples in each span of a band of sparse samples.
_SPARSE_SPAN = 300
# Margin before the first time, as a fraction of the run.
_AT_START = 0.012
# Least number of spans of a band; with fewer spans the samples themselves are drawn.
_FEWEST_SPANS = 12
# Largest number of cycles drawn as a line, number of spans of a band, and numbers of points.
_CYCLES_AS_LINES = 25
_BANDS = 150
_POINTS = 800
_POINTS_PER_CYCLE = 48
_MARK_SAMPLES_BELOW = 60
# Relative change below which a quantity is constant: its axis then shows the approach to the value,
# since a finer scale would resolve round-off.
_CONSTANT = 1e-3
# Ratio to the greatest value below which a decayed quantity counts as zero.
_NOTHING = 1e-6
# Largest relative extension of an axis to show the whole beginning of a curve.
_STRETCH = 0.5


def draw_traces(
    figure: Figure,
    scene: Scene,
    rows: Sequence[Callable[[Scene], Row]],
    left: float,
    right: float,
    top: float,
) -> list[list[Axes]]:
    """Draw rows of quantities over a common time axis.

    Parameters
    ----------
    figure : Figure
        The figure.
    scene : Scene
        The run.
    rows : sequence of callable
        Functions that return the rows, from top to bottom, at least two.
    left, right, top : float
        Edges of the panels in fractions of the figure.

    Returns
    -------
    list of lists of Axes
        Axes of each row: of the whole run, and of the last few cycles if they need their own.
    """
    focus = scene.focus
    columns = 1 if focus is None else 2
    grid = figure.add_gridspec(
        len(rows), columns, left=left, right=right, bottom=0.105, top=top, wspace=0.07, hspace=0.3
    )
    axes = [[figure.add_subplot(grid[i, j]) for j in range(columns)] for i in range(len(rows))]
    for row, line in zip(rows, axes, strict=True):
        _draw_row(scene, row(scene), row(scene.detail), line)
    for place, axis in enumerate(axes[-1]):
        axis.set_xlabel(style.time_label(scene.units) if place == 0 else style.SHORT_TIME_LABEL)
    axes[0][0].set_title(
        "whole run" if scene.interpolable else "whole run, at stored times", loc="left"
    )
    if focus is not None:
        axes[0][1].set_title(_focus_name(scene, focus), loc="left")
    if scene.settled is not None:
        axes[1][0].set_title("shaded: settled", loc="right")
    for line in axes[:-1]:
        for axis in line:
            axis.tick_params(labelbottom=False)
    figure.align_ylabels([line[0] for line in axes])
    return axes


def band(times: Floats, values: Floats, cycles: float) -> tuple[Floats, Floats, Floats]:
    """Return the lowest and highest value in spans of at least one cycle.

    Parameters
    ----------
    times, values : ndarrays of shape (m,)
        A curve with too many cycles for a line.
    cycles : float
        Number of cycles of the curve.

    Returns
    -------
    tuple of three ndarrays of shape (k,)
        Times from first to last, lowest values, highest values.
    """
    count = int(min(_BANDS, max(1, cycles), len(times)))
    first = np.unique(np.linspace(0, len(times), count, endpoint=False).astype(int))
    low, high = np.minimum.reduceat(values, first), np.maximum.reduceat(values, first)
    return np.linspace(times[0], times[-1], len(first)), low, high


def _focus_name(scene: Scene, focus: tuple[float, float]) -> str:
    if scene.period is None or focus[1] - focus[0] < 0.99 * PERIODS_IN_FOCUS * scene.period:
        return "last part"
    return f"last {PERIODS_IN_FOCUS} periods"


def _draw_row(scene: Scene, row: Row, near: Row, line: list[Axes]) -> None:
    """Draw a row of the whole run, and next to it the last cycles."""
    whole = line[0]
    whole.set_ylabel(row.label)
    _shade(scene, whole)
    for curve in row.curves:
        cycles = _cycles(scene, curve.samples)
        if cycles > _CYCLES_AS_LINES and scene.interpolable:
            _draw_band(whole, scene, curve, cycles)
        elif cycles > _CYCLES_AS_LINES:
            _draw_samples(whole, scene, curve)
        else:
            _draw_line(whole, scene, curve, (scene.start, scene.end))
    # The margin keeps a sudden beginning off the axis.
    whole.set_xlim(scene.start - _AT_START * scene.duration, scene.end)
    if len(line) == 2 and scene.focus is not None:
        for curve in near.curves:
            _draw_line(line[1], scene.detail, curve, scene.focus)
        line[1].set_xlim(*scene.focus)
        line[1].tick_params(labelleft=False)
        line[1].set_facecolor(style.FOCUS)
    _scale(line, [*row.curves, *near.curves])
    if len(row.curves) > 1:
        _name_curves(line[-1], row)


def _draw_line(axes: Axes, scene: Scene, curve: Curve, window: tuple[float, float]) -> None:
    times = curve_times(scene, *window, _POINTS)
    look = curve.dashes if scene.interpolable else "none"
    axes.plot(times, curve.at(times), linestyle=look, color=curve.colour, lw=curve.width)
    inside = (scene.times >= window[0]) & (scene.times <= window[1])
    if not scene.interpolable or np.count_nonzero(inside) < _MARK_SAMPLES_BELOW:
        axes.plot(scene.times[inside], curve.samples[inside], ".", color=curve.colour, ms=3.5)


def _cycles(scene: Scene, values: Floats) -> float:
    """Return the number of cycles of a curve, at most one in each period of the motion."""
    least = 1e-3 * max(float(np.ptp(values)), 1e-3 * float(np.abs(values).max()), 1e-12)
    turns = turning_points(values, least) / 2
    return turns if scene.period is None else min(turns, scene.duration / scene.period)


def _draw_band(axes: Axes, scene: Scene, curve: Curve, cycles: float) -> None:
    dense = curve_times(scene, scene.start, scene.end, int(_POINTS_PER_CYCLE * cycles))
    _fill(axes, curve, *band(dense, curve.at(dense), cycles))


def _draw_samples(axes: Axes, scene: Scene, curve: Curve) -> None:
    """Draw a curve with sparse samples: as a band of its bounds, or as single samples."""
    # A span needs many samples to contain the extremes, since sparse samples beat with the cycles.
    spans = len(scene.times) / _SPARSE_SPAN
    if spans >= _FEWEST_SPANS:
        _fill(axes, curve, *band(scene.times, curve.samples, spans))
        return
    look: Any = {"color": curve.colour, "ms": 3.6, "alpha": 0.8, "mew": 0.0}
    axes.plot(scene.times, curve.samples, ".", **look)


def _fill(axes: Axes, curve: Curve, times: Floats, low: Floats, high: Floats) -> None:
    axes.fill_between(times, low, high, color=curve.colour, alpha=0.22, lw=0)
    for edge in (low, high):
        axes.plot(times, edge, curve.dashes, color=curve.colour, lw=0.6 * curve.width)


def _shade(scene: Scene, axes: Axes) -> None:
    """Shade the settled part of the run, and the part that the other column shows."""
    if scene.settled is not None:
        axes.axvspan(*scene.settled, color=style.SETTLED, lw=0)
    if scene.focus is not None:
        axes.axvspan(*scene.focus, color=style.FOCUS, lw=0)


def _scale(line: list[Axes], curves: Sequence[Curve]) -> None:
    """Set the same scale in both columns, independent of a short spike at the start."""
    low, high = limits([curve.samples for curve in curves])
    for axes in line:
        axes.set_ylim(low, high)
        axes.yaxis.set_major_locator(MaxNLocator(4))
    line[0].xaxis.set_major_locator(MaxNLocator(5))
    for axes in line[1:]:
        axes.xaxis.set_major_locator(MaxNLocator(3, prune="lower"))


def limits(curves: Sequence[Floats]) -> tuple[float, float]:
    """Return the limits of an axis for curves, each of shape (m,) in the order of time.

    The limits contain the second half of each curve and nearly all of its first half; the rest is
    included if it needs little more room. If the second half is constant up to round-off, they
    contain the approach to it as well, except for a spike.
    """
    bounds = np.array([_bounds(values) for values in curves])
    low, high = float(bounds[:, 0].min()), float(bounds[:, 1].max())
    least, most = min(map(np.min, curves)), max(map(np.max, curves))
    value, largest = max(abs(low), abs(high)), max(abs(float(least)), abs(float(most)))
    if value < _NOTHING * largest:
        low, high = float(least), float(most)
    elif high - low < _CONSTANT * value:
        low, high = max(float(least), low - value), min(float(most), high + value)
    else:
        stretch = _STRETCH * (high - low)
        low = float(least) if low - least <= stretch else low
        high = float(most) if most - high <= stretch else high
    value = max(abs(low), abs(high))
    margin = 0.1 * (high - low if high - low > _CONSTANT * value else value) or 1e-3
    return low - margin, high + margin


def _bounds(values: Floats) -> tuple[float, float]:
    late = values[len(values) // 2 :]
    low, high = np.percentile(values, (1, 99))
    return min(float(low), float(late.min())), max(float(high), float(late.max()))


def _name_curves(axes: Axes, row: Row) -> None:
    handles = [
        axes.plot([], [], curve.dashes, color=curve.colour, lw=curve.width, label=curve.name)[0]
        for curve in row.curves
    ]
    axes.legend(
        handles=handles,
        loc="lower right",
        bbox_to_anchor=(1.0, 0.99),
        ncols=len(handles),
        borderaxespad=0.0,
        borderpad=0.2,
    )
