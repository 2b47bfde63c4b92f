"""Periodic orbits, also up to a symmetry, of systems whose orbits are known."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from cycles import Carousel, Globe, Row
from flows import VanDerPol, Weighed
from searches import EXACT, TURNING, found, mirrored, near, search, shooting
from undula.arrays import Array
from undula.numerics.continuation.newton import newton
from undula.numerics.orbits.collocation import Outcome
from undula.numerics.orbits.periodic_orbit import find_orbit, time_error
from undula.numerics.orbits.shooting import Shooting, admissible
from undula.numerics.orbits.symmetry import OrbitSymmetry


@pytest.mark.parametrize("equations", [Row(), Row(count=3), Globe()], ids=repr)
@pytest.mark.parametrize(
    ("stages", "intervals"), [(2, [24, 36, 54]), (3, [16, 24, 36]), (4, [8, 12, 18])]
)
def test_the_period_is_found_at_the_order_of_the_method(
    equations: Any, stages: int, intervals: list[int]
) -> None:
    orbits = [found(search(equations, count, stages)) for count in intervals]
    errors = [abs(orbit.shot.duration - equations.period) for orbit in orbits]
    order = -np.polyfit(np.log(intervals), np.log(errors), 1)[0]
    assert order == pytest.approx(2 * stages - 1, abs=0.15)
    # The difference to 3/2 the intervals leaves out the error there, (2/3)^order of this one's.
    part = 1.0 - (2.0 / 3.0) ** (2 * stages - 1)
    assert time_error(orbits[-1]) == pytest.approx(part * errors[-1], rel=0.1)


@pytest.mark.parametrize(
    ("equations", "symmetry"), [(Row(count=3), EXACT), (Globe(), EXACT), (Carousel(), TURNING)]
)
def test_newton_s_method_converges_quadratically_also_from_off_the_constraint(
    equations: Any, symmetry: OrbitSymmetry
) -> None:
    times = [equations.period, equations.turning * equations.period]
    known = [1, 2][symmetry is TURNING]
    u = near(equations.on_orbit()[equations.differential], *times[:known])
    result = find_orbit(shooting(equations, 24, symmetry), u, 0.0)
    assert result.solution is not None
    assert result.solution.has_converged
    steps = np.array(result.solution.steps)
    assert 4 <= steps.size <= 6
    # By curvature over slope, below 30 here, and down to round-off.
    assert np.all(steps[1:] < 30.0 * steps[:-1] ** 2 + 1e-13)


def test_a_start_off_the_constraint_is_moved_onto_it_by_the_least() -> None:
    y = admissible(Globe(), np.array([0.9, 0.3, 0.7, 0.0]))
    # On a sphere the nearest point is the one in the same direction.
    np.testing.assert_allclose(y[:3], np.array([0.9, 0.3, 0.7]) / np.sqrt(1.39), rtol=1e-14)
    assert y[3] == 0.0


def test_half_a_period_up_to_a_reflection_is_half_the_orbit() -> None:
    row = Row(count=2)
    half = shooting(row, 12, OrbitSymmetry(mirrored))
    result = found(find_orbit(half, near(row.on_orbit(), 0.5 * row.period), 0.0))
    whole = found(search(row, 24))
    # The same intervals: the same orbit to the round-off that Newton's method ends at.
    assert 2.0 * result.shot.duration == pytest.approx(whole.shot.duration, rel=1e-12)


def test_a_motion_that_repeats_itself_when_turned_is_found_with_its_angle() -> None:
    ride, counts, errors = Carousel(), [24, 36, 54], []
    for count in counts:
        u = near(ride.on_orbit(), ride.period, ride.turning * ride.period)
        orbit = found(find_orbit(shooting(ride, count, TURNING), u, 0.0))
        errors.append(
            [orbit.shot.duration - ride.period, orbit.shot.angle - ride.turning * ride.period]
        )
    slopes = -np.polyfit(np.log(counts), np.log(np.abs(errors)), 1)[0]
    np.testing.assert_allclose(slopes, 5.0, atol=0.15)


def test_phase_conditions_keep_the_start_across_from_the_guess() -> None:
    ride = Carousel()
    u = near(ride.on_orbit(), ride.period, ride.turning * ride.period)
    orbit = found(find_orbit(shooting(ride, 24, TURNING), u, 0.0))
    first = shooting(ride, 24, TURNING).shoot(u, 0.0)
    assert not isinstance(first, Outcome)
    moved = orbit.u[:3] - u[:3]
    assert np.linalg.norm(moved) > 1e-3
    # Linear conditions are met to round-off.
    assert abs(moved @ first.velocity) < 1e-14
    assert abs(moved @ first.turning) < 1e-14


@pytest.mark.parametrize("mu", [1.0, 2.0])
def test_van_der_pol_s_period_agrees_with_a_long_run_of_another_method(mu: float) -> None:
    def rate(_: float, y: Array) -> Array:
        return -VanDerPol(mu).residual(y, np.zeros(2))

    def rising(_: float, y: Array) -> float:
        return float(y[0])

    rising.direction = 1.0  # type: ignore[attr-defined]
    run = solve_ivp(rate, (0.0, 80.0), [2.0, 0.0], "DOP853", events=rising, rtol=1e-12, atol=1e-12)
    period = np.diff(run.t_events[0])[-1]
    orbit = found(
        find_orbit(shooting(VanDerPol(mu), 200, stages=4), np.array([2.0, 0.1, period]), 0)
    )
    # The run's tolerance adds up over a period; the orbit is off by less than 3e-11.
    assert orbit.shot.duration == pytest.approx(period, rel=1e-10)
    assert time_error(orbit) < 1e-9


def row_of(growth: float) -> Any:
    return Row(growth=growth, count=2)


def test_derivatives_of_the_residual_are_those_of_differences() -> None:
    ride, p = Carousel(), 0.4
    shoot = Shooting(lambda shear: replace(ride, shear=shear), TURNING, 8)
    u = near(ride.on_orbit(), ride.period, ride.turning * ride.period)
    problem = found(find_orbit(shoot, u, p)).problem
    at = problem.evaluate(u, p)
    # The error of a central difference with this step, for values of order 10.
    delta = 1e-5

    def difference(du: Array, dp: float) -> Array:
        more, less = (problem.evaluate(u + d * du, p + d * dp) for d in (delta, -delta))
        return (more.residual - less.residual) / (2.0 * delta)

    np.testing.assert_allclose(at.by_parameter, difference(np.zeros(5), 1.0), atol=1e-7)
    differences = [difference(direction, 0.0) for direction in np.eye(5)]
    np.testing.assert_allclose(at.linear.matrix, np.transpose(differences), atol=1e-7)  # type: ignore[attr-defined]


def test_the_derivative_of_the_residual_holds_across_and_off_the_constraint() -> None:
    problem = found(search(Globe(), 8)).problem
    u = np.append(Globe().on_orbit()[:3], Globe().period)
    at, delta = problem.evaluate(u, 0.0), 1e-5
    for direction in np.eye(4):
        more, less = (problem.evaluate(u + d * direction, 0.0).residual for d in (delta, -delta))
        found_slope = at.linear.matrix @ direction  # type: ignore[attr-defined]
        np.testing.assert_allclose(found_slope, (more - less) / (2.0 * delta), atol=1e-7)


def test_orbit_and_period_follow_the_parameter_as_they_should() -> None:
    # T = 2 pi / (W + b m), r = sqrt(m).
    shoot, m = Shooting(row_of, OrbitSymmetry(), 60), 1.3
    orbit = found(find_orbit(shoot, near(row_of(m).on_orbit(), row_of(m).period), m))
    at = orbit.problem.evaluate(orbit.u, m)
    nothing = np.zeros(orbit.u.size)
    change, _ = at.linear.solve(nothing, nothing, 1.0, -at.by_parameter, 0.0)
    row = row_of(m)
    # The time error with 60 intervals, some 1e-9, and that of the difference by the parameter.
    assert change[-1] == pytest.approx(-row.twist * row.period**2 / (2.0 * np.pi), rel=1e-7)
    radius = np.hypot(orbit.u[0], orbit.u[1])
    assert change[:2] @ orbit.u[:2] / radius == pytest.approx(0.5 / np.sqrt(m), rel=1e-7)


def test_a_neighbouring_orbit_is_found_from_the_last_with_few_steps() -> None:
    shoot = Shooting(row_of, OrbitSymmetry(), 24)
    orbit = found(find_orbit(shoot, near(row_of(1.0).on_orbit(), row_of(1.0).period), 1.0))
    problem = orbit.problem.with_reference(orbit.u)
    np.testing.assert_array_equal(problem.reference.x, orbit.u[:-1])
    next_one = newton(problem, orbit.u, 1.01)
    assert next_one.has_converged
    assert len(next_one.steps) <= 4
    # The time error with 24 intervals.
    assert next_one.u[-1] == pytest.approx(row_of(1.01).period, rel=1e-7)


def test_changes_are_measured_by_mean_square_parts_of_the_period_and_radians() -> None:
    ride = Carousel()
    u = near(ride.on_orbit(), ride.period, ride.turning * ride.period)
    problem = found(find_orbit(shooting(ride, 24, TURNING), u, 0.0)).problem
    period = problem.reference.duration
    assert np.sum(problem.weights * np.array([0.1, 0.1, 0.1, 0.0, 0.0]) ** 2) == pytest.approx(0.01)
    assert np.sum(problem.weights * np.array([0, 0, 0, period, 0.0]) ** 2) == pytest.approx(1.0)
    assert problem.weights[-1] == 1.0


def test_equations_with_a_state_dependent_weight_have_the_same_orbit() -> None:
    guess = near(Globe().on_orbit()[:3], Globe().period)
    plain, weighed = (
        found(find_orbit(shooting(equations, 16), guess, 0.0))
        for equations in (Globe(), Weighed(Globe()))
    )
    # Both to the round-off that Newton's method ends at.
    np.testing.assert_allclose(plain.u, weighed.u, rtol=1e-11, atol=1e-13)


@pytest.mark.parametrize(
    ("guess", "word"),
    [
        (np.array([0.0, 0.0, 3.0]), "equilibrium"),
        (np.array([1.0, 0.0, -1.0]), "could not be followed"),
        (np.array([1.0, np.nan, 1.0]), "could not be followed"),
        # From here a step leads to no time at all.
        (np.array([1e-3, 1e-3, 1.0]), "begin"),
    ],
)
def test_a_guess_that_leads_nowhere_gives_advice_instead_of_an_orbit(
    guess: Array, word: str
) -> None:
    result = find_orbit(shooting(Row(), 16), guess, 0.0)
    assert result.orbit is None
    assert word in result.advice


def test_the_problem_has_no_value_where_there_is_no_flow() -> None:
    problem = found(search(Row(), 16)).problem
    at = problem.evaluate(np.array([1.0, 0.0, -2.0]), 0.0)
    assert np.isnan(at.residual).all()
    assert np.isnan(at.by_parameter).all()
