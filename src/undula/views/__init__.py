"""Figures, movies and pages of results; the only users of plotting libraries."""

from undula.views.branches.bifurcation import bifurcation_diagram
from undula.views.linear.growth import growth_figure
from undula.views.linear.stability import stability_portrait
from undula.views.linear.threshold_curves import threshold_curves
from undula.views.linear.thresholds import threshold_figure
from undula.views.ramp.figure import ramp_diagram
from undula.views.run.movie import movie
from undula.views.run.portrait import portrait
from undula.views.run.winding import TipAngleSeries, winding_figure
from undula.views.sweep.basins import basin_diagram
from undula.views.sweep.diagram import phase_diagram
from undula.views.sweep.gallery import gallery
from undula.views.sweep.mean_paths import mean_paths
from undula.views.sweep.page import phase_page

__all__ = [
    "TipAngleSeries",
    "basin_diagram",
    "bifurcation_diagram",
    "gallery",
    "growth_figure",
    "mean_paths",
    "movie",
    "phase_diagram",
    "phase_page",
    "portrait",
    "ramp_diagram",
    "stability_portrait",
    "threshold_curves",
    "threshold_figure",
    "winding_figure",
]


def __dir__() -> list[str]:
    return sorted(__all__)
