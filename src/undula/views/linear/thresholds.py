"""Thresholds of the straight filament over a parameter: oscillatory force and Hopf force."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from undula.analysis.linear.curves import CriticalCurve
from undula.arrays import Array
from undula.models.scales import Scales
from undula.views.common import style
from undula.views.common.legends import fitting_legend
from undula.views.linear.growth import draw_points, set_span, start_at_zero

_REGIONS = (
    ("straight, monotone decay", style.GROUND),
    ("straight, rings", style.FOCUS),
    ("oscillates", style.UNSTABLE),
)
# Ratio of thresholds above which the axis is logarithmic.
_DECADES_FROM = 30.0


def threshold_figure(
    curve: CriticalCurve,
    *,
    title: str,
    units: style.UnitNames = style.FILAMENT,
    scales: Scales | None = None,
) -> Figure:
    """Draw Hopf force, oscillatory force and frequency at onset over a parameter.

    Parameters
    ----------
    curve : CriticalCurve
        The thresholds; a threshold without neighbours is drawn as a dot.
    title : str
        Title of the figure.
    units : mapping of str to str
        Names of the model's units, by quantity; by default those of a filament.
    scales : Scales, optional
        SI values of the dimensionless units, which the labels then state.

    Returns
    -------
    matplotlib.figure.Figure
        10 by 5.5 inches, not registered with pyplot.

    Examples
    --------
    >>> import undula
    >>> from undula.views import threshold_figure
    >>> model = undula.Filament(segments=8, load=undula.LinearLoad(75.0))
    >>> curve = undula.critical_curve(model, "load.slope", [0.0, 0.5])
    >>> figure = threshold_figure(curve, title="linear load")
    """
    paper_time = any(onset.paper_time for onset in curve.onsets)
    with style.figure_style(scales):
        figure = style.headed_figure(title, paper_time=paper_time)
        grid = figure.add_gridspec(
            2, 1, left=0.09, right=0.975, bottom=0.105, top=0.85, hspace=0.14, height_ratios=(5, 3)
        )
        upper = figure.add_subplot(grid[0])
        lower = figure.add_subplot(grid[1], sharex=upper)
        order = np.argsort(curve.values)
        places = curve.values[order]
        _draw_forces(upper, curve, order)
        draw_points(lower, places, curve.frequencies[order], style.Y_COLOUR, name="onset")
        set_span(upper, places)
        _add_legend(figure, upper)
        _note_gaps(lower, curve)
        start_at_zero(lower)
        lower.yaxis.set_major_locator(MaxNLocator(4))
        upper.tick_params(labelbottom=False)
        upper.set_ylabel(style.force_label(units))
        unit = style.frequency_in_brackets(paper_time=paper_time)
        lower.set_ylabel(f"frequency at onset\n{unit}")
        lower.set_xlabel(style.parameter_label(curve.parameter))
        figure.align_ylabels([upper, lower])
    return figure


def _draw_forces(axes: Axes, curve: CriticalCurve, order: NDArray[np.intp]) -> None:
    """Draw both thresholds and shade the regions between them."""
    places, hopf, ringing = (
        field[order] for field in (curve.values, curve.forces, curve.oscillatory_forces)
    )
    searched = np.array([curve.onsets[place].searched_to for place in order])
    low, high = _force_span(axes, np.concatenate([hopf, ringing]), searched)
    calm = np.where(np.isfinite(ringing), ringing, np.where(np.isfinite(hopf), hopf, searched))
    bounds = (
        (np.full_like(calm, low), calm),
        (ringing, np.where(np.isfinite(hopf), hopf, searched)),
        (hopf, np.full_like(hopf, high)),
    )
    for (bottom, top), (name, colour) in zip(bounds, _REGIONS, strict=True):
        # Between values with and without a Hopf force the edge of a region is unknown.
        for kind in (np.isfinite(hopf), np.isnan(hopf)):
            here = kind & (bottom <= top)
            axes.fill_between(places, bottom, top, where=here, color=colour, lw=0, gid=name)
    draw_points(axes, places, hopf, style.Y_COLOUR, name="Hopf force", width=2.2)
    draw_points(axes, places, ringing, style.X_COLOUR, name="oscillatory force", dashes="--")


def _force_span(axes: Axes, forces: Array, searched: Array) -> tuple[float, float]:
    """Set the limits of the force axis, logarithmic for thresholds of different decades."""
    finite = forces[np.isfinite(forces)]
    low, high = 0.0, 1.2 * float(finite.max() if finite.size else searched.max(initial=1.0))
    if finite.size and high > _DECADES_FROM * finite.min() > 0:
        low = float(finite.min()) / 2
        axes.set_yscale("log")
    axes.set_ylim(low, high)
    return low, high


def _add_legend(figure: Figure, axes: Axes) -> None:
    regions = [Patch(color=colour, label=name) for name, colour in _REGIONS]
    lines = axes.get_legend_handles_labels()[0]
    fitting_legend(figure, [*lines, *regions], (0.08, 0.935), handlelength=2.2)


def _note_gaps(axes: Axes, curve: CriticalCurve) -> None:
    """Write the end of the search for values without a Hopf force."""
    searched = [onset.searched_to for onset in curve.onsets if onset.hopf is None]
    if searched:
        text = rf"no loss of stability up to $F$ = {min(searched):.4g}"
        gaps = len(searched) < len(curve.onsets)
        axes.set_title(f"gaps: {text}" if gaps else text, loc="right")
