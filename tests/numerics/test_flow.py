"""The flow of exactly known systems: orders, sensitivities, starts and failures."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from cycles import Carousel, Globe, Row
from flows import Bead, Follower, VanDerPol, Weighed, Written
from undula.arrays import Array
from undula.numerics.linalg.banded import to_dense
from undula.numerics.orbits.collocation import Outcome, Scheme, _stage_matrix, solve_stages
from undula.numerics.orbits.flow import Flow, flow, linearised_flow, resampled
from undula.numerics.orbits.radau import radau

#: Stages, and intervals with which errors are neither large nor round-off.
METHODS = [(1, [200, 400, 800]), (2, [40, 80, 160]), (3, [12, 18, 27, 40]), (4, [6, 9, 13])]
every_method = pytest.mark.parametrize(("stages", "intervals"), METHODS)
TIME = 2.0

#: Systems of all kinds with a start near which motions are smooth, and a time.
CASES: list[tuple[Any, Array, float]] = [
    (Row(count=3), np.array([0.9, 0.1, 1.1, -0.3, 0.7, 0.2]), 1.7),
    (Bead(5.0), np.array([1.0, 0.0, 0.0, 0.0]), 1.3),
    (Globe(), Globe().on_orbit(), 2.0),
    (Carousel(), np.array([3.5, 0.3, 0.4]), 1.5),
    (Weighed(Globe()), Globe().on_orbit(), 2.0),
    (VanDerPol(2.0), np.array([1.0, 0.5]), 2.0),
]
every_case = pytest.mark.parametrize(("equations", "start", "time"), CASES, ids=lambda c: repr(c))


def end_of(equations: Any, start: Array, intervals: int, stages: int) -> Array:
    done = flow(equations, start, TIME, intervals, method=radau(stages))
    assert done.outcome is Outcome.DONE
    return done.end


def slope(intervals: list[int], errors: list[float]) -> float:
    """Return the order at which errors fall."""
    return float(-np.polyfit(np.log(intervals), np.log(errors), 1)[0])


@every_method
def test_a_smooth_motion_is_followed_at_order_two_s_minus_one(
    stages: int, intervals: list[int]
) -> None:
    start = np.array([1.0, 0.0])
    errors = [abs(end_of(Follower(1.0), start, k, stages)[0] - np.cos(TIME)) for k in intervals]
    assert slope(intervals, errors) == pytest.approx(2 * stages - 1, abs=0.15)


@every_method
def test_a_stiff_motion_is_followed_at_the_order_of_the_stages(
    stages: int, intervals: list[int]
) -> None:
    # Where h K is large only the order s of the stages is left, with a factor 1/K: Hairer &
    # Wanner, Solving Ordinary Differential Equations II, section IV.15.
    start, stiffness = np.array([1.0, 0.0]), 1e5
    errors = [
        abs(end_of(Follower(stiffness), start, k, stages)[0] - np.cos(TIME)) for k in intervals
    ]
    assert slope(intervals, errors) == pytest.approx(stages, abs=0.15)
    steps = TIME / np.array(intervals)
    assert np.all(errors < steps**stages / stiffness)


@every_method
def test_with_constraints_positions_keep_their_order_and_multipliers_have_order_s(
    stages: int, intervals: list[int]
) -> None:
    bead = Bead(3.0)
    ends = [end_of(bead, np.array([1.0, 0.0, 0.0, 0.0]), k, stages) for k in intervals]
    where = np.array([np.cos(np.sin(TIME)), np.sin(np.sin(TIME))])
    errors = [float(np.abs(end[:2] - where).max()) for end in ends]
    assert slope(intervals, errors) == pytest.approx(2 * stages - 1, abs=0.15)
    pulls = [abs(end[2] + bead.stiffness) for end in ends]
    # Multipliers reach their order late: 4 stages are still at 3.7 on these intervals.
    assert slope(intervals, pulls) == pytest.approx(stages, abs=0.35)


def test_the_constraint_holds_at_the_end_to_round_off() -> None:
    end = end_of(Bead(1e4), np.array([1.0, 0.0, 0.0, 0.0]), 5, 3)
    assert abs(np.hypot(end[0], end[1]) - 1.0) < 1e-14


def test_multipliers_of_the_start_do_not_matter() -> None:
    starts = [np.array([0.8, 0.0, 0.6, pull]) for pull in (0.0, -20.0, 300.0)]
    ends = [flow(Globe(), start, 1.0, 6).end for start in starts]
    # Newton's method ends within round-off of the same stages.
    np.testing.assert_allclose(ends[1:], [ends[0]] * 2, atol=1e-12)


@pytest.mark.parametrize("plain", [Globe(), VanDerPol(2.0)], ids=repr)
def test_a_weight_on_the_equations_changes_nothing(plain: Written) -> None:
    start = Globe().on_orbit() if plain.multipliers else np.array([1.0, 0.5])
    columns = plain.displacements(start)
    one, other = (flow(equations, start, 1.0, 5, columns) for equations in (plain, Weighed(plain)))
    # The same stages to round-off, and matrices as exact as Newton's last step was small.
    np.testing.assert_allclose(one.stages, other.stages, rtol=1e-11, atol=1e-12)
    assert one.sensitivities is not None
    assert other.sensitivities is not None
    np.testing.assert_allclose(one.sensitivities.by_start, other.sensitivities.by_start, atol=1e-8)


def test_oscillators_in_step_run_like_one() -> None:
    start = np.array([0.7, 0.2])
    one = flow(Row(count=1), start, TIME, 8).end
    row = flow(Row(count=5), np.tile(start, 5), TIME, 8).end
    # The same arithmetic but for round-off.
    np.testing.assert_allclose(row, np.tile(one, 5), atol=1e-13)


@pytest.mark.parametrize(("wide", "narrow"), [(3, 1), (1, 2), (2, 0)])
def test_the_band_of_all_stages_holds_what_its_blocks_say(wide: int, narrow: int) -> None:
    rng, s, n = np.random.default_rng(0), 3, 9
    slopes, drag = (rng.normal(size=(s, n, 2 * half + 1)) for half in (wide, narrow))
    rates = rng.normal(size=(s, s))
    expected = np.zeros((n * s, n * s))
    for p in range(s):
        for q in range(s):
            expected[p::s, q::s] = rates[p, q] * to_dense(drag[p])
        expected[p::s, p::s] += to_dense(slopes[p])
    band, reach = _stage_matrix(slopes, drag, rates)
    found = np.zeros_like(expected)
    for i in range(n * s):
        for j in range(max(0, i - reach), min(n * s, i + reach + 1)):
            found[i, j] = band[2 * reach + i - j, j]
    np.testing.assert_array_equal(found, expected)


@every_case
@pytest.mark.parametrize("stages", [2, 3])
def test_sensitivities_are_the_derivatives_of_the_discrete_flow(
    equations: Any, start: Array, time: float, stages: int
) -> None:
    method, columns, moving = radau(stages), equations.displacements(start), equations.differential
    change = flow(equations, start, time, 7, columns, method=method).sensitivities
    assert change is not None
    # A central difference with this step is off by its square and by round-off over it.
    delta = 1e-5

    def end(displacement: Array, longer: float) -> Array:
        return flow(equations, start + displacement, time + longer, 7, method=method).end

    none = np.zeros(start.size)
    by_duration = (end(none, delta) - end(none, -delta)) / (2.0 * delta)
    size = np.abs(change.by_duration).max()
    np.testing.assert_allclose(change.by_duration, by_duration, atol=1e-7 * size)
    for column, by_start in zip(columns.T, change.by_start.T, strict=True):
        difference = (end(delta * column, 0.0) - end(-delta * column, 0.0)) / (2.0 * delta)
        size = max(1.0, float(np.abs(by_start).max()))
        np.testing.assert_allclose(by_start[moving], difference[moving], atol=1e-7 * size)


def test_parameters_have_sensitivities_of_their_own() -> None:
    start, delta = np.array([1.0, 0.3]), 1e-5

    def by_mu(y: Array, w: Array) -> Array:
        return (VanDerPol(3.0).residual(y, w) - VanDerPol(1.0).residual(y, w)) / 2.0

    none = np.zeros((2, 0))
    change = flow(VanDerPol(2.0), start, TIME, 9, none, [by_mu, lambda _, w: -w]).sensitivities
    assert change is not None
    more, less = (flow(VanDerPol(2.0 + d), start, TIME, 9).end for d in (delta, -delta))
    # The error of the central difference, as above.
    np.testing.assert_allclose(change.by_parameters[:, 0], (more - less) / (2 * delta), rtol=1e-7)
    # All velocities made smaller, R w - p w = f, are the same as a shorter time, T / (1 - p).
    np.testing.assert_allclose(change.by_parameters[:, 1], TIME * change.by_duration, rtol=1e-9)


def test_the_derivative_by_the_duration_is_the_velocity_to_the_order_of_positions() -> None:
    counts, errors = [12, 18, 27], []
    for count in counts:
        change = flow(Row(), Row().on_orbit(), 1.0, count, np.zeros((2, 0))).sensitivities
        assert change is not None
        angle = 2.0 * np.pi / Row().period
        exact = angle * np.array([-np.sin(angle), np.cos(angle)])
        errors.append(float(np.abs(change.by_duration - exact).max()))
    assert slope(counts, errors) == pytest.approx(5.0, abs=0.15)


@every_case
def test_a_known_motion_is_linearised_without_solving_for_it(
    equations: Any, start: Array, time: float
) -> None:
    columns = equations.displacements(start)
    done = flow(equations, start, time, 9, columns)
    known = linearised_flow(equations, start, done.stages, time, columns)
    assert known is not None
    assert done.sensitivities is not None
    # The matrices of Newton's last step are as exact as that step was small.
    for name in ("by_start", "by_duration"):
        one, other = getattr(known, name), getattr(done.sensitivities, name)
        np.testing.assert_allclose(one, other, rtol=1e-8, atol=1e-9)


def test_a_small_system_s_motion_is_linearised_in_a_larger_one() -> None:
    row, start = Row(count=4), np.array([0.7, 0.2])
    alone = flow(Row(count=1), start, TIME, 8)
    columns = np.eye(8)
    stages = np.tile(alone.stages, 4)
    seen = linearised_flow(row, np.tile(start, 4), stages, TIME, columns)
    whole = flow(row, np.tile(start, 4), TIME, 8, columns).sensitivities
    assert seen is not None
    assert whole is not None
    # The same stages to round-off.
    np.testing.assert_allclose(seen.by_start, whole.by_start, atol=1e-11)


@every_case
def test_a_start_from_the_stages_themselves_takes_one_step_an_interval(
    equations: Any, start: Array, time: float
) -> None:
    cold = flow(equations, start, time, 9)
    warm = flow(equations, start, time, 9, guess=cold.stages)
    assert warm.steps == 9 < cold.steps
    np.testing.assert_allclose(warm.end, cold.end, rtol=1e-10, atol=1e-11)


def test_a_motion_that_the_first_guess_misses_is_found_by_shorter_intervals() -> None:
    start, half_a_turn = np.array([0.8, 0.0, 0.6, 0.0]), 2.0
    scheme = Scheme(Globe(), radau(3), half_a_turn)
    at_once = solve_stages(scheme, start, np.tile(start, (3, 1)))
    assert at_once.outcome is Outcome.NOT_CONVERGED
    coarse = flow(Globe(), start, 2.0 * half_a_turn, 2)
    assert coarse.outcome is Outcome.DONE
    fine = flow(Globe(), start, 2.0 * half_a_turn, 40)
    # Polynomials of degree 3 for half a turn each are wrong by some tenths, but near this motion.
    np.testing.assert_allclose(coarse.end[:3], fine.end[:3], atol=0.3)


def test_stages_on_other_intervals_are_those_of_the_same_polynomials() -> None:
    start = np.array([0.8, 0.0, 0.6, -20.0])
    coarse = flow(Globe(), start, TIME, 6)
    there = resampled(start, coarse.stages, 15, Globe().differential)
    assert there.shape == (15, 3, 4)
    back = resampled(start, there, 6, Globe().differential)
    # Where a fine interval lies in two coarse ones the polynomials differ, by their error h^4.
    np.testing.assert_allclose(back[:, :, :3], coarse.stages[:, :, :3], atol=2e-3)
    same = resampled(start, coarse.stages, 6, Globe().differential)
    np.testing.assert_allclose(same, coarse.stages, rtol=1e-12)
    doubled = resampled(start, coarse.stages, 12, Globe().differential)
    # Every second interval of twice as many ends where one of these ended.
    np.testing.assert_allclose(doubled[1::2, -1], coarse.stages[:, -1], rtol=1e-12)


@dataclass(frozen=True)
class Broken(Written):
    """y' = 1 + y^2, which is infinite at pi/2; optionally without any equation, or no number."""

    kind: str
    size = 1

    def residual(self, y: Array, w: Array) -> Array:
        if self.kind == "none":
            return np.array([1.0])
        return np.array([np.nan]) if self.kind == "no number" else w - 1.0 - y * y

    def slope(self, y: Array) -> Array:
        return np.zeros((1, 1)) if self.kind == "none" else -2.0 * y[:, None]

    @property
    def drag(self) -> Array:
        return np.zeros((1, 1)) if self.kind == "none" else np.eye(1)


def broken(kind: str) -> Flow:
    return flow(Broken(kind), np.zeros(1), 3.0, 5, np.eye(1))


@pytest.mark.parametrize(
    ("kind", "outcome"),
    [("none", Outcome.SINGULAR), ("no number", Outcome.NOT_FINITE), ("", Outcome.NOT_CONVERGED)],
)
def test_a_flow_that_fails_says_how(kind: str, outcome: Outcome) -> None:
    failed = broken(kind)
    assert failed.outcome is outcome
    assert failed.sensitivities is None
    assert np.isnan(failed.end).all()
    assert "use more intervals" in failed.outcome.value


def test_a_singular_linearisation_is_no_flow() -> None:
    assert linearised_flow(Broken("none"), np.zeros(1), np.zeros((2, 3, 1)), 1.0, np.eye(1)) is None
