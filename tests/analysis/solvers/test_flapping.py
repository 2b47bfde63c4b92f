"""Planar flapping, solved for: against runs in the plane and in space, and against itself."""

from functools import cache

import numpy as np
import pytest

import undula as un
from undula.analysis.observables.shapes import Range, envelope, tip_height
from undula.analysis.runs.run import Run
from undula.analysis.solvers import flapping
from undula.analysis.solvers.flapping import (
    find_flapping,
    flapping_family,
    flapping_unknowns,
)
from undula.analysis.solvers.spinning import find_spinning
from undula.analysis.states.not_found import NotFound, SearchStatus
from undula.analysis.states.records import Flapping, Spinning
from undula.arrays import Array
from undula.models.model import Model
from undula.numerics.orbits.flow import RADAU_5, flow, linearised_flow
from undula.numerics.orbits.shooting import Shot

EIGHT = un.Filament(segments=8, load=un.TipLoad(75.0))
CASES: dict[str, Model] = {
    "tip, unstable": EIGHT,
    "tip, stable": un.Filament(segments=12, load=un.TipLoad(200.0)),
    "linear": un.Filament(segments=8, load=un.LinearLoad(100.0, slope=0.5)),
    "point": un.Filament(segments=10, load=un.PointLoad(60.0, position=0.7)),
    "extensible": EIGHT.with_(inextensibility="weak"),
    "little drag across": EIGHT.with_(drag_ratio=1.5),
}
#: Runs are to be wrong by less than what they are compared with.
EXACTLY = {"rtol": 1e-9, "atol": 1e-12}


def found(state: Flapping | NotFound) -> Flapping:
    assert isinstance(state, Flapping), state
    return state


def refused(state: Flapping | NotFound) -> str:
    assert isinstance(state, NotFound), state
    assert not state
    return state.reason


@cache
def state_of(case: str) -> Flapping:
    return found(find_flapping(CASES[case]))


def shot_of(state: Flapping) -> Shot:
    """Return half a beat of a state with its linearisation."""
    family = flapping_family(state, "load.force", 1.0)
    shot = family.problem.shoot(flapping_unknowns(state), state.force)  # type: ignore[attr-defined]
    assert isinstance(shot, Shot)
    return shot


@pytest.mark.parametrize("case", CASES)
def test_a_beat_closes_balances_its_power_and_knows_its_symmetries(case: str) -> None:
    state = state_of(case)
    assert state.residual < 1e-10
    # Velocities squared show the steps in time more than positions do; springs that are stiff
    # make as many times more of it.
    assert state.power_balance_error < (2e-4 if case == "extensible" else 1e-6)
    # A shift in time is a disturbance that stays, to the error of the steps; a turn to round-off.
    shift, turn = state.trivial
    assert shift < 1e-6
    assert turn < 1e-12
    assert state.time_error < 1e-6 * state.frequency
    assert state.nodes.shape == (state.time.size, CASES[case].links + 1, 3)
    assert state.time[-1] == pytest.approx(state.period, rel=1e-14)


