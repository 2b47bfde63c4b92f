"""Bodies that cannot be, and starts that are none: refused in one sentence, with the cure."""

import math
import subprocess
import sysconfig
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import undula as un
from refusal import complaint
from undula.analysis.run_settings import Schedule
from undula.analysis.runs.simulation import Simulation
from undula.inputs.input import parse_input
from undula.models import initial_states as starts
from undula.models.natural_curvature import CurvatureTable

UNDULA = str(Path(sysconfig.get_path("scripts")) / "undula")
EIGHT = un.Filament(8, un.TipLoad(75.0))
TWENTY = un.Filament(20, un.TipLoad(75.0))
KICKED = un.kicked(EIGHT, 0.2)


def begin(model: Any, start: Any) -> Simulation:
    return Simulation.begin(model, start, Schedule(until=0.01, samples=10))


# ------------------------------------------------------------------ bodies


def curved(segments: int, curvature: Any) -> un.Filament:
    return un.Filament(segments, un.TipLoad(0.0), natural_curvature=curvature)


@pytest.mark.parametrize(
    "curvature",
    [
        (62.8, 0.0),
        (-40.0, 30.0),
        CurvatureTable((0.0, 0.5, 1.0), (0.0, 90.0, 0.0), (0.0, 0.0, 0.0)),
        lambda s: (100.0 * s, 0.0),
    ],
)
def test_a_curvature_that_folds_a_joint_is_refused_with_enough_segments(curvature: Any) -> None:
    told = complaint(lambda: curved(10, curvature))
    assert "10 segments" in told
    assert "beyond pi" in told
    enough = int(told.split("use ")[1].split()[0])
    # It is what it says, to the last segment.
    assert curved(enough, curvature).material_frame
    assert "beyond pi" in complaint(lambda: curved(enough - 1, curvature))


def test_a_curvature_that_no_number_of_segments_takes_is_refused_as_such() -> None:
    assert "smaller curvature" in complaint(lambda: curved(10, (1e6, 0.0)))
    told = complaint(
        lambda: parse_input({"model": {"natural_curvature": [62.8, 0.0]} | {"segments": 10}})
    )
    assert told.startswith("model.natural_curvature")
    assert "use 20 segments or more" in told


def test_a_curvature_that_just_fits_runs() -> None:
    run = un.integrate(curved(10, (31.0, 0.0)), curved(10, (31.0, 0.0)).rest(), until=0.01)
    assert run.ending.value == "done"


@pytest.mark.parametrize("stiffness", [75.0, 74.0, 1e-3])
@pytest.mark.parametrize("confined", [False, True])
def test_links_that_the_load_pushes_to_nothing_are_refused(
    stiffness: float, confined: bool
) -> None:
    soft = un.Filament(
        8,
        un.TipLoad(75.0),
        inextensibility="weak",
        tensile_stiffness=stiffness,
        confined=confined,
    )
    for act in (
        lambda: un.straight(soft),
        lambda: begin(soft, un.planar(soft)),
        lambda: un.integrate(soft, un.mode(soft)),
        lambda: un.find(soft, "flapping"),
    ):
        told = complaint(act)
        assert "tensile_stiffness" in told
        assert "75" in told


@pytest.mark.slow
def test_the_command_refuses_both_at_once(tmp_path: Path) -> None:
    weak = ["--set", "model.inextensibility=weak", "--set", "model.tensile_stiffness=50"]
    bent = ["--set", "model.segments=10", "--set", "model.natural_curvature=[62.8,0.0]"]
    for words in (["run", *weak, "--out", str(tmp_path)], ["find", "equilibrium", *bent]):
        asked = subprocess.run(
            [UNDULA, *words], capture_output=True, text=True, timeout=300, check=False
        )
        assert asked.returncode == 2, asked.stderr
        assert "Traceback" not in asked.stderr
        assert len(asked.stderr.strip().splitlines()) == 1


# ------------------------------------------------------------------ states that are none


@pytest.mark.parametrize(
    ("what", "start", "told"),
    [
        ("all zero", np.zeros(24), "nodes 0 and 1"),
        ("the last node twice", np.r_[KICKED[:21], KICKED[18:21]], "nodes 7 and 8"),
        ("micrometres", 20.0 * KICKED, "units of the length"),
        ("metres of a thousandth", 1e-3 * KICKED, "units of the length"),
        ("tip to base", KICKED.reshape(8, 3)[::-1].ravel(), "from the base to the tip"),
        ("random", np.random.default_rng(1).normal(size=24), "link"),
        ("small random", np.random.default_rng(1).normal(0.0, 0.1, 24), "link"),
        ("no number", np.r_[KICKED[:-1], math.nan], "finite"),
        ("without end", np.r_[KICKED[:-1], math.inf], "finite"),
        ("too few", KICKED[:-3], "24"),
        ("words", "kicked", "numbers"),
        ("nothing", None, "numbers"),
    ],
)
def test_a_state_that_no_body_has_is_refused(what: str, start: Any, told: str) -> None:
    assert told in complaint(lambda: begin(EIGHT, start)), what


