"""Spinning states: solved well, the same by every way, what runs come to, and judged rightly.

The last part solves for them once more, as a boundary value problem of the continuous filament.
"""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid, solve_bvp
from scipy.signal import argrelmax

import undula
from cases import filament, random_state
from refusal import complaint
from undula.analysis.solvers.branches import follow
from undula.analysis.solvers.spinning import FORCE, find_spinning
from undula.analysis.solvers.state_kinds import extrapolate
from undula.analysis.solvers.thresholds import single_threshold
from undula.analysis.states.not_found import NotFound, SearchStatus
from undula.analysis.states.records import Spinning
from undula.analysis.states.relative_equilibrium import TurningShape
from undula.arrays import Array
from undula.models.filament import Filament
from undula.models.initial_states import from_state, kicked, planar
from undula.models.loads.analytic import LinearLoad, Load, PointLoad, TipLoad
from undula.models.loads.power import PowerLoad
from undula.numerics.continuation.arclength import solve_at

SPINNING_MODELS = [
    Filament(12, TipLoad(40.0)),
    Filament(12, TipLoad(75.0)),
    Filament(8, TipLoad(150.0)),
    Filament(12, LinearLoad(110.0, 0.0)),
    Filament(12, PowerLoad(100.0, 2.0)),
    Filament(12, PointLoad(60.0, 0.8)),
    Filament(12, TipLoad(75.0), drag_ratio=1.5),
    Filament(12, TipLoad(75.0), drag_ratio=1.0),
    Filament(12, TipLoad(75.0), inextensibility="weak"),
]
every_spinning_model = pytest.mark.parametrize("model", SPINNING_MODELS, ids=repr)

MODEL = Filament(12, TipLoad(75.0))


def solved(model: Filament) -> Spinning:
    found = find_spinning(model)
    assert isinstance(found, Spinning)
    return found


def found_from(model: Filament, guess: Spinning | undula.Run) -> Spinning:
    found = find_spinning(model, guess)
    assert isinstance(found, Spinning)
    return found


def assert_same(one: Spinning, other: Spinning) -> None:
    # Newton's method ends at round-off, of which stiff links leave this.
    assert one.rate == pytest.approx(other.rate, rel=1e-9)
    for name in ("bending_energy", "tip_radius", "tip_height"):
        assert getattr(one, name).mean == pytest.approx(getattr(other, name).mean, rel=1e-9)
    np.testing.assert_allclose(one.exponents, other.exponents, atol=1e-6 * abs(one.rate))


# ---------------------------------------------------------------- solved well


@every_spinning_model
def test_a_spinning_state_turns_as_the_equations_of_motion_say(model: Filament) -> None:
    state = solved(model)
    # Round-off of bending forces beside those of the drag.
    assert state.residual < 1e-9
    turning = state.rate * model.rotation_generator(state.x)
    away = np.abs(model.rhs(state.x) - turning).max() / np.abs(turning).max()
    # For extensible links velocities are those of stiff springs: round-off comes with stiffness.
    assert away < (1e-9 if model.inextensibility == "exact" else 1e-6)
    assert state.power_balance_error < 1e-9
    assert state.force == model.load.force
    assert state.frequency == pytest.approx(abs(state.rate) / (2.0 * np.pi), rel=1e-15)
    assert state.period == pytest.approx(1.0 / state.frequency, rel=1e-15)
    energy, radius, height = state.bending_energy, state.tip_radius, state.tip_height
    assert all(values.min == values.max == values.mean for values in (energy, radius, height))
    tip = state.nodes[-1]
    assert radius.mean == pytest.approx(np.hypot(tip[0], tip[1]), rel=1e-14)
    assert height.mean == tip[2]


def problem_of(state: Spinning) -> TurningShape:
    return TurningShape(state.model, FORCE, state.unknowns, abs(state.rate))


