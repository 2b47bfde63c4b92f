"""Figures of the paper, drawn from answers of commands."""

from collections.abc import Callable, Mapping

import xarray as xr
from matplotlib.figure import Figure

from undula.reproduction.figures.answered_thresholds import threshold_lines
from undula.reproduction.figures.bistability import bistability
from undula.reproduction.figures.energies import bending_energies
from undula.reproduction.figures.exponents import lyapunov
from undula.reproduction.figures.force_profiles import force_profiles
from undula.reproduction.figures.frequencies import frequencies
from undula.reproduction.figures.slowness import slowness
from undula.reproduction.figures.stored_windings import windings
from undula.reproduction.figures.two_motions import transition, two_links
from undula.views.ramp.figure import ramp_diagram


def stepped(*series: xr.Dataset) -> Figure:
    """Draw stored series of steps side by side, as `ramp_diagram` does."""
    return ramp_diagram(series)


#: Figures by their names in the catalogue; each takes the results of its tasks, in their order.
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
