"""Lyapunov exponents of filaments and chains: known ones, and signs of chaos."""

import json
import pickle
import time
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import undula as un
from refusal import complaint
from undula.analysis.regimes.lyapunov import Lyapunov, NotFollowed, lyapunov
from undula.analysis.runs.finite_separation import Separation, finite_separation
from undula.app.cli import main
from undula.arrays import Array
from undula.models.model import Model
from undula.numerics.integration.lyapunov import Block, growth
from undula.numerics.integration.status import Status

SEGMENTS = 20
#: A true value is farther off than so many statistical errors once in 400 times.
ERRORS = 3.0


def filament(force: float, **more: object) -> un.Filament:
    return un.Filament(SEGMENTS, un.TipLoad(force), **more)


@cache
def chaotic() -> tuple[Model, Array]:
    """A state on the attractor at tip force 800, where Ling, Guo & Kanso (2018) see chaos."""
    model = filament(800.0)
    # Some twenty beats, longer than the transient of a kick.
    return model, last(un.integrate(model, un.kicked(model), until=0.02))


def last(run: un.Run) -> Array:
    return run.model.from_nodes(run.motion.nodes[-1])


def is_zero(found: Lyapunov, cycle: float) -> bool:
    """Whether the largest exponent is 0 within an error that means something."""
    # By its error neighbouring motions would part by some per cent a cycle: those of chaotic
    # motions part e-fold.
    return abs(found.value) <= found.error < 0.05 / cycle


@pytest.mark.parametrize("rtol", [1e-5, 1e-6, 1e-7])
def test_a_spinning_filament_has_the_exponents_of_its_spectrum(rtol: float) -> None:
    state = un.find(filament(75.0), "spinning")
    found = lyapunov(state.model, state.x, 100.0 / state.frequency, rtol=rtol)
    assert found.symmetries == 1
    assert is_zero(found, 1.0 / state.frequency)
    assert abs(found.beyond_symmetry - state.leading_rate) <= found.beyond_symmetry_error
    assert found.beyond_symmetry_error < 0.05 * abs(state.leading_rate)


@pytest.mark.parametrize("rtol", [1e-5, 1e-6])
def test_a_planar_beat_has_the_exponents_of_its_multipliers(rtol: float) -> None:
    beat = un.find(filament(250.0), "flapping")
    x = beat.model.from_nodes(beat.nodes[0])
    found = lyapunov(beat.model, x, 200.0 * beat.period, rtol=rtol)
    assert found.symmetries == 2
    assert is_zero(found, beat.period)
    assert abs(found.beyond_symmetry - beat.leading_rate) <= found.beyond_symmetry_error
    assert found.beyond_symmetry_error < 0.05 * abs(beat.leading_rate)


@pytest.mark.slow
def test_a_beat_confined_to_its_plane_knows_of_disturbances_in_it_only() -> None:
    beat = un.find(filament(75.0, confined=True), "flapping")
    x = beat.model.from_nodes(beat.nodes[0])
    found = lyapunov(beat.model, x, 200.0 * beat.period)
    assert found.exponents.size == 2
    assert found.symmetries == 1
    assert is_zero(found, beat.period)
    assert abs(found.beyond_symmetry - beat.leading_rate) <= found.beyond_symmetry_error


def test_an_unstable_beat_has_a_positive_exponent_that_is_no_chaos() -> None:
    beat = un.find(filament(120.0), "flapping")
    x = beat.model.from_nodes(beat.nodes[0])
    found = lyapunov(beat.model, x, 100.0 * beat.period)
    # The motion stays in its plane exactly; that it is unstable its exponents tell all the same.
    assert abs(found.beyond_symmetry - beat.leading_rate) <= ERRORS * found.beyond_symmetry_error
    assert found.beyond_symmetry > 5.0 * found.beyond_symmetry_error


@pytest.mark.slow
def test_a_motion_that_is_periodic_up_to_a_turn_has_two_zero_exponents() -> None:
    model = filament(400.0)
    run = un.integrate(model, un.kicked(model), until="settled")
    period = run.settled.period
    found = lyapunov(model, last(run), 300.0 * period)
    assert found.symmetries == 2
    assert is_zero(found, period)
    zeros, errors = found.exponents[:2], found.errors[:2]
    assert np.all(np.abs(zeros) <= errors)
    # It was reached from a kick, so that nothing grows.
    assert found.beyond_symmetry < -ERRORS * found.beyond_symmetry_error


@pytest.mark.slow
def test_the_filament_at_tip_force_800_is_chaotic() -> None:
    model, x = chaotic()
    found = lyapunov(model, x, 0.4)
    assert found.symmetries == 2
    assert found.beyond_symmetry == found.value
    assert found.value > 5.0 * found.error


@pytest.mark.slow
def test_the_exponent_of_chaos_depends_on_no_tolerance_and_no_seed() -> None:
    model, x = chaotic()
    one = lyapunov(model, x, 2.0)
    for other in (lyapunov(model, x, 2.0, rtol=1e-5), lyapunov(model, x, 2.0, seed=2)):
        assert abs(one.value - other.value) < ERRORS * np.hypot(one.error, other.error)
    # One per cent of steps of a per cent: the errors of such long runs mean something.
    assert one.error < 0.1 * one.value


@pytest.mark.slow
def test_a_chain_of_three_links_spins_with_the_exponents_of_its_spectrum() -> None:
    state = un.find(un.Chain(3, un.TipLoad(20.0)), "spinning")
    found = lyapunov(state.model, state.x, 100.0 / state.frequency)
    assert found.symmetries == 1
    assert is_zero(found, 1.0 / state.frequency)
    assert abs(found.beyond_symmetry - state.leading_rate) <= found.beyond_symmetry_error