@pytest.mark.parametrize("case", CASES)
def test_half_a_period_later_a_beat_is_its_own_mirror_image(case: str) -> None:
    state, shot = state_of(case), shot_of(state_of(case))
    # The second half is made by reflection: followed instead, it leads to where the first began.
    second = flow(
        state.planar.equations,
        shot.flow.end,
        0.5 * state.period,
        intervals=flapping.INTERVALS,
        method=flapping.METHOD,
    )
    end = state.planar.nodes(state.planar.positions(second.end))
    # Newton's method closes half a beat to 1e-10.
    np.testing.assert_allclose(end, state.nodes[-1], atol=1e-10)
    half = state.nodes[state.time.size // 2 - 1]
    np.testing.assert_allclose(half * [-1.0, 1.0, 1.0], state.nodes[-1], atol=1e-10)
    assert not state.nodes[:, :, 1].any()


@pytest.mark.parametrize("case", CASES)
def test_a_run_in_the_plane_settles_to_the_beat(case: str) -> None:
    state, beats = state_of(case), 8
    flat = state.planar
    # The slowest disturbance in the plane has died away to 1e-10.
    settling = un.integrate(
        flat,
        un.planar(flat, 0.3),
        until=23.0 / -state.leading_rate_in_plane,
        samples=50,
        **EXACTLY,
    )
    start = un.from_state(flat, settling.motion.nodes[-1])
    # Parabolas through 1600 samples a beat leave 1e-6 of the sharpest energy, through 400 2e-5.
    run = un.integrate(flat, start, until=beats * state.period, samples=1 + 1600 * beats, **EXACTLY)
    assert run.frequency is not None
    error = max(run.frequency.error, 2e-7 * state.frequency)
    assert abs(run.frequency.value) == pytest.approx(state.frequency, abs=error)
    motion = run.motion
    # 64 instants of the sharpest beat, the point load's, leave 2e-5 of its energy between them.
    agree(state.bending_energy, motion.energetics.bending_energy[1:], 5e-5)
    # And 2e-6 of its lowest tip, more or less by where in the beat they lie.
    agree(state.tip_height, tip_height(motion.nodes)[1:], 4e-6)
    sideways = motion.nodes[1:, -1, 0]
    assert state.tip_radius.min == 0.0
    assert sideways.min() < 0.0 < sideways.max()
    assert state.tip_radius.max == pytest.approx(envelope(sideways).max, abs=1e-6)
    # Its distance from the axis has a corner, which 64 instants a beat round off.
    assert state.tip_radius.mean == pytest.approx(np.abs(sideways).mean(), abs=1e-4)


def agree(one: Range, samples: Array, error: float) -> None:
    other = envelope(samples)
    for part in ("min", "max", "mean"):
        assert getattr(one, part) == pytest.approx(getattr(other, part), abs=error), part


@pytest.mark.parametrize(
    ("force", "part"),
    # Where the disturbance alone is left and has not grown large: of 16 half beats the third to
    # the sixth, or the last.
    [(50.0, slice(1, 5)), (75.0, slice(2, 5)), (150.0, slice(8, 16))],
)
@pytest.mark.parametrize(
    ("kick", "rtol"),
    # Off the plane by more than a step may err, and by less.
    [(1e-6, 1e-8), (1e-9, 1e-6)],
)
def test_a_small_kick_out_of_the_plane_grows_or_decays_at_the_stated_rate(
    force: float, part: slice, kick: float, rtol: float
) -> None:
    state = found(find_flapping(EIGHT.with_(force=force)))
    rate = state.leading_rate_out_of_plane
    assert rate is not None
    assert (rate < 0.0) == (force == 150.0)
    model = state.model
    nodes = state.nodes[-1].copy()
    nodes[:, 1] = kick * np.linspace(0.0, 1.0, len(nodes)) ** 2
    run = un.integrate(
        model,
        model.admissible(model.from_nodes(nodes)),
        until=8.0 * state.period,
        samples=17,
        rtol=rtol,
        atol=1e-14,
    )
    x, y = run.motion.nodes[:, :, 0], run.motion.nodes[:, :, 1]
    # A turned plane is no disturbance: what is left beside it.
    left = y - x * (np.sum(x * y, axis=1) / np.sum(x * x, axis=1))[:, None]
    sizes = np.linalg.norm(left, axis=1)
    rates = np.diff(np.log(sizes)) / (0.5 * state.period)
    # Faster disturbances are gone to some per mille.
    np.testing.assert_allclose(rates[part], rate, rtol=0.02)


@pytest.mark.parametrize("case", ["tip, unstable", "extensible"])
def test_what_happens_in_the_plane_does_not_depend_on_the_space_around_it(case: str) -> None:
    state, flat = state_of(case), found(find_flapping(CASES[case].with_(confined=True)))
    assert flat.out_of_plane.size == 0
    assert flat.leading_rate_out_of_plane is None
    assert flat.leading_rate == state.leading_rate_in_plane
    np.testing.assert_array_equal(flat.in_plane, state.in_plane)


@pytest.mark.parametrize("case", CASES)
def test_the_parts_in_and_out_of_the_plane_are_those_of_the_flow_in_space(case: str) -> None:
    state, shot = state_of(case), shot_of(state_of(case))
    equations = state.model.equations
    y = equations.from_plane(shot.y)
    basis = equations.displacements(y)
    stages, method = equations.from_plane(shot.flow.stages), flapping.METHOD
    change = linearised_flow(equations, y, stages, shot.duration, basis, (), method)
    assert change is not None
    mirror = np.tile([-1.0, 1.0, 1.0, 1.0], state.model.links)
    returned = basis.T @ (mirror[:, None] * change.by_start)
    multipliers, vectors = np.linalg.eig(returned)
    # Those that are gone after half a beat are round-off of the others.
    kept = np.abs(multipliers) > 1e-6
    sideways = np.linalg.norm((basis @ vectors)[1::4, kept], axis=0)
    # The symmetry splits the others: each is either in the plane or out of it.
    assert np.all((sideways < 1e-6) | (sideways > 1.0 - 1e-6))
    for exponents, own, trivial in (
        (state.in_plane, sideways < 0.5, 1.0),
        (state.out_of_plane, sideways > 0.5, -1.0),
    ):
        known = multipliers[kept][own]
        nearest = np.argmin(np.abs(known - trivial))
        # What is trivial is known to the error of the steps.
        assert known[nearest] == pytest.approx(trivial, abs=1e-6)
        known = sorted(np.delete(known, nearest), key=lambda one: (-one.real, one.imag))
        stated = np.exp(exponents * 0.5 * state.period)
        stated = sorted(stated[np.abs(stated) > 1e-6], key=lambda one: (-one.real, one.imag))
        # Taking the trivial one out changes the others by its own error.
        np.testing.assert_allclose(stated, known, rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize("force", [75.0, 150.0])
def test_with_a_formula_of_order_five_the_error_of_the_period_falls_with_that_power(
    force: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    beat = found(find_flapping(EIGHT.with_(force=force)))

    monkeypatch.setattr(flapping, "METHOD", RADAU_5)

    def period(count: int) -> float:
        monkeypatch.setattr(flapping, "INTERVALS", count)
        return found(find_flapping(beat.model, beat)).period

    exact, intervals = period(96), [12, 16, 24]
    errors = [abs(period(count) - exact) for count in intervals]
    slope = np.polyfit(np.log(intervals), np.log(errors), 1)[0]
    assert slope == pytest.approx(-5.0, abs=0.15)


def test_the_stated_error_of_the_steps_is_the_true_one(monkeypatch: pytest.MonkeyPatch) -> None:
    # With few steps the error stands out of what Newton's method leaves.
    monkeypatch.setattr(flapping, "INTERVALS", 10)
    stated = found(find_flapping(EIGHT, state_of("tip, unstable")))
    monkeypatch.setattr(flapping, "INTERVALS", 40)
    true = abs(found(find_flapping(EIGHT, stated)).frequency - stated.frequency)
    # It is measured with half as many steps again, which leave a thirty-eighth of the error.
    assert stated.time_error == pytest.approx(true, rel=0.15)


@pytest.mark.slow
def test_nothing_a_run_and_other_links_lead_to_the_same_beat() -> None:
    alone = state_of("tip, unstable")
    flat = EIGHT.with_(confined=True)
    run = un.integrate(flat, un.planar(flat, 0.2), until="settled", limit=3.0)
    finer = found(find_flapping(EIGHT.with_(segments=12), alone))
    for guess in (run, alone, finer, state_of("little drag across")):
        state = found(find_flapping(EIGHT, guess))
        # Newton's method takes each to round-off, wherever on the orbit it begins.
        assert state.frequency == pytest.approx(alone.frequency, rel=2e-7)
        assert state.bending_energy.mean == pytest.approx(alone.bending_energy.mean, rel=1e-5)
    assert finer.model.links == 12
    assert finer.frequency == pytest.approx(found(find_flapping(finer.model)).frequency, rel=2e-7)


def test_below_the_onset_there_is_none_and_the_advice_names_the_onset() -> None:
    onset = un.onset(EIGHT, method="discrete")
    assert onset.force is not None
    nothing = find_flapping(EIGHT.with_(force=0.8 * onset.force))
    assert isinstance(nothing, NotFound)
    assert nothing.status is SearchStatus.BELOW_ONSET
    told = refused(nothing)
    assert f"begins at force {onset.force:.6g}" in told
    assert "does not beat (straight)" in told


def test_a_filament_that_is_pulled_never_flaps_and_the_advice_says_so() -> None:
    pulled = un.TableLoad(20.0, s=(0.0, 0.2, 0.4, 1.0), density=(1.0, 1.0, -0.4, -0.4))
    told = refused(find_flapping(un.Filament(segments=8, load=pulled)))
    assert "the straight state stays stable" in told


def test_a_run_that_does_not_beat_is_no_guess() -> None:
    decaying = EIGHT.with_(confined=True, force=20.0)
    run: Run = un.integrate(decaying, un.planar(decaying), until=0.05)
    assert "the given run does not beat" in refused(find_flapping(EIGHT, run))


def test_spinning_and_flapping_leave_the_hopf_point_with_one_frequency() -> None:
    onset = un.onset(EIGHT, method="discrete")
    assert onset.force is not None
    assert onset.frequency is not None
    ratios = []
    for find in (find_spinning, find_flapping):
        frequencies = []
        for share in (1.01, 1.02):
            state = find(EIGHT.with_(force=share * onset.force))
            assert isinstance(state, Spinning | Flapping)
            frequencies.append(state.frequency)
        near, far = frequencies
        # Linear in the force next to the Hopf point; what is left is the square of 2 per cent.
        assert 2.0 * near - far == pytest.approx(onset.frequency, rel=4e-4)
        ratios.append(np.array(frequencies) / onset.frequency)
    spinning, flapping_ = ratios
    # So the one is not faster than the other by a fixed share.
    assert np.all(spinning - flapping_ < [0.01, 0.02])
    assert np.all(spinning > flapping_)
