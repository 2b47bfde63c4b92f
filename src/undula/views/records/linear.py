"""Figures of linear stability and of curves of thresholds."""

from collections.abc import Callable
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from undula.analysis.linear.curves import CriticalCurve, GrowthCurve
from undula.analysis.linear.results import Spectrum
from undula.analysis.solvers.threshold_record import ThresholdCurve
from undula.views.common import style
from undula.views.linear.growth import growth_figure
from undula.views.linear.threshold_curves import threshold_curves
from undula.views.linear.thresholds import threshold_figure


def spectrum(record: Spectrum, ax: Axes | None) -> Figure | Axes:
    """Draw the eigenvalues in the complex plane; those right of the axis grow."""

    def draw(axes: Axes) -> None:
        axes.plot(record.rates, record.values.imag, "o", ms=5)
        axes.axvline(0.0, color="0.6", lw=0.8)
        axes.set_xlabel("growth rate [1/T]")
        axes.set_ylabel("angular frequency [1/T]")

    return _drawn(draw, ax)


def growth(record: GrowthCurve, ax: Axes | None) -> Figure | Axes:
    """Draw the leading growth rate over the force."""
    if ax is None:
        return growth_figure(record, title="leading disturbance of the straight state")

    def draw(axes: Axes) -> None:
        axes.plot(record.forces, record.rates.T)
        axes.axhline(0.0, color="0.6", lw=0.8)
        axes.set_xlabel(style.force_label(style.FILAMENT))
        axes.set_ylabel(style.growth_rate_label(paper_time=record.paper_time))

    return _drawn(draw, ax)


def critical(record: CriticalCurve, ax: Axes | None) -> Figure | Axes:
    """Draw the force of the onset over the parameter."""
    if ax is None:
        return threshold_figure(record, title="onset of the straight state")
    return _over(record.parameter, record.values, record.forces, ax)


def curve(record: ThresholdCurve, ax: Axes | None) -> Figure | Axes:
    """Draw the forces of a threshold over the parameter."""
    if ax is None:
        line = (record.kind, record.parameter_values, record.forces, record.errors)
        return threshold_curves([line], parameter=record.parameter, title=record.kind)
    return _over(record.parameter, record.parameter_values, record.forces, ax)


def _over(parameter: str, values: Any, forces: Any, ax: Axes) -> Axes:
    ax.plot(values, forces, "o-", ms=3)
    ax.set_xlabel(style.parameter_label(parameter))
    ax.set_ylabel(style.force_label(style.FILAMENT))
    return ax


def _drawn(draw: Callable[[Axes], None], ax: Axes | None) -> Figure | Axes:
    if ax is not None:
        draw(ax)
        return ax
    with style.figure_style():
        figure = Figure(figsize=(6.0, 4.0), layout="constrained")
        draw(figure.add_subplot())
    return figure