@every_spinning_model
def test_newtons_method_converges_quadratically(model: Filament) -> None:
    state = solved(model)
    problem, p = problem_of(state), state.force
    exact = np.append(state.unknowns, state.rate)
    u = exact.copy()
    start = model.admissible(from_state(model, state.nodes, 1.02))
    u[:-1], u[-1] = model.unknowns(start), 1.02 * state.rate
    left = []
    for _ in range(7):
        there = problem.evaluate(u, p)
        step, _ = there.linear.solve(np.zeros(u.size), np.zeros(u.size), 1.0, -there.residual, 0.0)
        u = u + step
        left.append(float(np.sqrt(problem.weights @ step**2)))
    np.testing.assert_allclose(model.positions(u[:-1]), state.x, atol=1e-10)
    sizes = np.array(left)
    # Steps end at 1e-10, from where round-off goes on; curvature is below 100 in these units.
    seen = sizes[:-1] > 1e-10
    assert np.count_nonzero(seen) >= 3
    assert np.all(sizes[1:][seen] < 100.0 * sizes[:-1][seen] ** 2 + 1e-10)


@every_spinning_model
def test_the_derivative_by_force_is_that_of_the_residual(model: Filament) -> None:
    state = solved(model)
    problem, p, step = problem_of(state), state.force, 1e-2
    u = np.append(state.unknowns, state.rate)
    more, less = (problem.evaluate(u, p + side).residual for side in (step, -step))
    found = problem.evaluate(u, p).by_parameter
    # The residual is linear in the force, and forces of some thousands round.
    np.testing.assert_allclose(found, (more - less) / (2.0 * step), atol=1e-7)


def test_the_derivative_by_drag_ratio_is_that_of_the_residual() -> None:
    state = solved(MODEL)
    problem = replace(problem_of(state), parameter="model.drag_ratio")
    u, step = np.append(state.unknowns, state.rate), 1e-3
    more, less = (problem.evaluate(u, 2.0 + side).residual for side in (step, -step))
    found = problem.evaluate(u, 2.0).by_parameter
    # A sixth of the square of the step times the third derivative, 6 / 2^4, of drag of size 100.
    np.testing.assert_allclose(found, (more - less) / (2.0 * step), atol=1e-5)


# ---------------------------------------------------------------- the same by every way


@pytest.mark.parametrize("angle", [0.4, 2.0, -3.0])
def test_a_turned_guess_gives_the_same_state_turned(angle: float) -> None:
    state = solved(MODEL)
    turned = replace(state, unknowns=MODEL.unknowns(MODEL.rotate(state.x, angle)))
    found = found_from(MODEL, turned)
    assert_same(found, state)
    # The phase is the one turned least from the guess.
    np.testing.assert_allclose(found.x, turned.x, atol=1e-9)


def test_the_mirror_image_spins_the_other_way() -> None:
    state = solved(MODEL)
    mirrored = MODEL.unknowns(MODEL.reflect(state.x))
    found = found_from(MODEL, replace(state, unknowns=mirrored, rate=-state.rate))
    assert_same(replace(found, rate=-found.rate), state)
    assert found.frequency == state.frequency or found.rate == pytest.approx(-state.rate, rel=1e-9)


@pytest.mark.parametrize("part", [-1.0, 0.5, 2.0])
def test_a_wrong_rate_in_the_guess_does_not_matter(part: float) -> None:
    state = solved(MODEL)
    assert_same(found_from(MODEL, replace(state, rate=part * state.rate)), state)


@pytest.mark.parametrize("links", [8, 11, 20, 40])
def test_a_state_with_another_number_of_links_leads_to_the_same_one(links: int) -> None:
    state = solved(MODEL)
    other = solved(replace(MODEL, segments=links))
    assert_same(found_from(MODEL, other), replace(state, rate=np.copysign(state.rate, other.rate)))


