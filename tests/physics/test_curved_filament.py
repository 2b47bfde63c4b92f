"""Filaments with natural curvature: their rest states, runs, results on disk, and refusals."""

import math
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import undula as un
from refusal import complaint
from undula.analysis.run_settings import Schedule
from undula.analysis.runs.checkpoint import checkpoint, resume
from undula.analysis.runs.integrate import carry_on
from undula.analysis.runs.run import Run
from undula.analysis.runs.simulation import Simulation
from undula.app.commands import run as running
from undula.app.commands import run_job as jobs
from undula.arrays import Array, Points
from undula.inputs.build import build_model
from undula.inputs.input import parse_input
from undula.models.filament import Filament
from undula.models.natural_curvature import CurvatureTable, mean_over_pieces
from undula.numerics.integration.system import RATES
from undula.numerics.linalg.banded import to_dense
from undula.storage.run_file import load_result

RING = 2.0 * np.pi
TABLE = CurvatureTable((0.0, 0.4, 1.0), (RING, 3.0, 1.0), (0.0, 4.0, -2.0))
TWISTS = ["paper", "rigid", "elastic"]
every_twist = pytest.mark.parametrize("twist", TWISTS)


def curved(twist: Any, segments: int = 20, force: float = 200.0, **options: Any) -> Filament:
    given = {"natural_curvature": (RING, 0.0)} | options
    return Filament(segments, un.TipLoad(force), twist=twist, **given)


def equilibrium(model: Filament) -> Array:
    """Return the unknowns at rest, found from the straight state by Newton's method."""
    y, equations = model.unknowns(model.straight()), model.equations
    for _ in range(60):
        rest = np.zeros(y.size)
        slope = to_dense(equations.parts(y, rest, 0.0)[0])
        change = np.linalg.solve(slope, -equations.residual(y, rest))
        moved = np.abs(model.positions(change)).max()
        # Steps of a seventh of the length, each brought back to links of exact length.
        y = y + min(1.0, 0.15 / moved) * change
        if moved < 1e-11:
            return y
        y = model.unknowns(model.admissible(model.positions(y)))
    raise AssertionError("no equilibrium found")


def natural_tip(curvature: CurvatureTable) -> Array:
    """Return the tip of the curve that has a curvature everywhere, and directors without twist."""

    def along(s: float, state: Array) -> Array:
        d1, t = state[3:6], state[6:9]
        k1, k2 = curvature(np.array([s]))[:, 0]
        turn = k1 * d1 + k2 * np.cross(t, d1)
        return np.concatenate([t, np.cross(turn, d1), np.cross(turn, t)])

    start = np.array([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0])
    solved = solve_ivp(along, (0.0, 1.0), start, rtol=1e-10, atol=1e-12, max_step=0.01)
    return np.asarray(solved.y[:3, -1])


# ------------------------------------------------------------------ rest


@every_twist
def test_without_load_a_constant_curvature_is_a_circle(twist: Any) -> None:
    counts, errors = [10, 20, 40, 80], []
    for n in counts:
        model = curved(twist, n, 0.0, natural_curvature=(1.5, 2.0), bending_ratio=1.7)
        x, k, s = model.positions(equilibrium(model)), 2.5, np.arange(1, n + 1) / n
        # Curved about d1 = e_x it bends towards -y, about d2 = e_y towards x.
        aside = (1.0 - np.cos(k * s)) / k
        arc = np.stack([0.8 * aside, -0.6 * aside, np.sin(k * s) / k], axis=1)
        errors.append(np.abs(x.reshape(n, 3) - arc).max())
        assert model.energy(x) < 1e-20
    slope = np.polyfit(np.log(counts), np.log(errors), 1)[0]
    assert slope == pytest.approx(-2.0, abs=0.15)


