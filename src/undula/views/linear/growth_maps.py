"""Maps of the leading eigenvalue over a parameter and the force.

After the figure "Linear stability analysis" of Ling, Guo & Kanso (2018).
"""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import Normalize, SymLogNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from undula.analysis.linear.curves import GrowthCurve
from undula.arrays import Array
from undula.views.common import style
from undula.views.common.legends import fitting_legend

_HOPF = ("growth rate 0: Hopf curve", "-")
_RINGING = ("edge of oscillation: frequency 0 below", "--")


def draw_maps(figure: Figure, growth: GrowthCurve, values: Array, units: style.UnitNames) -> None:
    """Draw maps of rate and frequency over parameter and force, with the zeros of both.

    Parameters
    ----------
    figure
        The figure.
    growth
        Rates and frequencies over parameter and force.
    values
        Values of the parameter.
    units
        Names of the units by quantity.
    """
    across, up = np.argsort(values), np.argsort(growth.forces)
    places, forces = values[across], growth.forces[up]
    rates = growth.rates[np.ix_(across, up)].T
    frequencies = growth.frequencies[np.ix_(across, up)].T
    grid = figure.add_gridspec(1, 2, left=0.075, right=0.98, bottom=0.105, top=0.865, wspace=0.2)
    left, right = (figure.add_subplot(grid[side]) for side in range(2))
    span, ticks = _around_zero(rates)
    bar = _draw_map(left, places, forces, rates, "RdBu_r", span)
    bar.set_ticks(ticks)
    bar.set_label(style.growth_rate_label(paper_time=growth.paper_time))
    bar = _draw_map(right, places, forces, frequencies, "YlGnBu", _from_zero(frequencies))
    bar.set_label(style.frequency_label(paper_time=growth.paper_time))
    squares = _continued(frequencies**2)
    for axes in (left, right):
        axes.set_xlabel(style.parameter_label(growth.parameter or ""))
        axes.set_ylabel(style.force_label(units))
        _draw_zero(axes, places, forces, rates, *_HOPF)
        _draw_zero(axes, places, forces, squares, *_RINGING)
    _name_boundaries(figure, unknown=not np.all(np.isfinite(rates)))


def _draw_map(axes: Axes, x: Array, y: Array, field: Array, colours: str, span: Normalize) -> Any:
    """Draw one cell around each value of a field; return the colour bar."""
    axes.set_facecolor(style.SHADOW)
    mesh: Any = axes.pcolormesh(_edges(x), _edges(y), field, cmap=colours, norm=span)
    # As vector graphics, thousands of cells would show gaps between them.
    mesh.set_rasterized(True)
    bar: Any = axes.figure.colorbar(mesh, ax=axes, pad=0.03, aspect=28)
    bar.outline.set_visible(False)
    return bar


def _draw_zero(axes: Axes, x: Array, y: Array, field: Array, name: str, dashes: str) -> None:
    """Draw the zero contour of a field, if it has one."""
    finite = field[np.isfinite(field)]
    if min(field.shape) > 1 and finite.size and finite.min() < 0 < finite.max():
        look: Any = {"levels": [0.0], "colors": "black", "linestyles": dashes, "linewidths": 1.5}
        axes.contour(x, y, field, **look).set_gid(name)


def _name_boundaries(figure: Figure, *, unknown: bool) -> None:
    handles: list[Any] = [
        Line2D([], [], color="black", ls=dashes, lw=1.5, label=name)
        for name, dashes in (_HOPF, _RINGING)
    ]
    if unknown:
        handles.append(Patch(color=style.SHADOW, label="no value"))
    fitting_legend(figure, handles, (0.062, 0.935), handlelength=2.2)


def _continued(squares: Array) -> Array:
    """Replace zero squares of frequencies by negative numbers, so that a contour has a zero.

    Where two real eigenvalues meet, the square of the frequency grows linearly from 0, and two
    values beyond the edge determine its place. Where another mode becomes the leading one they do
    not, and the edge is placed halfway.
    """
    wide, inner = np.pad(squares, 2), slice(2, -2)
    lines, halves = np.full(squares.shape, np.inf), np.full(squares.shape, np.inf)
    for axis, step in ((0, 1), (0, -1), (1, 1), (1, -1)):
        first, second = (np.roll(wide, -k * step, axis)[inner, inner] for k in (1, 2))
        line = 2 * first - second
        linear = (second > 0) & (line < first / 2)
        lines = np.where(linear, np.minimum(lines, np.minimum(line, 0.0)), lines)
        halves = np.where(first > 0, np.minimum(halves, -first), halves)
    nearby = np.where(np.isfinite(lines), lines, halves)
    beyond = -squares[np.isfinite(squares)].max(initial=0.0)
    return np.where(squares == 0, np.where(np.isfinite(nearby), nearby, beyond), squares)


def _around_zero(field: Array) -> tuple[Normalize, list[float]]:
    """Return a scale that is linear near zero and logarithmic beyond, and its ticks."""
    finite = field[np.isfinite(field)]
    sides = [side for side in (-finite.min(initial=0.0), finite.max(initial=0.0)) if side > 0]
    largest = max(sides, default=1.0)
    # Rates of growth are far larger than those of decay: the smaller side sets the linear range,
    # with at most three decades beyond it, which can still be distinguished.
    near = 10.0 ** np.floor(np.log10(max(min(sides, default=1.0), 1e-3 * largest)))
    decades = np.arange(1 + np.floor(np.log10(largest / near) + 1e-9))
    ticks = near * 10.0**decades
    return SymLogNorm(near, vmin=-largest, vmax=largest), [*-ticks[::-1], 0.0, *ticks]


def _from_zero(field: Array) -> Normalize:
    return Normalize(0.0, float(field[np.isfinite(field)].max(initial=0.0)) or 1.0)


def _edges(places: Array) -> Array:
    """Return the edges of cells around rising places, which may be unevenly spaced."""
    if len(places) == 1:
        half = max(0.1 * abs(float(places[0])), 0.1)
        return np.array([places[0] - half, places[0] + half])
    middles = (places[1:] + places[:-1]) / 2
    first, last = 2 * places[0] - middles[0], 2 * places[-1] - middles[-1]
    return np.array([first, *middles, last])
