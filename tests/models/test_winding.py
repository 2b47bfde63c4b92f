"""Springs that wind up beyond pi: their equations, runs that wind, and beats solved for."""

import dataclasses
from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import naive
import undula as un
from chains import OPTIONS, chain, random_state, tangents_of, virtual_work
from refusal import complaint
from undula.analysis.run_settings import Schedule
from undula.analysis.runs.checkpoint import checkpoint, resume
from undula.analysis.runs.integrate import carry_on
from undula.analysis.runs.run import Run
from undula.analysis.runs.simulation import Simulation
from undula.analysis.states.records import Flapping
from undula.arrays import Array, Links, State
from undula.inputs.build import build_model
from undula.inputs.input import parse_input
from undula.models.rod.velocity import rate_of_change
from undula.numerics.integration.system import RATES
from undula.numerics.linalg.banded import to_dense

every_option = pytest.mark.parametrize("option", OPTIONS)
every_number = pytest.mark.parametrize("links", [1, 2, 3, 5, 12])


def pair(links: int, option: str = "plain") -> tuple[un.Chain, un.Chain]:
    """Return a confined chain with springs that wind, and one with springs that fold."""
    folding = chain(links, option, confined=True)
    return dataclasses.replace(folding, spring="unwrapped"), folding


def two(force: float, spring: Any = "unwrapped") -> un.Chain:
    return un.Chain(2, un.TipLoad(force), confined=True, spring=spring)


def wound(model: un.Chain, x: State, seed: int) -> Array:
    """Return the integrator's vector at x with full turns, up to three, in the springs."""
    y = model.unknowns(x).reshape(-1, 4)
    y[:, 3] += 2.0 * np.pi * np.random.default_rng(seed).integers(-3, 4, model.links)
    return y.ravel()


def moving(model: un.Chain, y: Array) -> tuple[Array, Array]:
    """Return the velocity of the beads and the integrals' rates at y, whose turns count."""
    v = np.zeros(y.size + RATES)
    rate_of_change(model.system, y.copy(), v)
    return model.positions(v[:-RATES]), v[-RATES:]


def springs(model: un.Chain) -> Links:
    return np.array([model.base_spring] + [1.0] * (model.links - 1))


def slow_velocity(model: un.Chain, x: State, psi: Array) -> State:
    """Return the velocity by the principle of virtual work, with couples K psi at the joints."""
    folding = dataclasses.replace(model, spring="angle")
    work, t = virtual_work(folding, x), tangents_of(folding, x)
    moment = springs(model) * psi
    couple = np.append(moment[1:], 0.0) - moment
    # Each displacement turns one link, to either side: towards x it is along (t_z, -t_x).
    turns = work.displacements.reshape(model.links, 2, model.links)
    senses = [turns[j, :, j] @ [t[j, 1], -t[j, 0]] * model.links for j in range(model.links)]
    return work._replace(elastic=couple * np.array(senses)).velocity


def rates_of_angles(model: un.Chain, x: State, velocity: State) -> Array:
    """Return d psi / dt at the joints."""
    t = tangents_of(model, x)
    turning = np.diff(velocity.reshape(-1, 2), axis=0, prepend=0.0) * model.links
    return np.diff(t[:, 1] * turning[:, 0] - t[:, 0] * turning[:, 1], prepend=0.0)


# ------------------------------------------------------------------ the equations


@every_option
@every_number
def test_below_pi_both_springs_move_alike(option: str, links: int) -> None:
    winding, folding = pair(links, option)
    x = random_state(folding, links)
    velocity = folding.rhs(x)
    # Moments are K psi here and K sin(psi) psi / sin(psi) there: round-off, of joints to 2.5 rad.
    np.testing.assert_allclose(winding.rhs(x), velocity, atol=1e-11 * np.abs(velocity).max())
    assert winding.energy(x) == pytest.approx(folding.energy(x), rel=1e-13)
    y = winding.unknowns(x)
    np.testing.assert_allclose(
        np.abs(winding.joint_angles(y)), folding.joint_angles(folding.unknowns(x)), atol=1e-13
    )


@every_option
@every_number
def test_wound_up_they_move_as_the_principle_of_virtual_work_says(option: str, links: int) -> None:
    model = pair(links, option)[0]
    for seed in range(3):
        x = random_state(model, seed)
        y = wound(model, x, seed)
        velocity = moving(model, y)[0]
        expected = slow_velocity(model, x, model.joint_angles(y))
        # Drag matrices of condition 1e3.
        np.testing.assert_allclose(velocity, expected, atol=1e-11 * np.abs(expected).max())