def test_a_state_under_another_force_leads_to_the_same_one() -> None:
    state = solved(MODEL)
    for force in (60.0, 90.0):
        assert_same(found_from(MODEL, solved(MODEL.with_(force=force))), state)


@every_spinning_model
def test_the_branch_from_the_onset_and_the_branch_along_the_force_meet(model: Filament) -> None:
    state = solved(model)
    other = solved(model.with_(force=1.05 * state.force))
    branch = follow(other, FORCE, state.force)
    assert branch.complete
    assert_same(branch.states[-1], state)


# ---------------------------------------------------------------- what is no spinning state


def reason(found: Spinning | NotFound) -> str:
    assert isinstance(found, NotFound)
    assert not found
    assert len(found.reason.splitlines()) == 1
    return found.reason


@pytest.mark.parametrize("force", [0.0, 20.0, 36.0])
def test_below_the_hopf_force_there_is_none_and_the_force_is_told(force: float) -> None:
    found = find_spinning(MODEL.with_(force=force))
    told = reason(found)
    assert isinstance(found, NotFound)
    assert found.status is SearchStatus.NOT_REACHED
    assert found.advice is not None
    onset = undula.onset(MODEL, method="discrete").force
    assert f"begins at force {onset:.6g}" in told
    assert "larger force" in told


def test_a_guess_that_leads_to_the_straight_state_finds_none() -> None:
    state = solved(MODEL)
    told = reason(find_spinning(MODEL.with_(force=20.0), state))
    assert "guess" in told


def test_a_run_that_has_hardly_begun_is_a_bad_guess() -> None:
    run = undula.integrate(MODEL, kicked(MODEL, 0.1), until=1e-3)
    found = find_spinning(MODEL, run)
    assert "let the run settle longer" in reason(found)
    assert isinstance(found, NotFound)
    assert found.status is SearchStatus.NOT_CONVERGED
    assert found.residual is not None
    assert found.residual > 0.1


def test_a_run_that_flaps_is_a_bad_guess() -> None:
    confined = MODEL.with_(confined=True)
    run = undula.integrate(confined, planar(confined, 0.5), until=0.1)
    assert "guess" in reason(find_spinning(MODEL, run))


def test_a_shape_that_has_nothing_to_do_with_spinning_is_a_bad_guess() -> None:
    for seed in range(5):
        shape = MODEL.unknowns(random_state(filament(segments=12), seed, bend=2.0))
        guess = replace(solved(MODEL), unknowns=shape, rate=0.0)
        found = find_spinning(MODEL, guess)
        # Should Newton's method come to a state all the same, it is one.
        assert "guess" in reason(found) if isinstance(found, NotFound) else found.residual < 1e-9


def test_a_run_that_stayed_straight_is_refused() -> None:
    run = undula.integrate(MODEL, MODEL.straight(), until=1e-3)
    assert "straight" in complaint(lambda: find_spinning(MODEL, run))


def test_a_confined_model_is_refused() -> None:
    confined = MODEL.with_(confined=True)
    assert "confined = false" in complaint(lambda: find_spinning(confined))
    assert "confined = false" in complaint(lambda: find_spinning(confined, solved(MODEL)))


@pytest.mark.parametrize("to", [10.0, 30.0, 36.5])
def test_a_branch_followed_down_ends_at_the_hopf_point(to: float) -> None:
    branch = follow(solved(MODEL), FORCE, to)
    onset = undula.onset(MODEL, method="discrete").hopf
    assert onset is not None
    assert not branch.complete
    # It ends where a step of 1e-6 of a tenth of the way would pass the straight state.
    assert branch.values[-1] == pytest.approx(onset.force, rel=1e-6)
    assert branch.states[-1].frequency == pytest.approx(onset.frequency, rel=1e-6)
    assert branch.bifurcations == ()
    radii = [state.tip_radius.mean for state in branch.states]
    assert 0.0 < radii[-1] < 1e-3
    # Near its beginning the amplitude is the square root of the distance from the Hopf force.
    near = (np.array(radii) < 0.1) & (np.array(radii) > 1e-3)
    distance = branch.values[near] - onset.force
    order = np.polyfit(np.log(distance), np.log(np.array(radii)[near]), 1)[0]
    assert order == pytest.approx(0.5, abs=0.02)


