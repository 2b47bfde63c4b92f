"""Inputs become models, starts and schedules: nothing is lost or changed on the way."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import undula as un
from refusal import complaint
from undula.analysis.run_settings import Schedule
from undula.inputs.build import build_model, build_schedule, build_start
from undula.inputs.input import parse_input, read_input
from undula.storage.run_file import write_run

LOADS = [
    ({"profile": "tip"}, un.TipLoad(75.0)),
    ({"profile": "point", "force": 80.0, "position": 0.6}, un.PointLoad(80.0, 0.6)),
    ({"profile": "linear", "slope": -0.5}, un.LinearLoad(75.0, -0.5)),
    ({"profile": "power", "exponent": 2.0}, un.PowerLoad(75.0, 2.0)),
    (
        {"profile": "table", "s": [0, 0.3, 1], "density": [1, 2, 0.5]},
        un.TableLoad(75.0, (0.0, 0.3, 1.0), (1.0, 2.0, 0.5)),
    ),
]
SMALL = {"segments": 8}


def state_of(start: dict[str, Any], **model: Any) -> tuple[un.Filament, np.ndarray]:
    wanted = parse_input({"model": SMALL | model, "start": start})
    filament = build_model(wanted)
    return filament, build_start(wanted, filament)


def stored(path: Path, angle: float = 0.0) -> np.ndarray:
    """Store a short run of 8 links that starts in a plane; return its last nodes."""
    filament = un.Filament(segments=8, load=un.TipLoad(75.0))
    run = un.integrate(filament, un.planar(filament, 0.5, angle=angle), until=1e-3, samples=3)
    write_run(path, un.dataset_of(run), run.checkpoint)
    return run.motion.nodes[-1]


@pytest.mark.parametrize(("table", "load"), LOADS)
def test_each_profile_becomes_its_load(table: dict[str, Any], load: un.Load) -> None:
    assert build_model(parse_input({"load": table})).load == load


def test_every_key_of_the_model_arrives() -> None:
    table = {
        "segments": 12,
        "drag_ratio": 1.5,
        "inextensibility": "weak",
        "tensile_stiffness": 1e3,
        "confined": True,
    }
    wanted = parse_input({"model": table, "start": {"shape": "planar"}})
    assert build_model(wanted) == un.Filament(12, un.TipLoad(75.0), 1.5, "weak", 1e3, True)


def test_the_defaults_are_those_of_the_library() -> None:
    wanted = read_input()
    model = build_model(wanted)
    assert model == un.Filament(segments=40, load=un.TipLoad(75.0))
    assert build_schedule(wanted) == Schedule()
    np.testing.assert_array_equal(build_start(wanted, model), un.kicked(model))


def test_every_key_of_the_time_arrives() -> None:
    table = {"until": "settled", "limit": 3.0, "samples": 7, "rtol": 1e-5, "atol": 1e-8}
    assert build_schedule(parse_input({"time": table})) == Schedule("settled", 3.0, 7, 1e-5, 1e-8)


def test_each_shape_becomes_its_start() -> None:
    filament = build_model(parse_input({"model": SMALL}))
    expected = {
        "straight": un.straight(filament),
        "kicked": un.kicked(filament, 0.3, seed=5),
        "planar": un.planar(filament, 0.3, angle=1.0),
        "helix": un.helix(filament, 0.3, right_handed=False),
        "mode": un.mode(filament, 0.3, angle=1.0),
    }
    own: dict[str, dict[str, Any]] = {
        "straight": {},
        "kicked": {"amplitude": 0.3, "seed": 5},
        "planar": {"amplitude": 0.3, "angle": 1.0},
        "helix": {"amplitude": 0.3, "handedness": "left"},
        "mode": {"amplitude": 0.3, "angle": 1.0},
    }
    for shape, state in expected.items():
        np.testing.assert_array_equal(state_of({"shape": shape} | own[shape])[1], state)


def test_a_stored_state_is_taken_up_exactly(tmp_path: Path) -> None:
    nodes = stored(tmp_path / "run.nc")
    filament, state = state_of({"shape": "state", "file": str(tmp_path / "run.nc")})
    np.testing.assert_array_equal(filament.nodes(state), nodes)


def test_a_stored_state_is_carried_over_to_another_number_of_links(tmp_path: Path) -> None:
    nodes = stored(tmp_path / "run.nc")
    start = {"shape": "state", "file": str(tmp_path / "run.nc")}
    filament, state = state_of(start, segments=32)
    # Interpolated inclinations of a smooth shape: an error of the order of 1/8^2.
    np.testing.assert_allclose(filament.nodes(state)[::4], nodes, atol=0.02)


def test_a_stored_shape_beside_a_plane_is_turned_into_it(tmp_path: Path) -> None:
    nodes = stored(tmp_path / "run.nc", angle=1.0)
    start = {"shape": "state", "file": str(tmp_path / "run.nc")}
    filament, state = state_of(start, confined=True)
    turned = filament.nodes(state)
    np.testing.assert_array_equal(turned[:, 1], 0.0)
    # Turning keeps heights and distances from the axis to round-off.
    np.testing.assert_allclose(turned[:, 2], nodes[:, 2], atol=1e-12)
    np.testing.assert_allclose(np.abs(turned[:, 0]), np.hypot(nodes[:, 0], nodes[:, 1]), atol=1e-7)


def test_a_stored_state_is_bent_less_or_more_by_the_amplitude(tmp_path: Path) -> None:
    nodes = stored(tmp_path / "run.nc")
    start = {"shape": "state", "file": str(tmp_path / "run.nc"), "amplitude": 0.5}
    filament, state = state_of(start)

    def inclination(shape: np.ndarray) -> np.ndarray:
        links = np.diff(shape, axis=0)
        return np.arctan2(np.hypot(links[:, 0], links[:, 1]), links[:, 2])

    halved = 0.5 * inclination(nodes)
    # The inclination is what is scaled, link by link, to round-off.
    np.testing.assert_allclose(inclination(filament.nodes(state)), halved, atol=1e-12)


def test_a_missing_state_is_refused_by_its_name(tmp_path: Path) -> None:
    start = {"shape": "state", "file": str(tmp_path / "gone.nc")}
    assert "gone.nc" in complaint(lambda: state_of(start))


@pytest.mark.parametrize("shape", ["planar", "mode"])
def test_a_confined_start_at_an_angle_is_refused_with_the_cure(shape: str) -> None:
    start = {"shape": shape, "angle": 0.5}
    said = complaint(lambda: parse_input({"model": {"confined": True}, "start": start}))
    assert "start.angle = 0.5" in said
    assert "model.confined = false" in said


def test_a_start_may_be_as_large_as_pi() -> None:
    state_of({"shape": "helix", "amplitude": 3.0})
    assert "pi" in complaint(lambda: parse_input({"start": {"amplitude": 3.2}}))
