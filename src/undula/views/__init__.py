"""Figures and movies of results: pure functions, and the only users of plotting libraries."""

from undula.views.bifurcation import bifurcation_diagram
from undula.views.growth import growth_figure
from undula.views.movie import movie
from undula.views.portrait import portrait
from undula.views.stability import stability_portrait
from undula.views.steps import step_diagram
from undula.views.threshold_curves import threshold_curves
from undula.views.thresholds import threshold_figure

__all__ = [
    "bifurcation_diagram",
    "growth_figure",
    "movie",
    "portrait",
    "stability_portrait",
    "step_diagram",
    "threshold_curves",
    "threshold_figure",
]
