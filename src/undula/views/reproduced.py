"""Figures of the paper, drawn from answers of commands."""

from collections.abc import Callable, Mapping

import xarray as xr
from matplotlib.figure import Figure

from undula.views import style
from undula.views.answered_thresholds import threshold_lines
from undula.views.bistability import bistability
from undula.views.energies import bending_energies
from undula.views.exponents import lyapunov
from undula.views.force_profiles import force_profiles
from undula.views.frequencies import frequencies
from undula.views.lettered_panels import legend_above
from undula.views.slowness import slowness
from undula.views.steps import step_diagram
from undula.views.stored_windings import windings
from undula.views.two_motions import transition, two_links


def stepped(*series: xr.Dataset) -> Figure:
    """Draw stored series of steps side by side, as `step_diagram` does."""
    figure = step_diagram(series)
    legend = figure.legends[0]
    if len(series) > 1 and legend.get_window_extent().x1 > figure.bbox.x1:
        # Several series have no title; where it would stand there is room for a second row.
        handles = [handle for handle in legend.legend_handles if handle is not None]
        for handle, text in zip(handles, legend.get_texts(), strict=True):
            handle.set_label(text.get_text())
        legend.remove()
        with style.figure_style():
            legend_above(figure, handles, 0.024)
    return figure


#: By the name that the catalogue uses; each takes what its tasks came to, one argument a task.
VIEWS: Mapping[str, Callable[..., Figure]] = {
    "bending_energies": bending_energies,
    "bistability": bistability,
    "force_profiles": force_profiles,
    "frequencies": frequencies,
    "lyapunov": lyapunov,
    "slowness": slowness,
    "stepped": stepped,
    "threshold_lines": threshold_lines,
    "transition": transition,
    "two_links": two_links,
    "windings": windings,
}