@every_option
@every_number
def test_energy_gained_and_dissipated_is_what_the_force_puts_in(option: str, links: int) -> None:
    model = pair(links, option)[0]
    for seed in range(3):
        x = random_state(model, seed)
        y = wound(model, x, seed)
        psi, (velocity, rates) = model.joint_angles(y), moving(model, y)
        gained = springs(model) * psi @ rates_of_angles(model, x, velocity)
        assert abs(gained + rates[2] - rates[1]) < 1e-10 * (abs(rates[1]) + rates[2])
        observed = model.observe(y[None])
        energy = 0.5 * springs(model) @ psi**2
        assert observed.bending_energy[0] == pytest.approx(energy, rel=1e-14)
        assert observed.active_power[0] == pytest.approx(rates[1], rel=1e-12)
        assert observed.dissipation[0] == pytest.approx(rates[2], rel=1e-12)


@every_option
def test_the_matrix_is_the_derivative_of_the_residual(option: str) -> None:
    model = pair(5, option)[0]
    equations, random = model.equations, np.random.default_rng(3)
    y = wound(model, random_state(model, 1), 1)
    moves = equations.differential
    y += np.where(moves, 0.0, 0.3 * random.normal(size=y.size))
    w = np.where(moves, random.normal(size=y.size), 0.0)
    found = to_dense(equations.parts(y, w, 0.0)[0])
    numerical = naive.differences(lambda at: equations.residual(at, w), y, 3e-5)
    scale = np.abs(numerical).max(axis=1, keepdims=True)
    # Fourth power of a step of 1.5e-4 of a link, and round-off over it, row by row.
    assert (np.abs(found - numerical) <= 1e-8 * scale).all()


@every_option
def test_the_jacobian_is_the_derivative_of_the_velocity(option: str) -> None:
    model = pair(5, option)[0]
    x = random_state(model, 1, bend=2.0)
    numerical = naive.differences(model.rhs, x, 3e-5)
    # As above, through drag matrices of condition 1e3.
    np.testing.assert_allclose(
        model.jacobian(x), numerical, atol=1e-8 * float(np.abs(numerical).max())
    )


@every_option
def test_small_motions_are_those_of_either_spring(option: str) -> None:
    winding, folding = pair(4, option)
    stiffness, drag = winding.linearised()
    np.testing.assert_array_equal(stiffness, folding.linearised()[0])
    across = winding.jacobian(winding.straight())[::2, ::2]
    expected = -np.linalg.solve(drag, stiffness)
    # Round-off of rates up to some hundreds.
    np.testing.assert_allclose(across, expected, atol=1e-12 * np.abs(expected).max())


@every_option
def test_the_mirror_image_winds_the_other_way(option: str) -> None:
    model = pair(5, option)[0]
    equations, y = model.equations, wound(model, random_state(model, 2), 2)
    w = np.where(equations.differential, np.random.default_rng(4).normal(size=y.size), 0.0)
    mirrored = equations.mirrored
    one, other = equations.residual(y, w), equations.residual(mirrored(y), mirrored(w))
    np.testing.assert_allclose(other, mirrored(one), atol=1e-12 * np.abs(one).max())
    np.testing.assert_array_equal(model.joint_angles(mirrored(y)), -model.joint_angles(y))
    np.testing.assert_array_equal(model.positions(mirrored(y)), model.reflect(model.positions(y)))


# ------------------------------------------------------------------ runs


@pytest.mark.slow
def test_runs_with_either_spring_agree_as_long_as_no_joint_passes_pi() -> None:
    runs = [
        un.integrate(two(8.0, spring), un.planar(two(8.0), 0.3), until=15.0, rtol=1e-8, atol=1e-11)
        for spring in ("angle", "unwrapped")
    ]
    assert all(run.health.largest_joint_angle < 1.3 for run in runs)
    one, other = (run.motion.nodes for run in runs)
    # Some thousand steps of 1e-8; errors along the beat add up.
    np.testing.assert_allclose(one, other, atol=1e-6)
    for run in runs:
        # The beat of two links under 8 K/L, from two independent integrations.
        assert run.frequency is not None
        assert run.frequency.value == pytest.approx(0.5619337786, abs=1e-6)


