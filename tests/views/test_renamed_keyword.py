"""Views of sweeps take the former keyword of their stability boundaries, with a warning."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure

from sweeps import made_up
from undula.analysis.maps.basins import basins
from undula.views import basin_diagram, mean_paths, phase_diagram, phase_page

AXES = {"load.exponent": (0.0, 1.0), "load.force": (20.0, 40.0, 80.0)}
STORE = made_up(AXES, lambda *_: "spinning", tries=2, shapes=True)
BOUNDARIES = [("onset", np.array([0.0, 1.0]), np.array([30.0, 31.0]))]


def content(drawn: Figure | str) -> Any:
    """Return a page, or the data of the lines of a figure by their names."""
    if isinstance(drawn, str):
        return drawn
    lines = [line for axes in drawn.axes for line in axes.lines]
    return [(str(line.get_gid()), line.get_xydata().tolist()) for line in lines]


@pytest.mark.parametrize(
    ("draw", "store"),
    [
        (phase_diagram, STORE),
        (basin_diagram, basins(STORE)),
        (mean_paths, STORE),
        (phase_page, STORE),
    ],
)
def test_the_former_keyword_warns_and_draws_the_same(
    draw: Callable[..., Figure | str], store: xr.Dataset
) -> None:
    present = content(draw(store, boundaries=BOUNDARIES))
    assert present != content(draw(store))
    with pytest.warns(DeprecationWarning, match=f"borders of {draw.__name__} is now boundaries"):
        former = content(draw(store, borders=BOUNDARIES))
    assert former == present


def test_both_names_of_a_keyword_are_refused() -> None:
    draw: Callable[..., Figure] = phase_diagram
    warned = pytest.warns(DeprecationWarning, match="now boundaries")
    with warned, pytest.raises(TypeError, match="multiple values"):
        draw(STORE, borders=BOUNDARIES, boundaries=BOUNDARIES)


def test_an_unknown_keyword_is_still_refused() -> None:
    draw: Callable[..., Figure] = phase_diagram
    with pytest.raises(TypeError, match="edges"):
        draw(STORE, edges=BOUNDARIES)
