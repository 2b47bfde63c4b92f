"""Claims on settling and stepping: the values, the carrying over, the store, the command."""

import json
import math
import shutil
import signal
from collections.abc import Callable, Iterator
from dataclasses import asdict, fields, replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import xarray as xr

from commands import Ask, answer, refused
from refusal import complaint
from undula.analysis.ramps.ramp import Ramp, Step, ramp_steps
from undula.analysis.ramps.regime_changes import (
    Hysteresis,
    RegimeChange,
    hysteresis,
    nearest,
    regime_changes,
    regimes,
)
from undula.analysis.run_settings import Schedule
from undula.analysis.runs.last_period import SHAPES
from undula.app.cli import main
from undula.app.commands import step as stepping
from undula.inputs.ramp_input import read_ramp_input
from undula.inputs.ramp_values import parse_ramp
from undula.models.chain import Chain
from undula.models.filament import Filament
from undula.models.initial_states import kicked, planar, straight
from undula.models.loads.analytic import TipLoad
from undula.storage.ramp_file import load_ramp, stored_steps
from undula.views import ramp_diagram
from undula.views.ramp.gallery import chosen_steps, seen_from_aside

TWO = ["--set", "model.kind=chain", "--set", "model.links=2"]
PAIR = Chain(2, TipLoad(4.0))
#: Up through the onset at 6 and back, and beyond the values at which growth takes long.
THROUGH = ["--along", "load.force=4:8:1.5", "--down"]
SETTLE = Schedule(until="settled", limit=40.0)


