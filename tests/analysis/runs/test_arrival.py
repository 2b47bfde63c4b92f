"""Runs that end at a state that is solved for: where they do, and where they must not."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import undula as un
from refusal import complaint
from small_sweeps import done, sweep_of
from undula.analysis.observables.shapes import displacement
from undula.analysis.run_settings import Schedule
from undula.analysis.runs.checkpoint import resume
from undula.analysis.runs.early_stop import MAX_STATE_DISTANCE, MIN_RATE_RATIO, StateDetector
from undula.analysis.runs.reached_state import ReachedState, motion_of, turned_by
from undula.analysis.runs.run import Run
from undula.analysis.runs.settling import MotionRates
from undula.analysis.runs.stop_rule import TIGHT_RTOL
from undula.analysis.states.relative_equilibrium import Disturbances
from undula.numerics.integration.system import RATES
from undula.sweeps.point import point_record

#: As coarse as the maps are that such runs are for.
COARSE = 1e-4


def under(force: float, **changes: Any) -> un.Filament:
    return un.Filament(20, un.TipLoad(force), **changes)


def run_of(model: un.Filament, *, amplitude: float = 1e-2, rtol: float = COARSE) -> Run:
    start = un.kicked(model, amplitude)
    return un.integrate(model, start, until="solved", samples=400, rtol=rtol, limit=4.0)


@pytest.fixture(scope="module")
def spinning() -> un.Spinning:
    found = un.find(under(170.0), "spinning")
    assert isinstance(found, un.Spinning)
    return found


# 170: what rings about it takes 0.1 T to decay; 178: two states are stable, and it takes 0.5 T.
@pytest.mark.parametrize("force", [45.0, 100.0, 170.0, 178.0])
def test_a_run_ends_at_the_spinning_state_that_it_comes_to(force: float) -> None:
    run, state = run_of(under(force)), un.find(under(force), "spinning")
    assert isinstance(state, un.Spinning)
    assert (run.ending.value, run.verdict.name) == ("solved", "spinning")
    assert run.frequency is not None
    # Two solutions of the same equations, each to the last step of Newton's method.
    assert abs(run.frequency.value) == pytest.approx(state.frequency, rel=1e-9)
    told = run.figures()
    assert told["bending_energy"]["mean"] == pytest.approx(state.bending_energy.mean, rel=1e-9)
    assert told["tip_radius"]["min"] == pytest.approx(state.tip_radius.mean, rel=1e-9)
    # That of a circle, with one of its instants twice.
    assert told["planarity"] == pytest.approx(np.sqrt(0.5), rel=0.01)
    assert told["shape_frequency"] is None
    assert run.arrival is not None
    assert run.arrival.leading_rate == pytest.approx(state.leading_rate, rel=1e-6)


def test_its_trajectory_is_that_of_a_run_that_goes_on() -> None:
    model = under(100.0)
    left = run_of(model)
    whole = un.integrate(model, un.kicked(model), until="settled", samples=400, rtol=COARSE)
    count = len(left.motion.time)
    assert left.motion.time[-1] == left.arrival.time == left.summary()["solved"]["time"]
    np.testing.assert_array_equal(left.motion.time, whole.motion.time[:count])
    # The same steps, sampled in looks of another length.
    np.testing.assert_allclose(left.motion.nodes, whole.motion.nodes[:count], atol=1e-12)
    assert whole.summary()["solved"] is None


def test_the_straight_state_is_arrived_at_without_waiting_for_it() -> None:
    model = under(36.0)
    run, rates = run_of(model), un.spectrum(model, method="discrete").rates
    assert (run.ending.value, run.verdict.name) == ("solved", "straight")
    assert run.arrival.leading_rate == pytest.approx(rates[0], rel=1e-9)
    assert run.figures()["bending_energy"]["max"] == pytest.approx(0.0, abs=1e-20)
    assert run.frequency is None
    settled = un.integrate(model, un.kicked(model), until="settled", samples=400, rtol=COARSE)
    assert run.motion.time[-1] < 0.5 * settled.motion.time[-1]


def test_nothing_ends_at_a_state_that_is_not_stable() -> None:
    # From next to it, and so slowly away that it looks like coming to rest there.
    for force in (182.0, 200.0):
        state = un.find(under(force), "spinning")
        assert isinstance(state, un.Spinning)
        assert not state.stable
        start = un.from_state(state.model, state.nodes)
        run = un.integrate(state.model, start, until="solved", samples=400, rtol=COARSE, limit=0.02)
        assert run.arrival is None


def test_a_beat_is_told_after_a_few_of_them() -> None:
    model = under(250.0)
    run, state = run_of(model), un.find(model, "flapping")
    assert (run.ending.value, run.verdict.name) == ("settled", "planar flapping")
    assert run.arrival is None
    # The steps' own error is some 1e-4 of the period at that rtol.
    assert run.frequency.value == pytest.approx(state.frequency, rel=COARSE)
    settled = un.integrate(model, un.kicked(model), until="settled", samples=400, rtol=COARSE)
    assert run.motion.time[-1] < 0.8 * settled.motion.time[-1]


def test_a_beat_that_settles_slowly_into_its_plane_is_not_named_before_it_has() -> None:
    # Out of the plane it decays by 3 per cent a beat, which the steps' errors nearly hide.
    model = un.Filament(20, un.PowerLoad(194.0, exponent=10.0))
    run = un.integrate(model, un.kicked(model), until="solved", samples=400, rtol=COARSE)
    assert run.verdict.name == "planar flapping"


def test_what_is_no_simple_motion_is_told_from_exact_steps() -> None:
    # Next to the end of spinning, where coarse steps keep a modulation alive that decays.
    model = under(180.0)
    run = un.integrate(
        model, un.kicked(model, 1.0), until="solved", samples=400, rtol=COARSE, limit=4.0
    )
    assert run.verdict.name == "planar flapping"
    assert run.tight_from == run.summary()["tight_from"] > 0.0
    assert run.schedule.rtol == TIGHT_RTOL
    # Which a checkpoint remembers.
    asked = Schedule("solved", limit=4.0, samples=400, rtol=COARSE)
    resumed = resume(model, asked, run.checkpoint)
    assert (resumed.schedule.rtol, resumed.tight_from) == (TIGHT_RTOL, run.tight_from)
    assert run_of(under(250.0)).tight_from is None


def test_in_a_plane_only_straight_and_beating_are_arrived_at() -> None:
    assert run_of(under(30.0, confined=True)).verdict.name == "straight"
    run = run_of(under(100.0, confined=True))
    assert (run.ending.value, run.verdict.name) == ("settled", "planar flapping")


def test_a_body_that_is_held_runs_until_it_has_settled() -> None:
    model = un.Filament(10, un.TipLoad(10.0), natural_curvature=(1.0, 0.0))
    assert run_of(model).ending.value == "settled"


def test_exponents_of_an_arrival_are_those_of_its_state() -> None:
    model = un.Filament(10, un.TipLoad(75.0))
    run = un.integrate(
        model, un.kicked(model), until="solved", samples=400, rtol=COARSE, lyapunov=True
    )
    assert run.lyapunov is not None
    found, rate = run.lyapunov, run.arrival.leading_rate
    assert abs(found.beyond_symmetry - rate) < 3.0 * found.beyond_symmetry_error


def test_the_amplitude_of_a_mode_sees_nothing_of_others(spinning: un.Spinning) -> None:
    model, y = spinning.model, spinning.unknowns
    around = Disturbances.of(model, y, spinning.rate)
    slowest = around.amplitude(spinning.exponents[0])
    values, vectors = np.linalg.eig(around.inverse)
    exponents = around.shift - 1.0 / values
    seen = np.abs(slowest @ around.basis @ vectors)
    own = np.argmin(np.abs(exponents - spinning.exponents[0]))
    # Eigenvectors are known to round-off over the distance of their eigenvalues.
    assert np.delete(seen, own).max() < 1e-8 * seen[own]


def arrives(spinning: un.Spinning, rate: float, part: float) -> bool:
    """Whether a motion counts as arrived whose slowest disturbance falls at a rate.

    It begins with a distance of so large a part of the displacement of the state.
    """
    model, y = spinning.model, spinning.unknowns
    around, exponent = Disturbances.of(model, y, spinning.rate), spinning.exponents[0]
    values, vectors = np.linalg.eig(around.inverse)
    mode = around.basis @ vectors[:, np.argmin(abs(around.shift - 1.0 / values - exponent))]
    size = displacement(model.nodes(model.positions(y)))
    mode *= part * size / np.sqrt(np.mean(np.abs(mode) ** 2) * mode.size / model.links)
    lookout = StateDetector(model)
    for look in range(20):
        time = 0.002 * look
        swing = np.exp((rate + 1j * exponent.imag) * time)
        shape = turned_by(model, y + (swing * mode).real, np.array([0.3 * look]))[0]
        pace = MotionRates(time, shape_speed=0.1, displacement=1.0, turn_rate=spinning.rate)
        if lookout.arrival([pace] * 3, time, shape) is not None:
            return True
    return False


def test_a_motion_has_to_come_nearer_as_fast_as_the_spectrum_says(spinning: un.Spinning) -> None:
    rate = spinning.leading_rate
    for part in (0.5 * MAX_STATE_DISTANCE, 1e-3):
        assert arrives(spinning, rate, part)
        # As on a torus, or next to one, or where something else is at work.
        assert not arrives(spinning, 0.0, part)
        assert not arrives(spinning, 0.9 * MIN_RATE_RATIO * rate, part)
        assert not arrives(spinning, -rate, part)


def test_what_is_far_away_has_not_arrived(spinning: un.Spinning) -> None:
    # In twenty looks it falls by a factor of three.
    assert not arrives(spinning, spinning.leading_rate, 6.0 * MAX_STATE_DISTANCE)


def test_a_state_that_is_shown_turns_at_its_rate(spinning: un.Spinning) -> None:
    model = spinning.model
    arrival = ReachedState("spinning", 0.5, 0.0, 0.0, spinning.leading_rate, spinning)
    motion = motion_of(arrival, model, np.zeros(spinning.unknowns.size + RATES))
    assert motion.time[0] == 0.5
    turns = np.ptp(motion.rotation_angle) / (2.0 * np.pi)
    assert turns == pytest.approx(np.ptp(motion.time) * spinning.frequency, rel=1e-12)
    for nodes, angle in zip(motion.nodes, motion.rotation_angle, strict=True):
        expected = model.nodes(model.rotate(spinning.x, angle))
        np.testing.assert_allclose(nodes, expected, atol=1e-13)
    # What is put in is dissipated, to how well the state is solved for.
    np.testing.assert_allclose(motion.work, motion.loss, rtol=1e-8)


def test_a_run_that_was_left_can_be_gone_on_with() -> None:
    model = under(100.0)
    left = run_of(model)
    time = 2.0 * float(left.motion.time[-1])
    on = resume(model, Schedule(until=time, samples=100, rtol=COARSE), left.checkpoint)
    while on.advance():
        pass
    assert Run.of(on).motion.time[-1] == pytest.approx(time, rel=0.1)


def test_what_follows_a_run_begins_with_the_state_that_it_was_left_for() -> None:
    model = under(100.0)
    run, state = run_of(model), un.find(model, "spinning")
    assert isinstance(state, un.Spinning)
    shape = run.last_shape
    # The same but for a turn about the axis.
    away = np.hypot(shape[:, 0], shape[:, 1]) - np.hypot(state.nodes[:, 0], state.nodes[:, 1])
    np.testing.assert_allclose(away, 0.0, atol=1e-9)
    assert np.abs(run.motion.nodes[-1, :, 2] - state.nodes[:, 2]).max() > 1e-3


def test_a_run_is_until_a_time_or_settled_or_solved() -> None:
    said = complaint(lambda: Schedule(until="solve"))  # type: ignore[arg-type]
    assert said == "until = 'solve' has to be a positive number, 'settled' or 'solved'"


#: So short that no run tells anything.
SHORT = """
[model]
segments = 20
[time]
until = "solved"
rtol = 1e-4
limit = 0.002
samples = 30
[study]
undecided = "{undecided}"
[[study.axes]]
key = "load.force"
values = [30.0, 75.0, 178.0, 250.0]
"""


@pytest.mark.slow
def test_what_runs_do_not_tell_is_told_by_the_one_stable_state(tmp_path: Path) -> None:
    kept = done(sweep_of(tmp_path, SHORT.format(undecided="keep")), tmp_path / "kept.zarr")
    assert set(kept["verdict"].values.ravel()) == {"undecided"}
    assert "decided_by" not in kept
    stored = done(sweep_of(tmp_path, SHORT.format(undecided="solve")), tmp_path / "solved.zarr")
    # At 178 both spinning and flapping are stable.
    assert stored["verdict"].values.ravel().tolist() == [
        "straight",
        "spinning",
        "undecided",
        "planar flapping",
    ]
    assert stored["decided_by"].values.ravel().tolist() == [
        "solved states",
        "solved states",
        "run",
        "solved states",
    ]
    assert "spinning and planar flapping are stable" in str(stored["reason"].values.ravel()[2])
    spun = un.find(under(75.0), "spinning")
    assert isinstance(spun, un.Spinning)
    assert stored["frequency"].values.ravel()[1] == pytest.approx(spun.frequency, rel=1e-9)
    assert json.loads(stored.attrs["study"])["study"]["undecided"] == "solve"


def test_a_run_that_tells_is_not_asked_about() -> None:
    tables: Mapping[str, Any] = {
        "model": {"segments": 20},
        "load": {"force": 75.0},
        "time": {"until": "solved", "rtol": COARSE},
    }
    job = {"tables": tables, "label": "runs", "keep": "verdict", "undecided": "solve"}
    record = point_record(job)
    assert (record["verdict"], record["decided_by"]) == ("spinning", "run")
    assert record["ending"] == "solved"


def test_solved_states_are_not_asked_twice(tmp_path: Path) -> None:
    text = SHORT.format(undecided="solve").replace("[study]", '[study]\nlabel = "solved"')
    assert complaint(lambda: sweep_of(tmp_path, text)) == (
        "study.undecided = 'solve' has no meaning for study.label = 'solved'; use study.label ="
        " 'runs' or remove study.undecided"
    )