def test_a_run_is_that_of_the_angles_of_the_links_followed_by_scipy() -> None:
    model = two(20.0)
    start = model.admissible(un.planar(model, 0.3))

    def turning(_: float, inclinations: Array) -> Array:
        t = np.stack([np.sin(inclinations), np.cos(inclinations)], axis=1)
        x = np.cumsum(t / model.links, axis=0).ravel()
        velocity = slow_velocity(model, x, np.diff(inclinations, prepend=0.0))
        return np.cumsum(rates_of_angles(model, x, velocity))

    t = tangents_of(model, start)
    times = np.linspace(0.0, 4.0, 41)
    told = {"method": "LSODA", "rtol": 1e-10, "atol": 1e-10, "t_eval": times}
    solved = solve_ivp(turning, (0.0, 4.0), np.arctan2(t[:, 0], t[:, 1]), **told)
    expected = np.diff(solved.y, axis=0, prepend=0.0).T
    run = un.integrate(model, start, until=4.0, samples=41, rtol=1e-9, atol=1e-12)
    psi = model.joint_angles(run.checkpoint["states"][:, :-RATES])
    assert np.abs(expected).max() > 1.9 * np.pi
    # Some thousand steps of 1e-9 on a motion that, wound up, runs at up to 100 rad per T.
    np.testing.assert_allclose(psi, expected, atol=1e-5)


@cache
def winding_run(force: float) -> Run:
    model = two(force)
    return un.integrate(model, un.planar(model, 0.3), until=30.0)


@pytest.mark.parametrize(
    ("force", "largest", "frequency"),
    # The beats that `find_flapping` solves for, with 256 steps of half a beat.
    [(13.0, 3.54969, 0.46514294), (16.0, 4.95490, 0.43081489), (30.0, 11.70697, 0.33995021)],
)
def test_beyond_pi_springs_wind_up_and_the_motion_stays_a_beat(
    force: float, largest: float, frequency: float
) -> None:
    run = winding_run(force)
    model, health = run.model, run.health
    # Between two of 4000 samples of 30 T.
    assert health.largest_joint_angle == pytest.approx(largest, rel=1e-3)
    assert health.folded is False
    assert run.motion.energetics.bending_energy.max() > 0.5 * np.pi**2
    # Some thousand steps of 1e-6.
    assert health.power_balance_error < 1e-5
    assert health.failed == 0
    psi = model.joint_angles(run.checkpoint["states"][:, :-RATES])
    assert np.abs(psi).max() == health.largest_joint_angle
    period, error = period_of(run.motion.time, psi[:, 0])
    assert error < 1e-4 * period
    # Steps of 1e-6, and zeros between samples.
    assert 1.0 / period == pytest.approx(frequency, rel=2e-5)
    # Half a period later the angles are the opposite: as periodic as between two samples.
    half = run.motion.time[-2000] + 0.5 * period
    later = [np.interp(half, run.motion.time, angle) for angle in psi.T]
    np.testing.assert_allclose(later, -psi[-2000], atol=2e-3 * np.abs(psi).max())


def period_of(time: Array, angle: Array) -> tuple[float, float]:
    """Return the mean time between upward zeros over the later half, and its largest deviation."""
    up = np.flatnonzero((angle[:-1] < 0.0) & (angle[1:] >= 0.0))
    zeros = time[up] - angle[up] * (time[up + 1] - time[up]) / (angle[up + 1] - angle[up])
    periods = np.diff(zeros[zeros > 0.5 * time[-1]])
    return float(periods.mean()), float(np.abs(periods - periods.mean()).max())


def test_the_force_at_which_the_base_passes_pi_is_the_one_at_which_the_other_spring_folds() -> None:
    for force, beyond in ((12.0, False), (12.5, True)):
        model, folding = two(force), two(force, "angle")
        unwrapped = un.integrate(model, un.planar(model, 0.3), until=15.0).health
        folds = un.integrate(folding, un.planar(folding, 0.3), until=15.0).health
        assert (unwrapped.largest_joint_angle > np.pi) is beyond
        assert folds.folded is beyond