@every_twist
def test_without_load_it_takes_the_shape_that_its_curvature_gives_it(twist: Any) -> None:
    counts, tip, errors = [20, 40, 80], natural_tip(TABLE), []
    for n in counts:
        model = curved(twist, n, 0.0, natural_curvature=TABLE, bending_ratio=0.6)
        errors.append(np.abs(model.positions(equilibrium(model))[-3:] - tip).max())
    slope = np.polyfit(np.log(counts), np.log(errors), 1)[0]
    assert slope == pytest.approx(-2.0, abs=0.15)


@every_twist
@pytest.mark.parametrize("load", [un.TipLoad(1.5), un.PointLoad(1.5, 0.7), un.LinearLoad(3.0, 1.0)])
def test_under_load_its_rest_is_of_second_order_in_the_links(twist: Any, load: Any) -> None:
    tips = []
    for n in (20, 40, 80):
        model = Filament(
            n, load, natural_curvature=TABLE, bending_ratio=1.6, twist=twist, twist_stiffness=2.0
        )
        tips.append(model.positions(equilibrium(model))[-3:])
    first, second = (np.linalg.norm(b - a) for a, b in pairwise(tips))
    # Two differences in place of a fit; the next power of 1/20 is a twentieth of the first.
    assert math.log2(first / second) == pytest.approx(2.0, abs=0.15)


def test_a_filament_left_to_itself_relaxes_to_its_circle() -> None:
    model = curved("rigid", 12, 0.0)
    run = un.integrate(model, un.kicked(model), until=2.0, samples=50)
    expected = model.positions(equilibrium(model))
    # The slowest relaxation has a rate of 12 and leaves 1e-10.
    np.testing.assert_allclose(model.from_nodes(run.motion.nodes[-1]), expected, atol=1e-5)
    assert run.motion.energetics.bending_energy[-1] < 1e-8


# ------------------------------------------------------------------ motion


@cache
def run_of(twist: str) -> Run:
    model = curved(twist)
    return un.integrate(model, un.helix(model, 0.5), until=0.05, samples=201)


@every_twist
def test_a_run_keeps_lengths_and_directors(twist: str) -> None:
    run = run_of(twist)
    assert run.ending.value == "done"
    assert run.health.failed == 0
    # Constraints are met to twice the tolerance of 1e-6.
    assert run.health.length_error < 2e-6
    assert run.health.frame == "lab"
    frames = run.model.directors(run.checkpoint["states"][:, :-RATES])  # type: ignore[attr-defined]
    assert np.abs(frames @ np.swapaxes(frames, -1, -2) - np.eye(3)).max() < 1e-13
    carried = run.checkpoint["states"][:, :-RATES].reshape(201, 20, 8)[:, :-1, 4:7]
    # Carried along within the tolerance, link by link.
    assert np.abs(carried - frames[:, 1:, 0]).max() < 20 * 2e-6


def test_a_run_balances_energy_unless_the_twist_moment_is_dropped() -> None:
    errors = {twist: run_of(twist).health.power_balance_error for twist in TWISTS}
    # Some thousand steps of 1e-6.
    assert errors["rigid"] < 1e-5
    assert errors["elastic"] < 1e-5
    # The moment is missing for some hundredths of the motion of a twentieth of T only.
    assert errors["paper"] > 100.0 * max(errors["rigid"], errors["elastic"])


@every_twist
def test_a_run_that_is_taken_up_is_the_same_run(twist: str) -> None:
    schedule, model = Schedule(until=0.02, samples=800), curved(twist, 12)
    whole = Simulation.begin(model, un.helix(model, 0.5), schedule)
    whole.advance()
    saved = {name: array.copy() for name, array in checkpoint(whole).items()}
    assert 0.0 < whole.time < 0.02
    taken_up = resume(model, schedule, saved)
    for simulation in (whole, taken_up):
        carry_on(simulation)
    np.testing.assert_array_equal(taken_up.states, whole.states)


