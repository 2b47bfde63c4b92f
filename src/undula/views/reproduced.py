"""Figures of the paper, drawn from answers of commands."""

from collections.abc import Callable, Mapping

import xarray as xr
from matplotlib.figure import Figure

from undula.views.answered_thresholds import threshold_lines
from undula.views.bistability import bistability
from undula.views.energies import bending_energies
from undula.views.exponents import lyapunov
from undula.views.force_profiles import force_profiles
from undula.views.frequencies import frequencies
from undula.views.slowness import slowness
from undula.views.steps import step_diagram
from undula.views.stored_windings import windings
from undula.views.two_motions import transition, two_links


def stepped(*series: xr.Dataset) -> Figure:
    """Draw stored series of steps side by side, as `step_diagram` does."""
    return step_diagram(series)


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