# ---------------------------------------------------------------- exponents


@every_spinning_model
def test_exponents_are_those_of_the_dense_jacobian_in_the_turning_frame(model: Filament) -> None:
    state = solved(model)
    moves = model.equations.differential
    basis = model.equations.displacements(state.unknowns)[moves]
    turn = np.array([model.rotation_generator(unit) for unit in np.eye(model.size)]).T
    within = basis.T @ (model.jacobian(state.x) - state.rate * turn) @ basis
    expected = np.linalg.eigvals(within)
    found = np.append(state.exponents, state.trivial)
    assert found.size == expected.size
    # The fastest decay at up to 1e7 and round to that; those that matter are of the rate's size.
    for value in found[np.abs(found) < 1e4]:
        assert np.abs(expected - value).min() < 1e-6 * abs(state.rate)
    for value in expected[np.abs(expected) < 1e4]:
        assert np.abs(found - value).min() < 1e-6 * abs(state.rate)
    assert np.all(np.diff(state.exponents.real) <= 0.0)


@every_spinning_model
def test_the_trivial_exponent_is_apart_and_vanishes(model: Filament) -> None:
    state = solved(model)
    assert abs(state.trivial) < 1e-6 * abs(state.leading_rate)
    assert np.abs(state.exponents).min() > 1.0


def test_exponents_do_not_depend_on_phase_or_sense() -> None:
    state = solved(MODEL)
    turned = replace(state, unknowns=MODEL.unknowns(MODEL.rotate(state.x, 1.0)))
    np.testing.assert_allclose(
        found_from(MODEL, turned).exponents[:6], state.exponents[:6], rtol=1e-8
    )


# ---------------------------------------------------------------- what runs come to

SETTLING_MODELS = [
    *(Filament(16, TipLoad(force)) for force in (40.0, 75.0, 120.0, 160.0)),
    Filament(20, TipLoad(100.0)),
    Filament(18, LinearLoad(110.0, 0.0)),
    Filament(18, PowerLoad(100.0, 2.0)),
    Filament(16, TipLoad(75.0), drag_ratio=1.5),
    Filament(16, TipLoad(75.0), inextensibility="weak"),
]


@pytest.mark.parametrize("model", SETTLING_MODELS, ids=repr)
def test_a_run_settles_to_the_state_that_is_solved_for(model: Filament) -> None:
    state = solved(model)
    assert state.stable
    run = undula.integrate(model, kicked(model, 0.1), until="settled")
    assert run.verdict.name == "spinning"
    assert run.frequency is not None
    assert run.settled is not None
    assert abs(abs(run.frequency.value) - state.frequency) <= run.frequency.error
    # What the run may still change by, in the displacement, and the errors of its steps; energy
    # goes with their square.
    energy = state.bending_energy.mean
    left = 2.0 * (run.settled.remaining + run.schedule.rtol) * energy
    assert run.window.energetics.bending_energy[-1] == pytest.approx(energy, abs=left)
    assert_same(replace(found_from(model, run), rate=state.rate), state)


def envelope_rate(model: Filament, state: Spinning, seed: int) -> float:
    """Return the rate of growth of the energy's swings in a run from a disturbed state."""
    random = np.random.default_rng(seed)
    basis = model.equations.displacements(state.unknowns)
    away = basis @ random.normal(size=basis.shape[1])
    disturbed = state.unknowns + 1e-4 * away / np.abs(away).max()
    start = model.admissible(model.positions(disturbed))
    run = undula.integrate(model, start, until=0.2, rtol=1e-9)
    time = run.motion.time
    swing = np.abs(run.motion.energetics.bending_energy - state.bending_energy.mean)
    # The others have died out by then: their rates are beyond 700.
    peaks = argrelmax(swing)[0]
    peaks = peaks[time[peaks] > 0.03]
    assert peaks.size > 50
    assert swing[peaks].max() < 1e-2
    return float(np.polyfit(time[peaks], np.log(swing[peaks]), 1)[0])


