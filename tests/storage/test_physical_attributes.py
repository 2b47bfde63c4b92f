"""Claims on stored results that state physical units: runs, ramps and sweeps of few links."""

import json
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import undula as un
from small_sweeps import QUICK, sweep_of
from undula.analysis.observables.shapes import Range
from undula.analysis.ramps.ramp import Ramp, Step
from undula.models.units import FILAMENT_UNITS
from undula.schema.physical_units import UNITS_PHYSICAL
from undula.storage.physical_attributes import with_physical_attributes
from undula.storage.ramp_file import Series, dataset_of_steps
from undula.sweeps.store import load_sweep, open_sweep

SCALES = un.Scales()
NAMES = FILAMENT_UNITS.names()
UNITS = '[units]\nlength = "12 um"\nstiffness = "25 pN um^2"\n'
AXIS = '[[study.axes]]\nkey = "load.force"\nvalues = ["5 pN", 80]\n'


def factor_of(variable: xr.DataArray) -> tuple[float, str]:
    return variable.attrs["physical_factor"], variable.attrs["physical_unit"]


def made(*variables: tuple[str, str]) -> xr.Dataset:
    return xr.Dataset({name: ("x", [1.0], {"units": unit}) for name, unit in variables})


def test_a_variable_has_the_factor_of_its_unit() -> None:
    dataset = made(("energy", "B/L"), ("time", "L^4 zeta_perp / B"), ("angle", "rad"))
    stored = with_physical_attributes(dataset, SCALES, NAMES)
    assert factor_of(stored["energy"]) == (pytest.approx(40.0), "pN um")
    assert factor_of(stored["time"]) == (pytest.approx(SCALES.time), "s")
    assert stored["angle"].attrs == {"units": "rad"}
    assert json.loads(stored.attrs[UNITS_PHYSICAL]) == SCALES.units()


def test_without_scales_a_result_stays_as_it_is() -> None:
    dataset = made(("energy", "B/L"))
    assert with_physical_attributes(dataset, None, NAMES) is dataset


def test_every_variable_of_a_run_with_a_unit_has_a_physical_one() -> None:
    model = un.Filament(4, load=un.TipLoad(0.0))
    run = un.integrate(model, un.planar(model, 0.1), until=0.001, samples=3)
    stored = with_physical_attributes(un.dataset_of(run), SCALES, model.units.names())
    with_unit = [v for v in stored.variables.values() if v.attrs.get("units", "rad") != "rad"]
    assert len(with_unit) > 5
    assert all(variable.attrs["physical_factor"] > 0.0 for variable in with_unit)


def test_a_ramp_states_its_values_in_physical_units() -> None:
    model = un.Filament(4, load=un.TipLoad(0.0))
    ramp, extent = Ramp("load.force", (1.0,)), Range(0.0, 0.0, 0.0)
    fields = dict.fromkeys(Step.__dataclass_fields__, 0.0) | {
        **dict.fromkeys(("bending_energy", "tip_radius", "tip_height"), extent),
        "nodes": np.zeros((5, 3)),
        "shape_times": np.zeros(2),
        "shapes": np.zeros((2, 5, 3)),
    }
    series = Series({}, "tip load", model, ramp, SCALES)
    stored = dataset_of_steps(series, [Step(**fields)])
    assert factor_of(stored["value"]) == (pytest.approx(2.0), "pN")
    assert factor_of(stored["bending_energy_max"]) == (pytest.approx(40.0), "pN um")


def test_a_sweep_states_axes_and_variables_in_physical_units(tmp_path: Path) -> None:
    sweep = sweep_of(tmp_path, QUICK + UNITS + AXIS)
    open_sweep(tmp_path / "s.zarr", sweep)
    stored = load_sweep(tmp_path / "s.zarr")
    force = stored["load.force"]
    factor, unit = factor_of(force)
    assert (force.values * factor).tolist() == pytest.approx([5.0, 80 * 25 / 144])
    assert (unit, force.attrs["units"]) == ("pN", "B/L^2")
    assert factor_of(stored["frequency"])[1] == "Hz"
    assert factor_of(stored["lyapunov"])[1] == "1/s"
    assert json.loads(stored.attrs[UNITS_PHYSICAL])["length"] == {"value": 12.0, "unit": "um"}


def test_the_units_of_a_sweep_are_compared_only_where_they_are_given(tmp_path: Path) -> None:
    axis = AXIS.replace('"5 pN"', "5")
    assert "units" not in sweep_of(tmp_path, QUICK + axis).dump()
    with_units = sweep_of(tmp_path, QUICK + UNITS + axis).dump()
    assert with_units.pop("units")["length"] == "12 um"
    assert with_units == sweep_of(tmp_path, QUICK + axis).dump()


def test_a_sweep_without_units_states_no_physical_ones(tmp_path: Path) -> None:
    open_sweep(tmp_path / "s.zarr", sweep_of(tmp_path, QUICK + AXIS.replace('"5 pN"', "5")))
    stored = load_sweep(tmp_path / "s.zarr")
    assert UNITS_PHYSICAL not in stored.attrs
    assert stored["load.force"].attrs == {}
    assert "physical_unit" not in stored["frequency"].attrs