@pytest.mark.slow
def test_a_windmilling_chain_of_three_links_is_told_chaotic_by_its_exponents() -> None:
    model = un.Chain(3, un.TipLoad(60.0))
    run = un.integrate(model, un.kicked(model), until=60.0)
    assert run.verdict.name == "windmilling"
    found = lyapunov(model, last(run), 400.0)
    assert found.value > ERRORS * found.error


def test_a_state_at_rest_is_refused() -> None:
    model = filament(75.0)
    assert "at rest" in complaint(lambda: lyapunov(model, model.straight(), 1.0))


@pytest.mark.parametrize("duration", [0.0, -1.0, np.nan, np.inf])
def test_a_duration_that_is_none_is_refused(duration: float) -> None:
    model, x = chaotic()
    assert f"duration = {duration!r}" in complaint(lambda: lyapunov(model, x, duration))
    assert f"duration = {duration!r}" in complaint(lambda: finite_separation(model, x, duration))


@cache
def parted() -> Separation:
    model, x = chaotic()
    return finite_separation(model, x, 0.015)


@pytest.mark.slow
def test_runs_from_nearby_states_part_at_the_rate_of_the_largest_exponent() -> None:
    pairs, (model, x) = parted(), chaotic()
    exponent = lyapunov(model, x, 0.4)
    assert pairs.rate > 2.0 * pairs.error
    assert abs(pairs.rate - exponent.value) < ERRORS * np.hypot(pairs.error, exponent.error)
    assert 0.5 < pairs.rate / exponent.value < 2.0


def test_nearby_runs_part_by_many_orders_and_no_farther_than_the_motion_is_large() -> None:
    pairs = parted()
    # A start is disturbed by a normal deviate of 1e-7 in each coordinate, and moves its mean less.
    assert np.all(pairs.distance[:, 0] < 1e-6)
    assert pairs.saturated > 0
    assert 1e-3 < pairs.distance.max() < 1.0


def test_runs_from_nearby_states_of_a_regular_motion_do_not_part() -> None:
    beat = un.find(filament(250.0), "flapping")
    x = beat.model.from_nodes(beat.nodes[0])
    pairs = finite_separation(beat.model, x, 20.0 * beat.period)
    assert pairs.saturated == 0
    assert abs(pairs.rate) < ERRORS * pairs.error
    assert pairs.error * beat.period < 0.05


def test_one_pair_shows_no_scatter_and_is_refused() -> None:
    model, x = chaotic()
    assert "pairs = 1" in complaint(lambda: finite_separation(model, x, 0.01, pairs=1))


@pytest.mark.slow
def test_joints_that_have_wound_up_are_followed_but_not_started_from_again() -> None:
    model = un.Chain(2, un.TipLoad(60.0), confined=True, spring="unwrapped")
    run = un.integrate(model, un.planar(model, 0.3), until=20.0)
    wound = run.motion.energetics.unknowns[-1]
    found = lyapunov(model, wound, 100.0)
    assert found.symmetries == 1
    assert abs(found.value) <= found.error
    assert "wound up" in complaint(lambda: finite_separation(model, last(run), 1.0))


def answer(
    capsys: pytest.CaptureFixture[str], folder: Path, *changes: str, status: int = 0
) -> dict[str, Any]:
    words = [part for change in ("model.segments=20", *changes) for part in ("--set", change)]
    out = ["--out", str(folder), "--no-movie", "--json"]
    assert main(["run", *words, "--lyapunov", *out]) == status
    told = json.loads(capsys.readouterr().out)
    assert isinstance(told, dict)
    return told


def test_a_run_answers_with_its_exponents_if_asked(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    told = answer(capsys, tmp_path, "load.force=75", "time.until=0.5")
    found = told["lyapunov"]
    assert abs(found["value"]) <= found["error"]
    state = un.find(filament(75.0), "spinning")
    away = abs(found["beyond_symmetry"] - state.leading_rate)
    assert away <= ERRORS * found["beyond_symmetry_error"]
    assert found["finite_separation"]["error"] > 0.0
    assert told["without_lyapunov"] is None


def test_a_run_that_ends_straight_says_why_it_has_no_exponents(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    told = answer(capsys, tmp_path, "load.force=15", "time.until=0.5")
    assert told["verdict"] == "straight"
    assert told["lyapunov"] is None
    assert "ask for its spectrum" in told["without_lyapunov"]


def test_a_motion_that_cannot_be_followed_is_a_value_with_advice(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def failed(*given: Any, **options: Any) -> Iterator[Block]:
        for block in growth(*given, **options):
            yield replace(block, status=Status.STEP_TOO_SHORT)

    model = filament(75.0)
    x = un.kicked(model, 0.1)
    with monkeypatch.context() as patch:
        patch.setattr("undula.analysis.regimes.lyapunov.growth", failed)
        found = lyapunov(model, x, 0.1)
        assert isinstance(found, NotFollowed)
        assert "could not be followed beyond t = 0.0002" in found.reason
        assert "no step succeeded" in found.reason
        run = un.integrate(model, x, until=0.05, samples=100, lyapunov=True)
    assert run.lyapunov is None
    assert "no step succeeded" in run.without_lyapunov
    assert run.summary()["without_lyapunov"] == run.without_lyapunov


def test_exponents_of_a_run_heed_its_budget() -> None:
    model = filament(800.0)
    began = time.monotonic()
    run = un.integrate(model, un.kicked(model), until=2e-3, budget=0.2, lyapunov=True)
    # Some seconds for what the judging takes besides, on a busy machine; all would take far longer.
    assert time.monotonic() - began < 6.0
    assert run.without_lyapunov == "they were out of their budget of time" or run.ending.value == (
        "out of time"
    )
    pickle.dumps(run)
