"""Records: shown in one line and as a table, drawn, labelled, stored and read back."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure

import undula as un
from refusal import complaint

MODEL = un.Filament(segments=4, load=un.TipLoad(75.0))
#: Longest line of a record in characters.
LONGEST = 200


def spinning() -> Any:
    return un.find(MODEL, "spinning")


MAKERS: dict[str, Any] = {
    "onset": lambda: un.onset(MODEL),
    "spectrum": lambda: un.spectrum(MODEL),
    "growth": lambda: un.growth_curve(MODEL, [20.0, 40.0, 60.0]),
    "critical": lambda: un.critical_curve(MODEL, "model.drag_ratio", [1.0, 2.0]),
    "spinning": spinning,
    "flapping": lambda: un.find(MODEL.with_(confined=True), "flapping"),
    "not found": lambda: un.find(MODEL.with_(force=20.0), "spinning"),
    "branch": lambda: un.follow(spinning(), "load.force", to=90.0),
    "threshold": lambda: un.threshold(MODEL, "onset"),
    "curve": lambda: un.threshold(MODEL, "onset", along=("model.drag_ratio", [1.0, 2.0])),
    "sensitivities": lambda: un.sensitivities(spinning(), parameters=["load.force"]),
    "ramp": lambda: un.ramp(MODEL, "load.force", [5.0, 10.0], samples=200, limit=0.5),
    "run": lambda: un.integrate(MODEL, un.kicked(MODEL, 0.1), until=0.05, samples=200),
}


@pytest.fixture(scope="module")
def records() -> dict[str, Any]:
    return {name: make() for name, make in MAKERS.items()}


@pytest.mark.parametrize("name", MAKERS)
def test_a_record_is_shown_in_one_line(name: str, records: dict[str, Any]) -> None:
    line = repr(records[name])
    assert line == str(records[name])
    assert "\n" not in line
    assert len(line) <= LONGEST


@pytest.mark.parametrize("name", MAKERS)
def test_a_record_is_a_table_in_a_notebook(name: str, records: dict[str, Any]) -> None:
    html = records[name]._repr_html_()
    assert html.startswith("<div")
    assert "<table" in html
    assert "<script" not in html
    assert ("<img" in html) == records[name].has_figure
    assert html.count("alt=") == html.count("<img")


@pytest.mark.parametrize("name", MAKERS)
def test_a_record_is_drawn_anew_or_into_axes_or_says_that_it_has_no_figure(
    name: str, records: dict[str, Any]
) -> None:
    record = records[name]
    if not record.has_figure:
        assert "no figure" in complaint(record.plot)
        return
    assert isinstance(record.plot(), Figure)
    axes = Figure().add_subplot()
    assert record.plot(ax=axes) is axes
    assert axes.has_data()


@pytest.mark.parametrize("name", MAKERS)
def test_a_record_is_a_labelled_dataset(name: str, records: dict[str, Any]) -> None:
    dataset = records[name].to_xarray()
    assert isinstance(dataset, xr.Dataset)
    assert len(dataset.variables) > 0


@pytest.mark.parametrize(
    "name", ["spectrum", "growth", "critical", "branch", "curve", "sensitivities", "ramp"]
)
def test_tables_are_frames(name: str, records: dict[str, Any]) -> None:
    frame = records[name].to_dataframe()
    assert len(frame) > 0
    assert not frame.isna().all(axis=None)


def alike(left: Any, right: Any) -> bool:
    """Return whether two records have the same fields, bit for bit."""
    if isinstance(left, np.ndarray):
        return bool(np.array_equal(left, right, equal_nan=left.dtype.kind in "fc"))
    if isinstance(left, tuple):
        return len(left) == len(right) and all(map(alike, left, right))
    if hasattr(left, "__dataclass_fields__"):
        names = left.__dataclass_fields__
        return type(left) is type(right) and all(
            alike(getattr(left, name), getattr(right, name)) for name in names
        )
    return bool(left == right) or (left != left and right != right)


@pytest.mark.parametrize("name", [name for name in MAKERS if name not in ("run", "ramp")])
def test_what_is_saved_is_loaded_bit_for_bit(
    name: str, records: dict[str, Any], tmp_path: Path
) -> None:
    file = tmp_path / "record.nc"
    records[name].save(file)
    again = un.load(file)
    assert repr(again) == repr(records[name])
    assert alike(again, records[name])
    with xr.open_dataset(file, engine="h5netcdf") as stored:
        assert "record" in stored.attrs


def test_a_run_is_saved_as_the_command_stores_it(records: dict[str, Any], tmp_path: Path) -> None:
    records["run"].save(tmp_path / "run.nc")
    stored = un.load(tmp_path / "run.nc")
    assert isinstance(stored, xr.Dataset)
    np.testing.assert_array_equal(stored["nodes"].values, records["run"].motion.nodes)
    assert isinstance(un.views.portrait(records["run"]), Figure)


def test_a_file_of_others_stays(records: dict[str, Any], tmp_path: Path) -> None:
    file = tmp_path / "onset.nc"
    file.write_text("mine")
    assert "onset.nc" in complaint(lambda: records["onset"].save(file))
    assert file.read_text() == "mine"
    assert "end in .nc" in complaint(lambda: records["onset"].save(tmp_path / "onset.txt"))


def test_a_function_cannot_be_stored(tmp_path: Path) -> None:
    model = un.Filament(4, un.ProfileLoad(75.0, density=lambda s: 1.0 + s))
    threshold = un.threshold(model, "onset")
    assert "TableLoad" in complaint(lambda: threshold.save(tmp_path / "onset.nc"))
    assert not (tmp_path / "onset.nc").exists()


def test_a_damaged_record_is_refused(records: dict[str, Any], tmp_path: Path) -> None:
    file = tmp_path / "onset.nc"
    records["onset"].save(file)
    content = bytearray(file.read_bytes())
    content[len(content) // 2] ^= 1
    file.write_bytes(bytes(content))
    assert "damaged" in complaint(lambda: un.load(file))


def test_a_file_cannot_choose_what_is_made() -> None:
    from undula.storage.record_fields import decoded

    with pytest.raises(KeyError):
        decoded(["record", "Popen", {"args": "true"}], lambda number: number)


def test_bifurcations_are_known_by_name() -> None:
    state = un.find(un.Filament(8, un.TipLoad(130.0)), "spinning")
    branch = un.follow(state, "load.force", to=150.0)
    lost = branch.bifurcations["spinning-lost"]
    assert branch.bifurcations["torus"] is lost
    assert branch.bifurcations[0] is lost
    with pytest.raises(KeyError, match=r"spinning-lost \(torus\)"):
        branch.bifurcations["flapping-lost"]
    assert len(branch) == len(branch.values)
    assert branch[0] is branch.states[0]