@pytest.mark.parametrize("segments", [12, 16])
def test_a_disturbance_decays_below_the_loss_and_grows_above_it_as_foretold(segments: int) -> None:
    model = Filament(segments, TipLoad(75.0))
    loss = single_threshold(model, "spinning-lost")
    assert loss.value is not None
    assert loss.bifurcation == "torus"
    for part in (0.98, 1.02):
        beside = model.with_(force=part * loss.value)
        state = solved(beside)
        assert state.stable == (part < 1.0)
        # The square of a swing of some 1e-3 and its like.
        measured = envelope_rate(beside, state, seed=1)
        assert measured == pytest.approx(state.leading_rate, rel=0.02)


def test_at_the_loss_a_pair_is_on_the_axis_with_the_second_frequency() -> None:
    model = Filament(12, TipLoad(75.0))
    loss = single_threshold(model, "spinning-lost")
    assert loss.value is not None
    assert loss.error is not None
    state = solved(model.with_(force=loss.value))
    slope = abs(solved(model.with_(force=1.001 * loss.value)).leading_rate) / (1e-3 * loss.value)
    assert abs(state.leading_rate) <= 10.0 * slope * loss.error
    assert loss.frequency == pytest.approx(state.frequency, rel=1e-8)
    swing = abs(state.exponents[0].imag) / (2.0 * np.pi)
    assert loss.second_frequency == pytest.approx(swing, rel=1e-8)


# ---------------------------------------------------------------- the continuous filament


