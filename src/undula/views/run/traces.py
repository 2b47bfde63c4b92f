"""Quantities against time: the whole run on the left, its last few periods on the right."""

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

# Samples in a span of a band where there are too few a cycle to draw them as a line.
_SPARSE_SPAN = 300
_AT_START = 0.012
# With fewer spans a band would be a few blocks: the samples themselves tell more.
_FEWEST_SPANS = 12
_CYCLES_AS_LINES = 25
_BANDS = 150
_POINTS = 800
_POINTS_PER_CYCLE = 48
_MARK_SAMPLES_BELOW = 60
# A quantity that changes by less than this part of itself is drawn as constant, beside the way to
# its value: finer marks would be those of round-off.
_CONSTANT = 1e-3
# What has decayed to less than this part of its greatest value has none of its own to be seen.
_NOTHING = 1e-6
# A beginning that makes an axis longer by no more than this part of it is shown whole.
_STRETCH = 0.5


def draw_traces(
    figure: Figure,
    scene: Scene,
    rows: Sequence[Callable[[Scene], Row]],
    left: float,
    right: float,
    top: float,
) -> list[list[Axes]]:
    """Draw rows of quantities against a shared time.

    Parameters
    ----------
    figure : Figure
        Where to draw them.
    scene : Scene
        The run.
    rows : sequence of callable
        What gives each row, from top to bottom, at least two.
    left, right, top : float
        Edges of the block in parts of the figure.

    Returns
    -------
    list of lists of Axes
        Per row its axes: the whole run, and the last few cycles where they would not be seen.
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
    """Give the lowest and highest value in each of many spans of at least one cycle.

    Parameters
    ----------
    times, values : ndarrays of shape (m,)
        A curve with too many cycles to be drawn as a line.
    cycles : float
        Number of cycles in it.

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
    """Draw a row of the whole run, and beside it what is near in time."""
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
    # What begins at once would lie on the axis itself.
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
    """Count the cycles of a curve; one that turns back often in a period has one cycle in it."""
    least = 1e-3 * max(float(np.ptp(values)), 1e-3 * float(np.abs(values).max()), 1e-12)
    turns = turning_points(values, least) / 2
    return turns if scene.period is None else min(turns, scene.duration / scene.period)


def _draw_band(axes: Axes, scene: Scene, curve: Curve, cycles: float) -> None:
    dense = curve_times(scene, scene.start, scene.end, int(_POINTS_PER_CYCLE * cycles))
    _fill(axes, curve, *band(dense, curve.at(dense), cycles))


def _draw_samples(axes: Axes, scene: Scene, curve: Curve) -> None:
    """Draw a curve of too few samples a cycle: between what bounds it lies, or its samples."""
    # A span needs many samples to come near the extremes: few a cycle beat with the cycles.
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
    """Mark the settled part of the run, and within it the part that the other column shows."""
    if scene.settled is not None:
        axes.axvspan(*scene.settled, color=style.SETTLED, lw=0)
    if scene.focus is not None:
        axes.axvspan(*scene.focus, color=style.FOCUS, lw=0)


def _scale(line: list[Axes], curves: Sequence[Curve]) -> None:
    """Give both columns one scale, which a short spike at the start does not decide."""
    low, high = limits([curve.samples for curve in curves])
    for axes in line:
        axes.set_ylim(low, high)
        axes.yaxis.set_major_locator(MaxNLocator(4))
    line[0].xaxis.set_major_locator(MaxNLocator(5))
    for axes in line[1:]:
        axes.xaxis.set_major_locator(MaxNLocator(3, prune="lower"))


def limits(curves: Sequence[Floats]) -> tuple[float, float]:
    """Return the limits of an axis for some curves, each (m,), in the course of time.

    They hold the second half of each curve and nearly all of the first; the rest, too, where that
    takes little more room. Where that is constant but for round-off, they hold the way to it as
    well, as far as it is no spike.
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
