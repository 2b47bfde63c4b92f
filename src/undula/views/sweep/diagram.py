"""Diagram of a sweep: verdict and frequency of every point, and stability boundaries.

After the phase diagram of Ling, Guo & Kanso (2018).
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.transforms import ScaledTranslation

from undula.views.common import style
from undula.views.common.renamed_keyword import renamed_keyword
from undula.views.common.verdict_styles import look_of, ordered
from undula.views.sweep.axes import (
    Border,
    diagram_on,
    draw_borders,
    place_legend,
    plain_numbers,
    steps_in_points,
)
from undula.views.sweep.line import draw_line
from undula.views.sweep.points import (
    AT_REST,
    Dot,
    Note,
    colour_span,
    diagram_axes,
    dots_of,
    heading,
)

_SIZE = (10.0, 7.0)
_LEFT, _RIGHT, _BOTTOM = 0.085, 0.875, 0.085
# Width of a dot over the distance of its neighbours, and its bounds [points].
_SHARE, _SMALLEST, _LARGEST = 0.62, 3.5, 11.0
_RING = style.Y_COLOUR
_COLOURS = "viridis"
# Ratio of frequencies above which colours are logarithmic.
_DECADE = 10.0


@renamed_keyword("borders", "boundaries")
def phase_diagram(
    store: xr.Dataset,
    boundaries: Sequence[Border] = (),
    *,
    contradicting: Sequence[Note] = (),
    title: str | None = None,
) -> Figure:
    """Draw the verdicts and frequencies of a sweep.

    Over two axes, each dot has the colour of its frequency and the symbol of its verdict; different
    verdicts of the replicates of a point are drawn side by side. Over one axis, frequency and
    energy are drawn.

    Parameters
    ----------
    store : xarray.Dataset
        A stored sweep that varies one or two axes; values of other axes are selected with `sel`.
    boundaries : sequence of (str, ndarray, ndarray)
        Name, values of the parameter and forces of each stability boundary, NaN without a boundary;
        a single value NaN for a boundary at one force. One of the axes has to be the force.
    contradicting : sequence of (mapping of str to float, str)
        Places of points that contradict the solved states, which are ringed, and a sentence on each
        contradiction.
    title : str, optional
        Title of the figure; by default the load, and the values of axes that do not vary.

    Returns
    -------
    matplotlib.figure.Figure
        10 by 7 inches, not registered with pyplot.

    Raises
    ------
    InputError
        The dataset is not a stored sweep, or varies more than two axes.

    Examples
    --------
    >>> import undula
    >>> from undula.views import phase_diagram
    >>> stored = undula.load("results/point-loads.zarr")
    >>> phase_diagram(stored).savefig("diagram.png")
    """
    right, above = diagram_axes(store)
    with style.figure_style(store):
        figure = Figure(figsize=_SIZE)
        style.write_title(figure, heading(store) if title is None else title, (0.022, 0.962))
        if above is None:
            draw_line(figure, store, boundaries, contradicting)
        else:
            _draw_map(figure, store, (right, above), boundaries, contradicting)
    return figure


def colour_scale(dots: Sequence[Dot]) -> Normalize | None:
    """Return the colour scale of the frequencies of dots, None without any frequency."""
    span = colour_span(dots)
    if span is None:
        return None
    low, high = span
    if high > _DECADE * low:
        return LogNorm(low, high)
    # A scale needs two ends even for a single frequency.
    return Normalize(low, high) if high > low else Normalize(0.5 * low, 1.5 * low)


def _draw_map(
    figure: Figure,
    store: xr.Dataset,
    names: tuple[str, str],
    boundaries: Sequence[Border],
    contradicting: Sequence[Note],
) -> None:
    dots = dots_of(store)
    axes = diagram_on(figure, store, names, (_LEFT, _BOTTOM, _RIGHT - _LEFT, 0.7))
    lines = draw_borders(axes, boundaries)
    symbols = _name_symbols(dots, ringed=bool(contradicting))
    top = place_legend(figure, [symbols, lines], _LEFT, 0.945) - 0.012
    axes.set_position((_LEFT, _BOTTOM, _RIGHT - _LEFT, top - _BOTTOM))
    steps, scale = steps_in_points(axes, store, names), colour_scale(dots)
    size = float(np.clip(_SHARE * min(steps), _SMALLEST, _LARGEST))
    _draw_dots(axes, dots, (size, steps[0]), scale)
    _draw_troubles(axes, dots, size)
    places = {(place[names[0]], place[names[1]]) for place, _ in contradicting}
    ring: Any = {"mfc": "none", "mec": _RING, "mew": 1.4, "ls": "none", "gid": "contradicting"}
    axes.plot(*np.array(sorted(places) or np.empty((0, 2))).T, "o", ms=1.7 * size, **ring, zorder=7)
    if scale is not None:
        _draw_bar(figure, axes, scale)


def _draw_dots(
    axes: Axes, dots: Sequence[Dot], sizes: tuple[float, float], scale: Normalize | None
) -> None:
    """Draw the dots of each verdict, side by side where a point has several verdicts.

    The sizes are the width of a dot, and the distance to the next point on the right [points].
    """
    groups: dict[tuple[str, int, int], list[Dot]] = {}
    for dot in dots:
        if dot.verdict:
            groups.setdefault((dot.verdict, dot.place, dot.places), []).append(dot)
    for (verdict, place, places), group in groups.items():
        width = min(sizes[0], _SHARE * sizes[1] / places)
        shift = (place - 0.5 * (places - 1)) * 1.2 * width
        shifted = ScaledTranslation(shift / 72.0, 0.0, axes.figure.dpi_scale_trans)
        xs, ys = (np.array([getattr(dot, name) for dot in group]) for name in ("x", "y"))
        look: Any = {
            "marker": look_of(verdict).marker,
            "s": _area(verdict, width),
            "transform": axes.transData + shifted,
            "zorder": 5,
            "gid": verdict,
        }
        if verdict in AT_REST:
            axes.scatter(xs, ys, facecolors="none", edgecolors=style.QUIET, linewidths=0.9, **look)
            continue
        rates = np.array([dot.frequency for dot in group])
        moving = np.isfinite(rates) & (rates > 0.0)
        look |= {"edgecolors": style.INK, "linewidths": 0.5}
        axes.scatter(xs[moving], ys[moving], c=rates[moving], cmap=_COLOURS, norm=scale, **look)
        axes.scatter(xs[~moving], ys[~moving], facecolors="white", **look)


def _area(verdict: str, width: float) -> float:
    """Return the area of a symbol [points^2], with a factor that equalises apparent sizes."""
    wider = {"*": 1.35, "D": 0.85, "s": 0.9, "^": 1.05, "v": 1.05}
    smaller = 0.55 if verdict in AT_REST else 1.0
    return (smaller * wider.get(look_of(verdict).marker, 1.0) * width) ** 2


def _draw_troubles(axes: Axes, dots: Sequence[Dot], size: float) -> None:
    for failed, marker, colour in ((True, "x", style.Y_COLOUR), (False, "+", style.SHADOW)):
        missing = [(dot.x, dot.y) for dot in dots if not dot.verdict and dot.failed == failed]
        look: Any = {"color": colour, "ms": 0.6 * size, "mew": 1.0, "ls": "none", "zorder": 5}
        places = np.array(missing or np.empty((0, 2)))
        axes.plot(*places.T, marker, gid="failed" if failed else "not done", **look)


def _name_symbols(dots: Sequence[Dot], *, ringed: bool) -> list[Artist]:
    handles: list[Artist] = []
    for verdict in ordered(dot.verdict for dot in dots if dot.verdict):
        rest = verdict in AT_REST
        handles.append(
            Line2D(
                [],
                [],
                ls="none",
                marker=look_of(verdict).marker,
                ms=_area(verdict, 7.5) ** 0.5,
                mfc="none" if rest else "#9aa5ad",
                mec=style.QUIET if rest else style.INK,
                mew=0.8,
                label=verdict,
            )
        )
    troubles = (("failed", True, "x", style.Y_COLOUR), ("not done", False, "+", style.SHADOW))
    for name, failed, marker, colour in troubles:
        if any(not dot.verdict and dot.failed == failed for dot in dots):
            handles.append(Line2D([], [], ls="none", marker=marker, color=colour, ms=5, label=name))
    if ringed:
        look: Any = {"ls": "none", "mfc": "none", "mec": _RING, "mew": 1.4}
        label = "contradicts the solved states"
        handles.append(Line2D([], [], marker="o", ms=10, label=label, **look))
    return handles


def _draw_bar(figure: Figure, axes: Axes, scale: Normalize) -> None:
    place = axes.get_position()
    bar_axes = figure.add_axes((place.x1 + 0.018, place.y0, 0.018, place.height))
    mapped = ScalarMappable(norm=scale, cmap=_COLOURS)
    bar: Any = figure.colorbar(mapped, cax=bar_axes)
    bar.outline.set_visible(False)
    bar.set_label(style.frequency_label(paper_time=False))
    if isinstance(scale, LogNorm):
        plain_numbers(bar.ax.yaxis, np.array([scale.vmin, scale.vmax]))