class Continuum:
    """The spinning state of the continuous filament, by collocation.

    In the frame that turns at the rate O all is at rest, and the velocity is v = O e3 x r. Along
    the tangent t the drag is 1/gamma of that across it, so that the force on the fluid is
    f = v + (1/gamma - 1) (v . t) t, which balances N' - f_a t. With k = t' and N = -k' + T t the
    tension drops out: T = N . t + k' . t, and k . t = 0 gives k' . t = -k . k, hence

        r' = t,   t' = k,   k' = (N . t) t - N - (k . k) t,   N' = f + f_a t.

    The clamp has r = 0, t = e3, and the phase is that k begins in the x-z plane, k_y = 0; the tip
    has k = 0, and N = -F t for a tip load, which stands just inside, else 0. These are 13
    conditions for 12 unknowns and O. |t| = 1 and k . t = 0 hold all along, as they hold where
    they are imposed: (|t|^2 - 1)' = 2 k . t and (k . t)' is a multiple of |t|^2 - 1.
    """

    def __init__(self, load: Load, drag_ratio: float) -> None:
        self.lag = 1.0 / drag_ratio - 1.0
        at_tip = isinstance(load, TipLoad)
        self.end, self.load = load.force if at_tip else 0.0, load
        self.spread = 0.0 if at_tip else load.force

    def drag(self, r: Array, t: Array, rate: float) -> Array:
        velocity = rate * np.array([-r[1], r[0], np.zeros_like(r[0])])
        return velocity + self.lag * (velocity * t).sum(axis=0) * t

    def density(self, s: Array) -> Array:
        slope = self.load.slope if isinstance(self.load, LinearLoad) else 0.0
        return self.spread * (1.0 + slope * (2.0 * s - 1.0))

    def along(self, s: Array, y: Array, rate: Array) -> Array:
        r, t, k, n = y.reshape(4, 3, -1)
        bent = (n * t).sum(axis=0) - (k * k).sum(axis=0)
        return np.concatenate([t, k, bent * t - n, self.drag(r, t, rate[0]) + self.density(s) * t])

    def ends(self, clamp: Array, tip: Array, _rate: Array) -> Array:
        start = clamp[:6] - [0.0, 0.0, 0.0, 0.0, 0.0, 1.0]
        return np.concatenate([start, clamp[7:8], tip[6:9], tip[9:] + self.end * tip[3:6]])

    def solve(self, guess: Spinning) -> dict[str, float]:
        s, r = np.linspace(0.0, 1.0, guess.model.links + 1), guess.nodes.T
        t = np.gradient(r, s, axis=1, edge_order=2)
        t[:, 0] = [0.0, 0.0, 1.0]
        k = np.gradient(t, s, axis=1, edge_order=2)
        size = np.hypot(k[0, 0], k[1, 0])
        cosine, sine = k[0, 0] / size, k[1, 0] / size
        turn = np.array([[cosine, sine, 0.0], [-sine, cosine, 0.0], [0.0, 0.0, 1.0]])
        r, t, k = turn @ r, turn @ t, turn @ k
        gained = self.drag(r, t, guess.rate) + self.density(s) * t
        summed = cumulative_trapezoid(gained, s, axis=1, initial=0.0)
        n = summed - summed[:, -1:] - self.end * t[:, -1:]
        found = solve_bvp(
            self.along,
            self.ends,
            s,
            np.concatenate([r, t, k, n]),
            p=[guess.rate],
            tol=1e-7,
            max_nodes=20_000,
        )
        assert found.success, found.message
        tangents = np.linalg.norm(found.y[3:6], axis=0)
        np.testing.assert_allclose(tangents, 1.0, atol=1e-8)
        return {
            "frequency": abs(float(found.p[0])) / (2.0 * np.pi),
            "bending_energy": self.energy(found),
            "tip_radius": float(np.hypot(*found.y[:2, -1])),
            "tip_height": float(found.y[2, -1]),
        }

    @staticmethod
    def energy(found: object) -> float:
        """Return half the integral of |k|^2, by Gauss' rule on each interval."""
        x, weight = np.polynomial.legendre.leggauss(4)
        h = np.diff(found.x)[:, None]  # type: ignore[attr-defined]
        s = found.x[:-1, None] + 0.5 * h * (x + 1.0)  # type: ignore[attr-defined]
        k = found.sol(s.ravel())[6:9]  # type: ignore[attr-defined]
        square = (k**2).sum(axis=0).reshape(s.shape)
        return float(0.25 * (h * weight * square).sum())


@pytest.mark.parametrize(
    "model",
    [
        Filament(24, TipLoad(75.0)),
        Filament(24, TipLoad(75.0), drag_ratio=1.5),
        Filament(32, TipLoad(150.0)),
        Filament(24, LinearLoad(110.0, 0.0)),
        Filament(24, LinearLoad(110.0, 0.7)),
    ],
    ids=repr,
)
def test_many_links_converge_to_the_boundary_value_problem_of_the_filament(
    model: Filament,
) -> None:
    limit = extrapolate(model, "spinning")
    assert not isinstance(limit, NotFound)
    expected = Continuum(model.load, model.drag_ratio).solve(limit.finest)
    for name, value in expected.items():
        # Six digits; the collocation is asked for seven.
        assert limit.values[name] == pytest.approx(value, rel=1e-6), name
        assert abs(limit.values[name] - value) <= limit.errors[name] + 1e-7 * value


def test_the_straight_state_is_no_solution_whatever_the_rate() -> None:
    state = solved(MODEL)
    straight = MODEL.unknowns(MODEL.straight())
    for rate in (0.0, state.rate):
        u = np.append(straight, rate)
        assert solve_at(problem_of(state), u, state.force) is None
    within = np.append(straight + 1e-9 * (state.unknowns - straight), state.rate)
    assert solve_at(problem_of(state), within, state.force) is None