def test_round_off_and_chords_are_no_reason_to_refuse_a_state() -> None:
    rng = np.random.default_rng(2)
    begin(EIGHT, KICKED + rng.normal(0.0, 1e-6, 24))
    # A bent curve at equal arc lengths: its chords are shorter than the arcs by some per cent.
    s = np.linspace(0.0, 1.0, 9)
    arc = np.column_stack([(1.0 - np.cos(5.0 * s)) / 5.0, 0.0 * s, np.sin(5.0 * s) / 5.0])
    begin(EIGHT, arc[1:].ravel())


def test_what_a_model_makes_is_a_state_of_it() -> None:
    soft = un.Filament(8, un.TipLoad(75.0), inextensibility="weak", tensile_stiffness=80.0)
    for start in (un.straight(soft), un.kicked(soft), un.helix(soft)):
        begin(soft, start)
    for count in (1, 2, 5):
        chain = un.Chain(count, un.TipLoad(10.0))
        for amplitude in (1e-3, 3.0):
            begin(chain, un.kicked(chain, amplitude))


# ------------------------------------------------------------------ measured shapes

BEND = 1.2


def arc(s: np.ndarray) -> np.ndarray:
    """Nodes on a circle's arc of length 1, at arc lengths s."""
    return np.column_stack([(1.0 - np.cos(BEND * s)) / BEND, 0.0 * s, np.sin(BEND * s) / BEND])


TIP = arc(np.array([1.0]))[0]


def miss(nodes: np.ndarray, model: Any = TWENTY) -> float:
    """By how much the tip of a carried shape is beside that of the arc [L]."""
    return float(np.linalg.norm(model.nodes(un.from_state(model, nodes))[-1] - TIP))


@pytest.mark.parametrize("power", [0.7, 1.0, 1.5, 2.0, 3.0])
@pytest.mark.parametrize("links", [10, 20, 40])
def test_a_shape_is_taken_by_its_own_arc_length(power: float, links: int) -> None:
    model = un.Filament(links, un.TipLoad(75.0))
    error = miss(arc(np.linspace(0.0, 1.0, 61) ** power), model)
    # Of second order in links and in the largest piece, on a curve of curvature 1.2.
    largest = np.diff(np.linspace(0.0, 1.0, 61) ** power).max()
    assert error < 0.3 * (links**-2 + largest**2)


@pytest.mark.parametrize("pixels", [100, 200, 1000])
def test_a_trace_on_a_grid_is_taken_to_a_pixel_or_two(pixels: int) -> None:
    trace = np.round(pixels * arc(np.linspace(0.0, 1.0, 20 * pixels + 1)))
    trace = trace[np.r_[True, (np.diff(trace, axis=0) != 0.0).any(axis=1)]]
    # At least ten pixels a link.
    assert miss(trace, un.Filament(10, un.TipLoad(75.0))) < 2.0 / pixels


def test_the_unit_of_a_measured_shape_does_not_matter() -> None:
    nodes = arc(np.linspace(0.0, 1.0, 21))
    for links in (8, 20):
        model = un.Filament(links, un.TipLoad(75.0))
        one, other = un.from_state(model, nodes), un.from_state(model, 18.5 * nodes)
        # Round-off of 18.5.
        np.testing.assert_allclose(one, other, atol=1e-3 if links == 20 else 1e-13)
        begin(model, other)


EVENLY = np.linspace(0.0, 1.0, 21)


@pytest.mark.parametrize(
    ("what", "nodes", "told"),
    [
        ("two at one place", arc(np.insert(EVENLY, 10, EVENLY[9])), "nodes 9 and 10"),
        ("backwards", arc(EVENLY)[::-1], "from the base to the tip"),
        ("backwards to the clamp", arc(0.6 * EVENLY)[::-1] - arc(EVENLY)[12], "leads away"),
        ("elsewhere", np.add(arc(EVENLY), [1.0, 2.0, 3.0]), "subtract"),
        ("infinite", np.vstack([arc(EVENLY), [math.inf] * 3]), "finite"),
        ("one node", np.zeros((1, 3)), "(1, 3)"),
        ("all at one place", np.zeros((5, 3)), "nodes 0 and 1"),
        ("words", [["a", "b", "c"]] * 3, "numbers"),
    ],
)
def test_a_shape_that_is_none_is_refused(what: str, nodes: Any, told: str) -> None:
    assert told in complaint(lambda: starts.from_state(EIGHT, nodes)), what


def test_a_start_file_without_samples_is_refused(tmp_path: Path) -> None:
    from undula.app.cli import main

    small = ["--set", "model.segments=8", "--set", "time.until=0.01", "--set", "time.samples=10"]
    assert main(["run", *small, "--no-movie", "--out", str(tmp_path / "r")]) == 0
    empty = un.load(tmp_path / "r" / "run.nc").isel(time=slice(0, 0))
    empty.to_netcdf(tmp_path / "none.nc", engine="h5netcdf")
    words = [*small, "--set", "start.shape=state", "--set", f"start.file={tmp_path / 'none.nc'}"]
    assert main(["run", *words, "--no-movie", "--out", str(tmp_path / "s")]) == 2