@every_twist
def test_a_result_is_stored_and_goes_on(twist: str, tmp_path: Path) -> None:
    table = {"segments": 8, "natural_curvature": [RING, 0.0], "twist": twist}
    wanted = parse_input(
        {
            "model": table,
            "load": {"force": 200.0},
            "start": {"shape": "helix", "amplitude": 0.5},
            "time": {"until": 0.01, "samples": 11},
        }
    )
    path = tmp_path / "run.nc"
    running.compute(jobs.begin(wanted, path), math.inf, lyapunov=False)
    running.compute(jobs.resumed(path, 0.02), math.inf, lyapunov=False)
    stored = load_result(path)
    assert stored.sizes["time"] == 21
    model = build_model(wanted)
    whole = un.integrate(model, un.helix(model, 0.5), until=0.02, samples=21)
    # The second half begins with another step than the whole run has there.
    np.testing.assert_allclose(stored["nodes"].values, whole.motion.nodes, atol=1e-5)


# ------------------------------------------------------------------ what can be given


def test_a_filament_without_curvature_is_the_plain_rod_whatever_the_twist() -> None:
    plain = Filament(12, un.TipLoad(75.0))
    for given in ((0.0, 0.0), CurvatureTable((0, 1), (0, 0), (0, 0)), lambda s: (0.0 * s, 0.0)):
        model = Filament(12, un.TipLoad(75.0), natural_curvature=given, twist="elastic")
        assert type(model.system) is type(plain.system)
        assert model.continuum_load == plain.load


def test_curvature_comes_as_a_pair_a_table_or_a_function() -> None:
    pair, table = (
        mean_over_pieces((3.0, -2.0), 8),
        CurvatureTable((0.0, 1.0), (0.0, 2.0), (5.0, 5.0)),
    )

    def function(s: Points) -> tuple[Points, float]:
        return 2.0 * s, 5.0

    np.testing.assert_array_equal(pair, np.tile([3.0, -2.0], (9, 1)))
    middles = np.array([1 / 32, *np.arange(1, 8) / 8, 31 / 32])
    for given in (table, function):
        expected = np.stack([2.0 * middles, np.full(9, 5.0)], axis=1)
        np.testing.assert_allclose(mean_over_pieces(given, 8), expected, atol=1e-14)
    listed = Filament(8, un.TipLoad(1.0), natural_curvature=np.array([3, -2]))  # type: ignore
    assert listed.natural_curvature == (3.0, -2.0)
    assert listed == listed.with_links(9).with_links(8)  # type: ignore[union-attr]
    assert hash(curved("rigid", natural_curvature=table)) == hash(
        curved("rigid", natural_curvature=CurvatureTable([0, 1], [0, 2], [5, 5]))  # type: ignore
    )


def fails(s: Points) -> Any:
    raise RuntimeError(f"no curvature at {s.size} points")


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"natural_curvature": (1.0,)}, "natural_curvature = (1.0,) has 1 values"),
        ({"natural_curvature": 3.0}, "natural_curvature = 3.0 has to be a sequence"),
        ({"natural_curvature": "ab"}, "natural_curvature = 'ab' has to be a sequence"),
        ({"natural_curvature": (math.nan, 0)}, "natural_curvature[0] = nan has to be a finite"),
        ({"natural_curvature": fails}, "natural_curvature fails (RuntimeError: no curvature"),
        ({"natural_curvature": lambda s: s}, "natural_curvature fails (ValueError"),
        ({"natural_curvature": lambda s: (s, s / 0.0)}, "natural_curvature"),
        ({"natural_curvature": lambda s: (s, math.inf)}, "natural_curvature has k2 = inf at s"),
        ({"bending_ratio": -1.0}, "bending_ratio = -1.0 has to be a positive"),
        ({"bending_ratio": math.nan}, "bending_ratio = nan has to be a positive"),
        ({"twist": "soft"}, "twist = 'soft' has to be 'paper', 'rigid' or 'elastic'"),
        ({"twist_stiffness": 0.0}, "twist_stiffness = 0.0 has to be a positive"),
        ({"bending_ratio": 2.0, "confined": True}, "bending_ratio = 2.0 does not go with confined"),
        (
            {"natural_curvature": (1.0, 0.0), "inextensibility": "weak"},
            "natural_curvature = (1.0, 0.0) does not go with inextensibility = 'weak'",
        ),
    ],
)
def test_what_makes_no_filament_is_refused(given: dict[str, Any], told: str) -> None:
    with np.errstate(all="ignore"):
        assert complaint(lambda: Filament(8, un.TipLoad(1.0), **given)).startswith(told)