pytestmark = pytest.mark.usefixtures("own_folder")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Give the folder of a series through the onset of two links, made once."""
    made = tmp_path_factory.mktemp("through")
    assert main(["step", *TWO, *THROUGH, "--out", str(made), "--json"]) == 0
    return made


@pytest.fixture(scope="module")
def series(folder: Path) -> xr.Dataset:
    return load_ramp(folder / "steps.nc")


def same_but_for_seconds(one: xr.Dataset, other: xr.Dataset) -> None:
    xr.testing.assert_identical(one.drop_vars("seconds"), other.drop_vars("seconds"))


# ---------------------------------------------------------------- values

NO_RANGE = (
    "has no 'KEY=START:STOP:COUNT'; write it like load.force=0:60:121, or load.force=0:60:0.5 for"
    " steps of 0.5"
)


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("0:0.3:0.1", (0.0, 0.1, 0.2, 0.3)),
        ("0:10:3.0", (0.0, 3.0, 6.0, 9.0)),
        ("2:1:0.5", (2.0, 1.5, 1.0)),
        ("2:1:-0.5", (2.0, 1.5, 1.0)),
        ("-1:1e0:1", (-1.0, 0.0, 1.0)),
    ],
)
def test_values_are_the_decimals_that_one_would_write(text: str, values: tuple[float, ...]) -> None:
    assert parse_ramp("--along", f" load.slope = {text}")[:2] == ("load.slope", values)


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("0:10:3", (0.0, 5.0, 10.0)),
        ("0:6:7", (0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0)),
        ("2:1:2", (2.0, 1.0)),
        ("0,1,7", (0.0, 1.0, 7.0)),
        ("7,1", (7.0, 1.0)),
        ("75", (75.0,)),
    ],
)
def test_a_whole_third_number_is_a_number_of_values_and_a_list_is_one(
    text: str, values: tuple[float, ...]
) -> None:
    assert parse_ramp("--along", f"load.force={text}")[:2] == ("load.force", values)


@pytest.mark.parametrize(
    ("text", "remark"),
    [
        ("0:60:20", "takes 20 values; for steps of that size write load.force=0:60:20.0"),
        ("0:60:1", "takes steps of 1; a later version may not, write load.force=0:60:1.0"),
        ("0:60:20.0", None),
        ("0:60:121", None),  # too long for a step
        ("0:6:3", None),  # in both ways the same
        ("0,20,60", None),
    ],
)
def test_a_text_that_was_once_read_in_another_way_gets_a_remark(
    text: str, remark: str | None
) -> None:
    said = parse_ramp("--along", f"load.force={text}").remark
    assert said == (remark and f"--along load.force={text} {remark}")


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("load.force", NO_RANGE),
        ("=0:60:1", NO_RANGE),
        ("load.force=0:6:x", NO_RANGE),
        ("load.force=0,1,0.5", "goes from 1 to 0.5; give values that rise, or values that fall"),
        ("load.force=1,1", "goes from 1 to 1; give values that rise, or values that fall"),
        ("load.force=3:3:4", "goes from 3 to 3; give values that rise, or values that fall"),
        ("load.force=3:3:1", "goes nowhere; give two different numbers to go between"),
        ("load.force=0:6:0.0", "has a step of 0, which leads nowhere; give a step above 0"),
        ("load.force=0:6:-1", "has a step that leads away from 6.0; leave out its sign"),
        ("load.force=0:6:7.0", "has a step longer than the whole way; give a shorter one"),
        (
            "load.force=0:1:9.999e-5",
            "takes more than 10000 steps; give a longer step or a shorter way",
        ),
    ],
)
def test_what_makes_no_steps_is_refused(text: str, why: str) -> None:
    assert complaint(lambda: parse_ramp("--along", text)) == f"--along {text} {why}"


@pytest.mark.parametrize("text", ["nan:6:1", "0:inf:1", "0:6:nan", "0:6:1e400"])
def test_a_number_that_is_not_finite_is_named(text: str) -> None:
    told = complaint(lambda: parse_ramp("--along", f"load.force={text}"))
    assert told.endswith("is not a finite number; give one")


def test_ten_thousand_steps_are_not_too_many() -> None:
    assert len(parse_ramp("--along", "load.force=0:1:1e-4")[1]) == 10_001


def test_the_way_back_goes_through_the_same_values() -> None:
    course = Ramp("load.force", (1.0, 2.0, 3.0), back=True)
    there = ((1.0, "up"), (2.0, "up"), (3.0, "up"))
    assert course.targets == (*there, (2.0, "down"), (1.0, "down"))
    falling = Ramp("load.slope", (1.0, 0.0), back=True)
    assert falling.targets == ((1.0, "down"), (0.0, "down"), (1.0, "up"))


@pytest.mark.parametrize("kick", [-1e-3, 1.6, math.nan, math.inf])
def test_a_kick_out_of_its_range_is_refused(kick: float) -> None:
    assert complaint(lambda: Ramp("load.force", (1.0, 2.0), kick=kick)) == (
        f"kick = {kick} is out of range; give an angle from 0 to pi/2 (radians)"
    )


def test_a_parameter_has_to_be_real_and_in_its_range() -> None:
    def models(parameter: str, *values: float) -> None:
        Ramp(parameter, values).models(PAIR)

    assert "along model.links; take load.force or" in complaint(lambda: models("model.links", 2, 3))
    assert "along load.frce; take load.force or" in complaint(lambda: models("load.frce", 2, 3))
    assert "drag_ratio = 0.5 has to be" in complaint(lambda: models("model.drag_ratio", 1, 0.5))


def test_joints_that_wind_up_are_not_stepped() -> None:
    winding = replace(PAIR, confined=True, spring="unwrapped")
    told = complaint(lambda: Ramp("load.force", (1.0, 2.0)).models(winding))
    assert "full turns between two steps; use model.spring = 'angle'" in told


def test_steps_settle_unless_the_input_gives_a_time() -> None:
    assert read_ramp_input().time.until == "settled"
    assert read_ramp_input(None, ["time.limit=3"]).time.limit == 3.0
    assert read_ramp_input(None, ["time.until=0.5"]).time.until == 0.5
    Path("timed.toml").write_text("[time]\nuntil = 2.0\n")
    assert read_ramp_input(Path("timed.toml")).time.until == 2.0
    chain = read_ramp_input(None, ["model.kind=chain", "model.links=3"])
    assert (chain.time.until, chain.time.limit) == ("settled", 90.0)


# ---------------------------------------------------------------- from step to step


def steps_of(model: Any, course: Ramp, start: Any, **schedule: Any) -> list[Step]:
    return list(ramp_steps(model, course, start, Schedule(**(asdict(SETTLE) | schedule))))


def test_a_kick_leaves_a_state_that_is_unstable_and_none_keeps_it() -> None:
    # Planar flapping of two links is unstable out of its plane (Ling, Guo & Kanso 2018).
    start = planar(PAIR, 0.1)
    kept = steps_of(PAIR, Ramp("load.force", (8.0, 9.0), kick=0.0), start)
    left = steps_of(PAIR, Ramp("load.force", (8.0, 9.0)), start)
    assert [step.verdict for step in kept] == ["planar flapping"] * 2
    assert [step.verdict for step in left] == ["spinning"] * 2


def test_each_step_begins_where_the_one_before_ended() -> None:
    start, course = kicked(PAIR, 0.3), Ramp("load.force", (2.0, 3.0), kick=0.0)
    one, two = steps_of(PAIR, course, start, until=0.5)
    again = steps_of(
        PAIR, Ramp("load.force", (3.0, 4.0), kick=0.0), PAIR.from_nodes(one.nodes), until=0.5
    )[0]
    np.testing.assert_array_equal(two.nodes, again.nodes)
    assert (one.status, one.time) == ("done", 0.5)


@pytest.mark.parametrize("kick", [1e-3, 1.5])
def test_a_kick_turns_no_link_by_more_than_it_says(kick: float) -> None:
    # A run this short, relative to the slowest motion of two links under no load, does not move
    # the chain by more than a thousandth of the kick.
    course = Ramp("load.force", (0.0, 1e-9), kick=kick)
    step = steps_of(PAIR, course, straight(PAIR), until=1e-5)[0]
    links = np.diff(step.nodes, axis=0)
    turned = np.arctan2(np.hypot(links[:, 0], links[:, 1]), links[:, 2])
    assert 0.99 * kick < turned.max() < 1.01 * kick


def test_kicks_differ_from_step_to_step_and_with_the_seed() -> None:
    def azimuths(seed: int) -> list[float]:
        course = Ramp("load.force", (0.0, 1e-9), kick=1e-2, seed=seed)
        steps = steps_of(PAIR, course, straight(PAIR), until=1e-5)
        tips = [steps[0].nodes[-1], steps[1].nodes[-1] - steps[0].nodes[-1]]
        return [math.atan2(tip[1], tip[0]) for tip in tips]

    drawn = [*azimuths(1), *azimuths(2)]
    assert len({round(angle, 3) for angle in drawn}) == 4
    assert azimuths(1) == drawn[:2]


def test_a_confined_model_stays_in_its_plane() -> None:
    flat = PAIR.with_(confined=True)
    for step in steps_of(flat, Ramp("load.force", (7.0, 8.0), kick=0.2), kicked(flat)):
        assert step.verdict == "planar flapping"
        assert step.planarity == 0.0
        assert not step.shapes[..., 1].any()


def test_a_filament_is_stepped_along_a_parameter_that_is_no_force() -> None:
    filament = Filament(4, TipLoad(75.0))
    course = Ramp("model.drag_ratio", (1.0, 1.5, 2.0))
    for step in steps_of(filament, course, kicked(filament), limit=2.0):
        assert step.verdict == "spinning"
        assert step.power_balance_error < 1e-5  # ten times rtol: errors of a step, added up


def test_shapes_go_once_round_and_end_at_the_end() -> None:
    step = steps_of(PAIR, Ramp("load.force", (8.0, 9.0)), kicked(PAIR, 0.1))[-1]
    assert step.shapes.shape == (SHAPES, 3, 3)
    np.testing.assert_array_equal(step.shapes[-1], step.nodes)
    azimuth = np.unwrap(np.arctan2(step.shapes[:, -1, 1], step.shapes[:, -1, 0]))
    # Nearest samples, some 200 a turn, of which half a distance may be missing at either end.
    assert abs(azimuth[-1] - azimuth[0]) == pytest.approx(
        2.0 * np.pi * (1.0 - 1.0 / SHAPES), abs=2.0 * np.pi / 150
    )
    assert np.all(np.diff(step.shape_times) > 0.0)


# ---------------------------------------------------------------- through the onset


def test_two_links_go_from_straight_to_spinning_at_six_and_back(series: xr.Dataset) -> None:
    verdicts = series["verdict"].values.tolist()
    assert series["value"].values.tolist() == [4.0, 5.5, 7.0, 5.5, 4.0]
    assert verdicts == ["straight", "straight", "spinning", "straight", "straight"]
    assert series["direction"].values.tolist() == ["up", "up", "up", "down", "down"]
    assert np.isfinite(series["frequency"].values).tolist() == [False, False, True, False, False]


def test_the_frequency_at_onset_is_two_over_pi() -> None:
    # Small displacements of both beads obey a matrix of trace 4 (F - 6) and determinant 16, so
    # that its eigenvalues at 6 K/L are +-4i: 4/(2 pi) cycles per T.
    forces = np.array([6.4, 6.7, 7.0])
    steps = steps_of(PAIR, Ramp("load.force", tuple(forces)), kicked(PAIR, 0.1))
    rates = [step.frequency for step in steps]
    # A parabola through three values, extended by twice their distance, to a part in a thousand.
    assert np.polyval(np.polyfit(forces, rates, 2), 6.0) == pytest.approx(2.0 / np.pi, rel=1e-3)


def test_the_answer_is_one_object_with_the_promised_keys(ask: Ask, folder: Path) -> None:
    found = answer(ask("step", *TWO, *THROUGH, "--out", str(folder), "--json"))
    assert found.keys() == {
        *("status", "parameter", "load", "units", "steps", "missing", "regimes", "changes"),
        *("hysteresis", "thresholds", "store", "figure"),
    }
    assert (found["status"], found["parameter"], found["missing"]) == ("done", "load.force", 0)
    assert found["units"]["force"] == "K/L"
    assert found["thresholds"] is None
    arrays = {"nodes", "shape_times", "shapes"}
    assert all(
        step.keys() == {field.name for field in fields(Step)} - arrays for step in found["steps"]
    )
    assert found["steps"][0]["frequency"] is None
    assert found["steps"][2]["bending_energy"].keys() == {"min", "max", "mean"}
    assert found["changes"] == [
        {"direction": "up", "before": "straight", "after": "spinning", "start": 5.5, "end": 7.0},
        {"direction": "down", "before": "spinning", "after": "straight", "start": 7.0, "end": 5.5},
    ]
    assert found["hysteresis"] == []
    assert found["store"] == str(folder / "steps.nc")
    assert Path(found["figure"]).read_bytes().startswith(b"\x89PNG")


def test_people_are_told_of_regimes_not_of_steps(ask: Ask, folder: Path) -> None:
    status, said, _ = ask("step", *TWO, *THROUGH, "--out", str(folder))
    assert status == 0
    lines = said.splitlines()
    assert lines[0] == (
        "chain of 2 links, tip load: load.force from 4 to 7 and back, 5 of 5 steps, done"
    )
    told = [" ".join(line.split()) for line in lines]
    assert "up 4 to 5.5 K/L: straight, 2 steps" in told
    assert "down 7 K/L: spinning, 1 step" in told
    assert "hysteresis none: up and down agree at every value" in told


@pytest.mark.slow
def test_thresholds_stand_beside_the_nearest_change(
    ask: Ask, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(stepping, "THRESHOLDS", ("onset", "spinning-lost"))
    words = ["step", *TWO, *THROUGH, "--out", str(folder), "--thresholds"]
    onset, lost = answer(ask(*words, "--json"))["thresholds"]
    # The closed form of the test above.
    assert onset["value"] == pytest.approx(6.0, rel=1e-12)
    assert onset["frequency"] == pytest.approx(2.0 / np.pi, rel=1e-12)
    assert onset["force_in"] == {"K/l": onset["value"] / 2, "B/L^2": onset["value"] * 2}
    assert onset["nearest_change"]["direction"] == "up"
    assert (onset["nearest_change"]["start"], onset["nearest_change"]["end"]) == (5.5, 7.0)
    assert (lost["value"], lost["nearest_change"]) == (None, None)
    assert lost["reason"].startswith("spinning is stable from force 6.12 up to force")
    assert "nearest change up: straight at 5.5, spinning at 7" in ask(*words)[1]


def test_thresholds_are_forces_only(ask: Ask) -> None:
    words = ["step", *TWO, "--along", "model.drag_ratio=1:2:2", "--thresholds"]
    assert refused(ask(*words)).startswith("--thresholds are values of load.force; step along that")


# ---------------------------------------------------------------- stopped and gone on with


def stopping_after(count: int) -> Callable[..., Iterator[Step]]:
    """Return a stand-in for the steps that sends Ctrl-C amid the step after so many."""

    def made(*given: Any, progress: Any, **options: Any) -> Iterator[Step]:
        done = 0

        def interrupt(run: Any) -> None:
            progress(run)
            if done == count:
                signal.raise_signal(signal.SIGINT)

        for step in ramp_steps(*given, progress=interrupt, **options):
            done += 1
            yield step

    return made


def test_an_interrupted_series_goes_on_to_the_same_end(
    ask: Ask, series: xr.Dataset, monkeypatch: pytest.MonkeyPatch
) -> None:
    words = ["step", *TWO, *THROUGH, "--out", "split", "--json"]
    for count, held in ((2, 2), (1, 3)):
        with monkeypatch.context() as patch:
            patch.setattr(stepping, "ramp_steps", stopping_after(count))
            stopped = ask(*words)
        found = answer(stopped, status=3)
        assert (found["status"], len(found["steps"]), found["missing"]) == (
            "interrupted",
            held,
            5 - held,
        )
        assert f"interrupted after {held} of 5 steps; the same command goes on" in stopped[2]
        assert load_ramp("split/steps.nc").sizes["step"] == held
    assert answer(ask(*words))["missing"] == 0
    same_but_for_seconds(load_ramp("split/steps.nc"), series)


def test_a_spent_budget_keeps_what_there_is(
    ask: Ask, series: xr.Dataset, monkeypatch: pytest.MonkeyPatch
) -> None:
    words = ["step", *TWO, *THROUGH, "--out", "cut", "--json"]
    nothing = answer(ask(*words, "--budget", "1e-9"), status=3)
    assert (nothing["status"], nothing["steps"], nothing["store"]) == ("out of time", [], None)
    with monkeypatch.context() as patch:
        patch.setattr(stepping, "ramp_steps", stopping_after(3))
        ask(*words)
    again = answer(ask(*words, "--budget", "1e-9"), status=3)
    assert (again["status"], len(again["steps"])) == ("out of time", 3)
    assert Path(again["figure"]).exists()
    answer(ask(*words))
    same_but_for_seconds(load_ramp("cut/steps.nc"), series)


def test_an_interruption_before_the_first_step_leaves_nothing(
    ask: Ask, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(stepping, "ramp_steps", stopping_after(0))
    assert ask("step", *TWO, *THROUGH, "--out", "none")[:2] == (130, "")
    assert not Path("none").exists()


def test_what_is_stored_is_read_bit_for_bit(series: xr.Dataset, folder: Path) -> None:
    steps = stored_steps(series)
    assert all(isinstance(step.verdict, str) and type(step.value) is float for step in steps)
    job_series, _ = stepping.plan(
        read_ramp_input(None, [TWO[1], TWO[3]]), THROUGH[1], back=True, kick=1e-3, seed=1
    )
    stepping.write_ramp(Path("copy.nc"), job_series, steps)
    assert Path("copy.nc").read_bytes() == (folder / "steps.nc").read_bytes()
    assert json.loads(series.attrs["input"])["model"]["links"] == 2
    assert series["bending_energy_max"].attrs["units"] == "K"


# ---------------------------------------------------------------- what is refused


@pytest.mark.parametrize(
    ("changed", "difference"),
    [
        (["--set", "time.rtol=1e-5"], "with time.rtol = 1e-06 instead of 1e-05"),
        (["--kick", "0.01"], "with kick = 0.001 instead of 0.01"),
        (["--seed", "2"], "with seed = 1 instead of 2"),
        (
            ["--along", "load.force=4:9:1.5"],
            'with along = "load.force from 4.0 to 7.0, 3 values" instead of'
            ' "load.force from 4.0 to 8.5, 4 values"',
        ),
    ],
)
def test_steps_of_another_series_are_refused_by_what_differs(
    ask: Ask, folder: Path, changed: list[str], difference: str
) -> None:
    path = folder / "steps.nc"
    before = path.read_bytes()
    assert refused(ask("step", *TWO, *THROUGH, *changed, "--out", str(folder))) == (
        f"{path} holds steps of another series, {difference}; give another --out, or start afresh"
        " with --overwrite"
    )
    assert path.read_bytes() == before


def test_steps_of_another_version_are_refused_by_both(ask: Ask, folder: Path) -> None:
    Path("old").mkdir()
    shutil.copy(folder / "steps.nc", "old/steps.nc")
    with h5py.File("old/steps.nc", "a") as file:
        versions = json.loads(file.attrs["versions"]) | {"undula": "0.0.1"}
        file.attrs["versions"] = json.dumps(versions)
    told = refused(ask("step", *TWO, *THROUGH, "--out", "old"))
    assert "was written by undula 0.0.1 and cannot be gone on with by undula" in told


def test_a_file_that_holds_no_steps_is_refused_and_can_be_replaced(ask: Ask, folder: Path) -> None:
    path = Path("other/steps.nc")
    path.parent.mkdir()
    whole = (folder / "steps.nc").read_bytes()
    foreign = xr.Dataset(attrs={"undula_format": "run 1"})
    foreign.to_netcdf("run.nc", engine="h5netcdf")
    for content, why in (
        (whole[: len(whole) // 2], "is cut short or damaged"),
        (b"hello", "is not a NetCDF4 file"),
        (Path("run.nc").read_bytes(), "is a result of another command ('run 1')"),
    ):
        path.write_bytes(content)
        told = refused(ask("step", *TWO, *THROUGH, "--out", "other"))
        assert told.startswith(f"{path} {why}; ")
        assert told.endswith("or start afresh with --overwrite")
        assert path.read_bytes() == content
    short = ["step", *TWO, "--along", "load.force=1:2:2", "--overwrite", "--out", "other"]
    assert ask(*short)[0] == 0
    assert load_ramp(path).sizes["step"] == 2


def test_a_folder_that_cannot_be_written_is_told_at_once(ask: Ask) -> None:
    Path("file").write_text("")
    told = refused(ask("step", *TWO, *THROUGH, "--out", "file"))
    assert told == "cannot write steps.nc in file (File exists); choose a writable folder"


def test_bad_input_is_one_object_too(ask: Ask) -> None:
    found = answer(ask("step", *TWO, "--along", "model.links=1:4:4", "--json"), status=2)
    assert found["status"] == "bad input"
    assert "nothing can be followed along model.links" in found["error"]


# ---------------------------------------------------------------- regimes


def told_as(series: xr.Dataset, *words: tuple[float, str, str]) -> list[Step]:
    """Return steps that are only their values, directions and verdicts."""
    one = stored_steps(series)[0]
    return [replace(one, value=v, direction=d, verdict=name) for v, d, name in words]


def test_changes_and_hysteresis_are_told_as_ranges(series: xr.Dataset) -> None:
    up = [(1.0, "up", "a"), (2.0, "up", "a"), (3.0, "up", "a"), (4.0, "up", "b")]
    down = [(3.0, "down", "b"), (2.0, "down", "b"), (1.0, "down", "a")]
    steps = told_as(series, *up, *down)
    changes = regime_changes(steps)
    assert changes == (
        RegimeChange("up", "a", "b", 3.0, 4.0),
        RegimeChange("down", "b", "a", 2.0, 1.0),
    )
    assert hysteresis(steps) == (Hysteresis(2.0, 3.0, "a", "b"),)
    assert [(one.direction, one.start, one.end, one.steps) for one in regimes(steps)] == [
        ("up", 1.0, 3.0, 3),
        ("up", 4.0, 4.0, 1),
        ("down", 4.0, 2.0, 3),
        ("down", 1.0, 1.0, 1),
    ]
    assert nearest(changes, 2.4) == changes[1]
    assert nearest(changes, 3.3) == changes[0]
    assert nearest((), 1.0) is None
    assert hysteresis(steps[:4]) == ()
    # A way back that has been cut short is compared as far as it goes.
    assert hysteresis(steps[:5]) == (Hysteresis(3.0, 3.0, "a", "b"),)


# ---------------------------------------------------------------- the figure


def drawn(figure: Any, name: str) -> list[Any]:
    return [a for axes in figure.axes for a in axes.get_children() if a.get_gid() == name]


def test_energies_are_filled_on_the_way_up_and_open_on_the_way_down(series: xr.Dataset) -> None:
    figure = ramp_diagram([series], thresholds=[{"onset": 6.0, "beyond": 70.0}])
    up, down = (drawn(figure, f"straight, {way}") for way in ("up", "down"))
    assert [line.get_xdata().tolist() for line in up] == [[4.0, 5.5]] * 2
    assert [line.get_xdata().tolist() for line in down] == [[5.5, 4.0]] * 2
    assert {line.get_mfc() for line in down} == {"none"}
    assert "none" not in {line.get_mfc() for line in up}
    spinning = drawn(figure, "spinning, up")
    bounds = [series[f"bending_energy_{bound}"].values[2] for bound in ("min", "max")]
    assert [line.get_ydata()[0] for line in spinning] == bounds
    assert [line.get_xdata()[0] for line in drawn(figure, "threshold")] == [6.0]
    words = [text.get_text() for text in figure.texts]
    assert "onset\n6" in words
    assert not any("beyond" in word for word in words)
    assert "chain of 2 links, tip load" in words


def test_several_series_are_columns_with_one_colour_a_verdict(series: xr.Dataset) -> None:
    other = series.copy(deep=True)
    other["verdict"] = ("step", np.array(["straight", "wobbling", "wobbling", "a", "b"]))
    figure = ramp_diagram([series, other, series], title="three")
    panels = [axes for axes in figure.axes if axes.get_xlabel()]
    assert [axes.get_xlabel() for axes in panels] == ["force $F$  $[K/L]$"] * 3
    colours = {line.get_mfc() for line in drawn(figure, "wobbling, up") + drawn(figure, "a, down")}
    assert len(drawn(figure, "wobbling, up")) == 2
    assert len(colours) == 2  # its own, and none of what is open
    assert {line.get_mfc() for line in drawn(figure, "straight, up")} == {"#6b6b6b"}


def test_nothing_in_the_figure_covers_anything_else(series: xr.Dataset) -> None:
    other = series.copy(deep=True)
    other["verdict"] = ("step", np.array(["straight", "modulated non-planar flapping", *"abc"]))
    for datasets in ([series], [other, series], [other] * 5):
        figure = ramp_diagram(datasets, thresholds=[{"onset": 6.0, "spinning-lost": 6.1}])
        figure.draw_without_rendering()
        cells = [axes.get_window_extent() for axes in figure.axes if axes.get_gid() == "cell"]
        panels = [axes.get_tightbbox() for axes in figure.axes if axes.get_xlabel()]
        words = [text.get_window_extent() for text in figure.texts if text.get_text()]
        legend = figure.legends[0].get_window_extent()
        boxes = [*cells, *panels, *words, legend]
        for place, one in enumerate(boxes):
            assert figure.bbox.containsx(one.x0) and figure.bbox.containsx(one.x1)  # noqa: PT018
            for another in boxes[place + 1 :]:
                # A pixel is no overlap.
                assert not one.padded(-1.0).overlaps(another.padded(-1.0))


def test_the_gallery_shows_every_regime_once_before_anything_twice() -> None:
    values = np.array([*range(10), *range(8, -1, -1)], dtype=float)
    verdicts = [*"aaaaaaabcc", *"cccaaaaaa"]
    back = np.arange(values.size) >= 10
    chosen = chosen_steps(values, verdicts, back, 5)
    # Three regimes there; back, only what differs from there: "c" at 7 and at 6.
    assert {verdicts[k] for k in chosen if not back[k]} == {"a", "b", "c"}
    assert len([k for k in chosen if back[k]]) == 1
    assert len(chosen) == 5
    assert chosen_steps(values, verdicts, back, 1) != []
    assert len(chosen_steps(values[:2], verdicts[:2], back[:2], 7)) == 2


def test_a_planar_motion_is_seen_across_its_plane() -> None:
    shapes = np.array([[[0.0, 0.0, 0.0], [0.6, 0.8, 1.0]], [[0.0, 0.0, 0.0], [-0.6, -0.8, 1.0]]])
    seen = seen_from_aside(shapes)
    np.testing.assert_allclose(np.abs(seen[:, 1, 0]), 1.0)
    np.testing.assert_allclose(seen[:, 1, 1], np.cos(np.deg2rad(20.0)))


def test_series_that_cannot_be_drawn_are_refused(series: xr.Dataset) -> None:
    assert "datasets is empty" in complaint(lambda: ramp_diagram([]))
    other = series.assign_attrs(parameter="model.drag_ratio")
    assert complaint(lambda: ramp_diagram([series, other])) == (
        "the series are along load.force and model.drag_ratio: give series along one parameter"
    )
    assert "lacks shapes: give a result of `undula step`" in complaint(
        lambda: ramp_diagram([series.drop_vars("shapes")])
    )
