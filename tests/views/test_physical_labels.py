"""Claims on labels of figures that state physical units."""

import json

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure

from undula.analysis.linear.curves import CriticalCurve, GrowthCurve
from undula.analysis.linear.results import Onset
from undula.models.scales import Scales
from undula.models.units import FILAMENT_UNITS, chain_units
from undula.schema.physical_units import UNITS_PHYSICAL
from undula.views import growth_figure, threshold_curves, threshold_figure
from undula.views.common import style
from undula.views.common.physical_labels import equal_to, in_physical, labelled, physical_units_of
from undula.views.sweep.page_traces import plain

NAMES = FILAMENT_UNITS.names()
FORCES = np.array([10.0, 20.0])
GROWTH = GrowthCurve(FORCES, -FORCES, FORCES, 0 * FORCES, "spectral")


def labels() -> dict[str, str]:
    return {
        "force": style.force_label(NAMES),
        "energy": style.energy_label(NAMES),
        "power": style.power_label(NAMES),
        "time": style.time_label(NAMES),
        "tip": style.tip_label(),
        "rate": style.growth_rate_label(paper_time=False),
        "frequency": style.frequency_label(paper_time=False),
        "position": style.parameter_label("load.position"),
    }


def texts(figure: Figure) -> list[str]:
    return [text for axes in figure.axes for text in (axes.get_xlabel(), axes.get_ylabel())]


def test_a_label_states_the_physical_value_of_its_unit() -> None:
    with style.figure_style(Scales()):
        stated = {name: " ".join(plain(label).split()) for name, label in labels().items()}
    assert stated == {
        "force": "force F [B/L²=2 pN]",
        "energy": "bending energy E [B/L =40 pN µm]",
        "power": "power P [B/(LT) =73.29 pN µm/s]",
        "time": "time t [T=ζ⊥ L⁴/B=0.5458 s]",
        "tip": "tip position x, y, z [L=20 µm]",
        "rate": "growth rate Re sigma [1/T=1.832 s⁻¹]",
        "frequency": "frequency [cycles per T =1.832 Hz]",
        "position": "position sₐ [L=20 µm]",
    }


def test_without_scales_labels_are_dimensionless_also_after_a_figure_with_some() -> None:
    before = labels()
    with style.figure_style(Scales()), style.figure_style():
        assert labels() == before
    with pytest.raises(RuntimeError), style.figure_style(Scales()):
        raise RuntimeError
    assert labels() == before
    assert all("=" not in label for name, label in before.items() if name != "time")


def test_the_time_unit_of_the_printed_equation_has_no_physical_value() -> None:
    with style.figure_style(Scales()):
        assert "=" not in style.frequency_label(paper_time=True)
        assert "=" not in style.growth_rate_label(paper_time=True)


def test_a_number_stands_in_brackets_in_its_unit() -> None:
    with labelled(Scales().units()):
        assert in_physical("frequency", 77.4) == " (141.8 Hz)"
        assert in_physical("length", 0.5) == " (10 µm)"
    assert in_physical("frequency", 77.4) == equal_to("force") == ""


def test_a_stored_result_states_its_own_units() -> None:
    stored = xr.Dataset(attrs={UNITS_PHYSICAL: json.dumps(Scales().units())})
    assert physical_units_of(stored) == Scales().units()
    assert physical_units_of(xr.Dataset()) is physical_units_of(None) is None


@pytest.mark.parametrize("scales", [None, Scales()])
def test_figures_of_linear_stability_state_the_force_as_asked(scales: Scales | None) -> None:
    curve = CriticalCurve(
        "load.slope", FORCES, (Onset(None, None, None, (), 80.0, "spectral"),) * 2
    )
    drawn = [
        growth_figure(GROWTH, title="made up", scales=scales),
        threshold_figure(curve, title="made up", scales=scales),
        threshold_curves(
            [("onset", FORCES, FORCES, FORCES)],
            parameter="load.slope",
            title="made up",
            scales=scales,
        ),
    ]
    for figure in drawn:
        (force,) = {text for text in texts(figure) if text.startswith("force")}
        assert ("pN" in force) == (scales is not None)


def test_labels_of_chains_are_never_physical() -> None:
    with style.figure_style():
        assert "=" not in style.force_label(chain_units(3).names())