@pytest.mark.parametrize(
    ("s", "k1", "told"),
    [
        ((0.0, 0.5), (1.0, 2.0), "CurvatureTable: s = (0.0, 0.5) does not cover the filament"),
        ((), (), "CurvatureTable: s = () does not cover the filament"),
        ((0.0, 0.6, 0.5, 1.0), (1.0,) * 4, "CurvatureTable: s[2] = 0.5 does not exceed s[1] = 0.6"),
        ((0.0, 1.0), (1.0,), "CurvatureTable: k1 has 1 values, where s has 2"),
        ((0.0, 1.0), (1.0, math.nan), "CurvatureTable: k1[1] = nan has to be a finite number"),
    ],
)
def test_a_table_that_is_none_is_refused(s: Any, k1: Any, told: str) -> None:
    assert complaint(lambda: CurvatureTable(s, k1, (0.0,) * len(s))).startswith(told)


def test_small_motions_about_the_straight_state_are_refused() -> None:
    model = curved("rigid")
    assert "natural_curvature = (0, 0)" in complaint(model.linearised)
    assert "natural_curvature = (0, 0)" in complaint(lambda: un.mode(model))
    assert model.continuum_load is None


POINTS = {"s": [0, 0.4, 1], "k1": [RING, 3.0, 1.0], "k2": [0.0, 4.0, -2.0]}


@pytest.mark.parametrize("given", [[RING, 0], POINTS])
def test_the_keys_of_the_input_arrive_and_are_kept(given: Any) -> None:
    table = {"natural_curvature": given, "bending_ratio": 1.5, "twist": "elastic"}
    wanted = parse_input({"model": table | {"twist_stiffness": 0.7}})
    curvature = TABLE if isinstance(given, dict) else (RING, 0.0)
    expected = Filament(
        40,
        un.TipLoad(75.0),
        natural_curvature=curvature,
        bending_ratio=1.5,
        twist="elastic",
        twist_stiffness=0.7,
    )
    assert build_model(wanted) == expected
    assert parse_input(wanted.dump()) == wanted
    assert wanted.dump()["model"]["natural_curvature"] == given


@pytest.mark.parametrize(
    ("table", "told"),
    [
        ({"natural_curvature": [1.0]}, "model.natural_curvature = [1.0] is no pair"),
        (
            {"natural_curvature": [1.0, math.nan]},
            "model.natural_curvature[1] = nan is not a finite",
        ),
        ({"natural_curvature": 3.0}, "model.natural_curvature = 3.0 is a decimal number"),
        ({"natural_curvature": {"s": [0, 1]}}, "model.natural_curvature has the keys s; give"),
        (
            {"natural_curvature": POINTS | {"s": [0, 0.4, 0.9]}},
            "model.natural_curvature.s = (0.0, 0.4, 0.9) does not cover the filament",
        ),
        (
            {"natural_curvature": [1.0, 0.0], "confined": True},
            "model.natural_curvature = (1.0, 0.0) does not go with confined = True",
        ),
        ({"bending_ratio": 0.0}, "model.bending_ratio = 0.0 is out of range"),
        ({"twist": "soft"}, "model.twist = 'soft' is not known"),
        ({"twist_stiffness": 2.0}, "model.twist_stiffness = 2.0 has no meaning for model.twist"),
        (
            {"kind": "chain", "natural_curvature": [1.0, 0.0]},
            "model.natural_curvature = [1.0, 0.0]",
        ),
        ({"kind": "chain", "bending_ratio": 2.0}, "model.bending_ratio = 2.0 has no meaning"),
    ],
)
def test_wrong_keys_of_the_input_are_refused(table: dict[str, Any], told: str) -> None:
    assert complaint(lambda: parse_input({"model": table})).startswith(told)
