"""Axes of a diagram: scales, margins, and stability boundaries as named lines."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib import patheffects
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from undula.arrays import Array
from undula.views.common import style
from undula.views.common.legends import fitting_legend
from undula.views.sweep.points import axis_label, units_of

#: A stability boundary: its name, values of the parameter, and forces, NaN without a boundary. A
#: single value NaN stands for a boundary at one force for all values.
Border = tuple[str, Array, Array]

#: Dashes of the boundaries by name.
DASHES: Mapping[str, Any] = {
    "onset": "solid",
    "spinning-lost": (0, (6, 2)),
    "flapping-gained": (0, (6, 2, 1.5, 2)),
    "flapping-lost": (0, (1.5, 1.5)),
    "spinning-fold": (0, (5, 1.5, 1, 1.5, 1, 1.5)),
    "flapping-fold": (0, (1, 3)),
}
_OTHER_DASHES = (0, (3, 1.5))
# Least ratio of largest to least value for a logarithmic scale.
_DECADE = 10.0
# Numbers on a logarithmic axis, times powers of ten, by its largest number of decades.
_NUMBERS = ((1.3, (1.0, 1.5, 2.0, 3.0, 5.0, 7.0)), (4.0, (1.0, 2.0, 5.0)), (np.inf, (1.0,)))
# Right end of legends in fractions of the figure.
_INSIDE = 0.985


def scale_of(values: Array) -> str:
    """Return the scale on which values are spaced most evenly, "log" or "linear"."""
    rising = np.unique(values)
    if rising.size < 3 or rising[0] <= 0.0 or rising[-1] < _DECADE * rising[0]:
        return "linear"
    steps, ratios = np.diff(rising), np.diff(np.log(rising))
    even, even_logs = (np.std(gaps) / np.mean(gaps) for gaps in (steps, ratios))
    return "log" if even_logs < even else "linear"


def diagram_on(
    figure: Figure, store: xr.Dataset, names: tuple[str, str], place: Sequence[float]
) -> Axes:
    """Add axes of two coordinates of a dataset, with scales, labels and margins.

    Parameters
    ----------
    figure
        The figure.
    store
        The dataset.
    names
        Names of the horizontal and the vertical coordinate.
    place
        Left, bottom, width and height in fractions of the figure.
    """
    axes = figure.add_axes((place[0], place[1], place[2], place[3]))
    units = units_of(store)
    for which, name in zip("xy", names, strict=True):
        set_scale(axes, which, np.asarray(store[name].values, dtype=float))
        getattr(axes, f"set_{which}label")(axis_label(name, units))
    return axes


def set_scale(axes: Axes, which: str, values: Array) -> None:
    """Set scale and limits of the x or y axis to contain values with half a step around.

    Parameters
    ----------
    axes
        The axes.
    which
        "x" or "y".
    values
        Values on the axis.
    """
    scale = scale_of(values)
    getattr(axes, f"set_{which}scale")(scale)
    logs = scale == "log"
    places = np.unique(np.log(values) if logs else values)
    if places.size == 1:
        margin = max(0.1 * abs(float(places[0])), 0.1)
    else:
        # Half a step, and at least the room for a symbol where steps differ much.
        margin = max(0.5 * float(np.diff(places).min()), 0.05 * float(np.ptp(places)))
    ends = np.array([places[0] - margin, places[-1] + margin])
    getattr(axes, f"set_{which}lim")(*(np.exp(ends) if logs else ends))
    if logs:
        plain_numbers(getattr(axes, f"{which}axis"), np.exp(ends))


def plain_numbers(axis: Axis, ends: Array) -> None:
    """Put plain numbers on a logarithmic axis between two ends, more for a short axis.

    Parameters
    ----------
    axis
        The axis.
    ends
        Both ends of the axis.
    """
    decades = np.log10(ends[1] / ends[0])
    subs = next(subs for most, subs in _NUMBERS if decades <= most)
    axis.set_major_locator(LogLocator(subs=subs))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())


def steps_in_points(axes: Axes, store: xr.Dataset, names: tuple[str, str]) -> tuple[float, float]:
    """Return the distance of neighbouring points, to the right and upwards [points of type].

    Parameters
    ----------
    axes
        The axes.
    store
        The dataset.
    names
        Names of the horizontal and the vertical coordinate.
    """
    box = axes.get_window_extent()
    # The box is in dots.
    rooms = 72.0 / axes.figure.dpi * np.array([box.width, box.height])
    steps = []
    for name, which, room in zip(names, "xy", rooms, strict=True):
        low, high = getattr(axes, f"get_{which}lim")()
        places = np.unique(np.asarray(store[name].values, dtype=float))
        if getattr(axes, f"get_{which}scale")() == "log":
            low, high, places = np.log(low), np.log(high), np.log(places)
        nearest = float(np.diff(places).min()) if places.size > 1 else high - low
        steps.append(float(room * nearest / (high - low)))
    return steps[0], steps[1]


def draw_borders(axes: Axes, boundaries: Sequence[Border]) -> list[Artist]:
    """Draw boundaries into axes whose limits are set; return their legend handles.

    A boundary without any force is left out.

    Parameters
    ----------
    axes
        The axes.
    boundaries
        The boundaries, as for `phase_diagram`.
    """
    halo = [patheffects.withStroke(linewidth=3.4, foreground="white")]
    handles: list[Artist] = []
    for name, values, forces in boundaries:
        if not np.any(np.isfinite(forces)):
            continue
        look: Any = {"color": style.INK, "lw": 1.5, "ls": DASHES.get(name, _OTHER_DASHES)}
        # A force whose neighbours are missing is drawn as a short dash.
        if np.size(values) == 1 and not np.isfinite(values[0]):
            axes.axhline(float(forces[0]), zorder=4, gid=name, path_effects=halo, **look)
        else:
            order = np.argsort(values)
            places, heights = np.asarray(values)[order], np.asarray(forces)[order]
            axes.plot(places, heights, zorder=4, gid=name, path_effects=halo, **look)
            alone = _alone(heights)
            axes.plot(places[alone], heights[alone], "_", ms=9, mew=1.5, color=style.INK, zorder=4)
        handles.append(Line2D([], [], label=name, **look))
    return handles


def place_legend(
    figure: Figure, rows: Sequence[Sequence[Artist]], left: float, top: float
) -> float:
    """Add rows of legends; return their lower end in fractions of the figure.

    Parameters
    ----------
    figure : Figure
        The figure.
    rows : sequence of sequence of artist
        Handles of each row; a long row is broken.
    left, top : float
        Upper left corner in fractions of the figure.
    """
    for handles in rows:
        if handles:
            legend = fitting_legend(
                figure,
                handles,
                (left, top),
                borderpad=0.1,
                borderaxespad=0.0,
                handlelength=_width_of(handles[0]),
            )
            top -= float(legend.get_window_extent().height / figure.bbox.height) + 0.004
    return top


def _width_of(handle: Artist) -> float:
    """Return the width of handles in a legend, larger for lines than for symbols."""
    line = isinstance(handle, Line2D) and handle.get_linestyle() not in ("None", "none")
    return 2.4 if line else 1.3


def _alone(heights: Array) -> Any:
    """Return a mask of the finite values without finite neighbours."""
    finite = np.isfinite(heights)
    padded = np.pad(finite, 1)
    return finite & ~padded[:-2] & ~padded[2:]