def test_a_run_that_is_taken_up_goes_on_with_its_springs_wound() -> None:
    schedule, model = Schedule(until=8.0, samples=1500), two(20.0)
    whole = Simulation.begin(model, un.planar(model, 0.3), schedule)
    while np.abs(model.joint_angles(whole.memory.differences[0, :-RATES])).max() < 1.5 * np.pi:
        assert whole.advance()
    saved = {name: array.copy() for name, array in checkpoint(whole).items()}
    taken_up = resume(model, schedule, saved)
    for simulation in (whole, taken_up):
        carry_on(simulation)
    np.testing.assert_array_equal(taken_up.states, whole.states)
    # Positions alone tell nothing of full turns: a start from them is another motion.
    nodes = model.nodes(model.positions(saved["memory_differences"][0, :-RATES]))
    afresh = model.unknowns(model.from_nodes(nodes))
    assert np.abs(model.joint_angles(afresh)).max() < np.pi


# ------------------------------------------------------------------ beats, solved for


@cache
def beat(force: float) -> Flapping:
    state = un.find(two(8.0), "flapping")
    assert isinstance(state, Flapping)
    if force == 8.0:
        return state
    return un.follow(state, "load.force", force).states[-1]


@pytest.mark.slow
def test_below_pi_the_beat_is_that_of_either_spring() -> None:
    folding, winding = un.find(two(8.0, "angle"), "flapping"), beat(8.0)
    assert isinstance(folding, Flapping)
    # Their steps in time begin at other places of the beat.
    error = winding.time_error + folding.time_error
    assert winding.frequency == pytest.approx(folding.frequency, abs=error)
    # 64 instants a beat leave 2e-5 of the energy between them.
    assert winding.bending_energy.max == pytest.approx(folding.bending_energy.max, rel=5e-5)
    np.testing.assert_allclose(winding.in_plane, folding.in_plane, rtol=1e-5)


def test_a_beat_is_followed_beyond_pi() -> None:
    state, run = beat(13.0), winding_run(13.0)
    psi = state.model.joint_angles(state.unknowns)
    assert np.abs(psi).max() > np.pi
    half = len(psi) // 2
    np.testing.assert_allclose(psi[:half], -psi[half:], atol=1e-9)
    late = run.motion.late(15.0)
    psi_of_run = state.model.joint_angles(run.checkpoint["states"][:, :-RATES])
    period = period_of(run.motion.time, psi_of_run[:, 0])[0]
    # The steps of half a beat, which the trivial multiplier tells of.
    assert state.period == pytest.approx(period, rel=max(1e-5, *state.trivial))
    assert state.bending_energy.max == pytest.approx(late.energetics.bending_energy.max(), rel=1e-2)


def test_a_beat_is_found_again_from_where_its_springs_are_wound() -> None:
    state = beat(13.0)
    psi = np.abs(state.model.joint_angles(state.unknowns)).max(axis=1)
    shifted = np.roll(state.unknowns, -1 - int(psi.argmax()), axis=0)
    assert np.abs(state.model.joint_angles(shifted[-1])).max() > np.pi
    again = un.find(state.model, "flapping", guess=dataclasses.replace(state, unknowns=shifted))
    assert isinstance(again, Flapping)
    # Other places of the steps in time along the beat.
    assert again.frequency == pytest.approx(state.frequency, rel=max(1e-5, *state.trivial))


# ------------------------------------------------------------------ what is refused


def test_in_space_no_spring_winds_up() -> None:
    assert complaint(lambda: un.Chain(2, un.TipLoad(8.0), spring="unwrapped")) == (
        "spring = 'unwrapped' has no meaning in space, where no angle exceeds pi; use"
        " confined = True or spring = 'angle'"
    )
    assert complaint(lambda: two(8.0).with_(confined=False)).startswith("spring = 'unwrapped'")


def test_other_springs_are_refused() -> None:
    assert complaint(lambda: two(8.0, "soft")) == (
        "spring = 'soft' has to be 'angle' or 'unwrapped'"
    )


def test_the_key_of_the_input_arrives() -> None:
    table = {"kind": "chain", "links": 2, "confined": True, "spring": "unwrapped"}
    wanted = parse_input({"model": table, "load": {"force": 8.0}, "start": {"shape": "planar"}})
    assert build_model(wanted) == two(8.0)
    assert wanted.dump()["model"]["spring"] == "unwrapped"
    assert parse_input(wanted.dump()) == wanted


def test_the_key_of_the_input_is_refused_in_space_and_for_filaments() -> None:
    table = {"kind": "chain", "spring": "unwrapped"}
    assert complaint(lambda: parse_input({"model": table})) == (
        "model.spring = 'unwrapped' has no meaning in space, where no angle exceeds pi; use"
        " model.confined = true or model.spring = 'angle'"
    )
    assert "model.spring" in complaint(lambda: parse_input({"model": {"spring": "unwrapped"}}))
