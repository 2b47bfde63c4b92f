"""Figures of the paper, drawn from answers of commands."""

from collections.abc import Callable, Mapping

from matplotlib.figure import Figure

#: By the name that the catalogue uses; each takes the answers that it is of.
VIEWS: Mapping[str, Callable[..., Figure]] = {}
