"""Growth rate and frequency of the leading eigenvalue over the force, and over a parameter.

After the figures "Frequency of oscillations versus linear stability analysis" and "Linear stability
analysis" of Ling, Guo & Kanso (2018).
"""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from undula.analysis.linear.curves import GrowthCurve
from undula.arrays import Array
from undula.models.scales import Scales
from undula.views.common import style
from undula.views.linear.growth_maps import draw_maps


def growth_figure(
    growth: GrowthCurve,
    *,
    title: str,
    units: style.UnitNames = style.FILAMENT,
    scales: Scales | None = None,
) -> Figure:
    """Draw the leading eigenvalue over the force, and over a parameter if the curve has one.

    Parameters
    ----------
    growth : GrowthCurve
        Rates and frequencies; NaN for missing values.
    title : str
        Title of the figure.
    units : mapping of str to str
        Names of the model's units, by quantity; by default those of a filament.
    scales : Scales, optional
        SI values of the dimensionless units, which the labels then state.

    Returns
    -------
    matplotlib.figure.Figure
        10 by 5.5 inches, not registered with pyplot. Without a parameter it has two panels over the
        force; with a parameter two maps over parameter and force, with the Hopf curve in black.

    Examples
    --------
    >>> import undula
    >>> from undula.views import growth_figure
    >>> model = undula.Filament(segments=8, load=undula.TipLoad(75.0))
    >>> growth = undula.growth_curve(model, [20.0, 40.0, 60.0])
    >>> growth_figure(growth, title="tip force").get_size_inches().tolist()
    [10.0, 5.5]
    """
    with style.figure_style(scales):
        figure = style.headed_figure(title, paper_time=growth.paper_time)
        if growth.values is None:
            draw_growth(figure, growth, units, left=0.09, right=0.975, top=0.9)
        else:
            draw_maps(figure, growth, growth.values, units)
    return figure


def draw_growth(
    figure: Figure,
    growth: GrowthCurve,
    units: style.UnitNames,
    left: float,
    right: float,
    top: float,
) -> tuple[Axes, Axes]:
    """Draw rate and frequency in two panels over one force axis, with unstable forces shaded.

    Parameters
    ----------
    figure : Figure
        The figure.
    growth : GrowthCurve
        A curve without a parameter.
    units : mapping of str to str
        Names of the model's units.
    left, right, top : float
        Edges of the panels in fractions of the figure.

    Returns
    -------
    tuple of two Axes
        The panel of the rate and the panel of the frequency.
    """
    grid = figure.add_gridspec(2, 1, left=left, right=right, bottom=0.105, top=top, hspace=0.16)
    upper = figure.add_subplot(grid[0])
    lower = figure.add_subplot(grid[1], sharex=upper)
    order = np.argsort(growth.forces)
    forces, rates = _cut_at_zero(growth.forces[order], growth.rates[order])
    for axes in (upper, lower):
        shade = axes.get_xaxis_transform()
        axes.fill_between(
            forces, 0, 1, where=rates >= 0, transform=shade, color=style.UNSTABLE, lw=0
        )
        axes.yaxis.set_major_locator(MaxNLocator(5))
    upper.axhline(0.0, color=style.QUIET, lw=0.7)
    draw_points(upper, forces, np.where(rates <= 0, rates, np.nan), style.X_COLOUR, name="decays")
    draw_points(
        upper, forces, np.where(rates >= 0, rates, np.nan), style.Y_COLOUR, name="grows", width=2.4
    )
    draw_points(lower, growth.forces[order], growth.frequencies[order], style.INK)
    if np.any(np.isfinite(rates)):
        upper.legend(loc="best")
    upper.tick_params(labelbottom=False)
    upper.set_ylabel(style.growth_rate_label(paper_time=growth.paper_time))
    lower.set_ylabel(style.frequency_label(paper_time=growth.paper_time))
    lower.set_xlabel(style.force_label(units))
    set_span(upper, growth.forces)
    start_at_zero(lower)
    figure.align_ylabels([upper, lower])
    return upper, lower


def draw_points(
    axes: Axes,
    places: Array,
    values: Array,
    colour: str,
    *,
    name: str = "",
    dashes: str = "-",
    width: float = 1.6,
) -> None:
    """Draw a line through values, broken at NaN, with a dot for a value without neighbours.

    Parameters
    ----------
    axes
        The axes.
    places
        Places on the x axis, shape (m,).
    values
        Values, NaN for missing ones, shape (m,).
    colour
        Colour of line and dots.
    name
        Group identity of the line, and its label in a legend.
    dashes
        Style of the line.
    width
        Width of the line [points].
    """
    finite = np.isfinite(values)
    padded = np.concatenate([[False], finite, [False]])
    alone = np.flatnonzero(finite & ~padded[:-2] & ~padded[2:])
    # A line without points has no entry in the legend.
    label = name if name and np.any(finite) else "_"
    look: Any = {"color": colour, "lw": width, "gid": name, "label": label}
    axes.plot(places, values, dashes, **look)
    axes.plot(places[alone], values[alone], "o", color=colour, ms=3 + width)


def set_span(axes: Axes, places: Array) -> None:
    """Set the limits of the x axis to the range of places, or around a single place.

    Parameters
    ----------
    axes
        The axes.
    places
        Places on the x axis, shape (m,).
    """
    finite = places[np.isfinite(places)]
    if finite.size:
        low, high = float(finite.min()), float(finite.max())
        margin = 0.0 if high > low else max(0.1 * abs(low), 0.1)
        axes.set_xlim(low - margin, high + margin)


def start_at_zero(axes: Axes) -> None:
    """Set the limits of the y axis to 0 and all drawn values, or to 0 and 1 without values."""
    high = axes.dataLim.y1 if 0.0 < axes.dataLim.y1 < np.inf else 1.0
    axes.set_ylim(-0.05 * high, 1.08 * high)


def _cut_at_zero(places: Array, values: Array) -> tuple[Array, Array]:
    """Insert the points at which a piecewise linear curve crosses zero."""
    finite = np.isfinite(values[:-1]) & np.isfinite(values[1:])
    left = np.flatnonzero(finite & ((values[:-1] < 0) != (values[1:] < 0)))
    fraction = values[left] / (values[left] - values[left + 1])
    cuts = places[left] + fraction * (places[left + 1] - places[left])
    return np.insert(places, left + 1, cuts), np.insert(values, left + 1, 0.0)
