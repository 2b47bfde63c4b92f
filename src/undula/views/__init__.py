"""Figures and movies of results: pure functions, and the only users of plotting libraries."""

from undula.views.basin_diagram import basin_diagram
from undula.views.bifurcation import bifurcation_diagram
from undula.views.growth import growth_figure
from undula.views.mean_paths import mean_paths
from undula.views.movie import movie
from undula.views.phase_diagram import phase_diagram
from undula.views.phase_gallery import gallery
from undula.views.phase_page import phase_page
from undula.views.portrait import portrait
from undula.views.stability import stability_portrait
from undula.views.steps import step_diagram
from undula.views.threshold_curves import threshold_curves
from undula.views.thresholds import threshold_figure
from undula.views.winding import Winding, winding_figure

__all__ = [
    "Winding",
    "basin_diagram",
    "bifurcation_diagram",
    "gallery",
    "growth_figure",
    "mean_paths",
    "movie",
    "phase_diagram",
    "phase_page",
    "portrait",
    "stability_portrait",
    "step_diagram",
    "threshold_curves",
    "threshold_figure",
    "winding_figure",
]
