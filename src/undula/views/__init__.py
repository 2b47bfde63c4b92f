"""Figures and movies of results: pure functions, and the only users of plotting libraries."""

from undula.views.movie import movie
from undula.views.portrait import portrait

__all__ = ["movie", "portrait"]
