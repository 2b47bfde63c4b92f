"""Floquet multipliers of orbits whose multipliers are known."""

from typing import Any

import numpy as np
import pytest

from cycles import Carousel, Globe, Row
from searches import TURNING, found, mirrored, near, search, shooting
from undula.numerics.orbits.floquet import floquet, floquet_of
from undula.numerics.orbits.flow import linearised_flow
from undula.numerics.orbits.periodic_orbit import Orbit, find_orbit
from undula.numerics.orbits.symmetry import OrbitSymmetry


def ridden(intervals: int) -> Orbit:
    """Return the carousel's orbit."""
    ride = Carousel()
    u = near(ride.on_orbit(), ride.period, ride.turning * ride.period)
    return found(find_orbit(shooting(ride, intervals, TURNING), u, 0.0))


@pytest.mark.parametrize("row", [Row(), Row(count=4)], ids=repr)
def test_multipliers_of_a_row_of_oscillators_are_the_exact_ones(row: Row) -> None:
    orbit = found(search(row, 60))
    seen = floquet_of(orbit.shot)
    # The time error of a period in 60 intervals at order 5, in T as in the rest.
    np.testing.assert_allclose(seen.exponents(orbit.shot.duration).real, row.rates, rtol=1e-7)
    assert np.all(np.diff(np.abs(seen.multipliers)) <= 0.0)
    assert seen.trivial_errors[0] < 1e-8


def test_multipliers_under_a_constraint_are_the_exact_ones() -> None:
    orbit = found(search(Globe(), 100))
    seen = floquet_of(orbit.shot)
    assert seen.multipliers.shape == (1,)
    # The time error, as above.
    assert seen.exponents(orbit.shot.duration)[0].real == pytest.approx(Globe().rate, rel=1e-7)
    assert seen.trivial_errors[0] < 1e-8


def test_errors_of_the_trivial_multiplier_fall_at_the_order_of_the_method() -> None:
    counts = [24, 36, 54]
    errors = [floquet_of(found(search(Globe(), count)).shot).trivial_errors[0] for count in counts]
    slope = -np.polyfit(np.log(counts), np.log(errors), 1)[0]
    assert slope == pytest.approx(5.0, abs=0.15)


def test_a_turning_motion_has_two_trivial_multipliers_and_those_of_its_shape() -> None:
    orbit, ride = ridden(60), Carousel()
    seen = floquet_of(orbit.shot)
    assert seen.multipliers.shape == (1,)
    rate = seen.exponents(orbit.shot.duration)[0].real
    assert rate == pytest.approx(ride.oscillator.rates[0], rel=1e-7)
    assert np.all(seen.trivial_errors < 1e-8)
    # A rotation is a symmetry of the discrete flow itself, whose derivatives are exact.
    assert seen.trivial_errors[1] < 1e-10


def test_multipliers_of_half_a_period_up_to_a_reflection_are_roots_of_the_full_ones() -> None:
    row = Row(count=3)
    guess = near(row.on_orbit(), 0.5 * row.period)
    half = found(find_orbit(shooting(row, 20, OrbitSymmetry(mirrored)), guess, 0.0))
    whole = found(search(row, 40))
    one, other = floquet_of(half.shot), floquet_of(whole.shot)
    # The same intervals: the same discrete flow, to round-off of multipliers up to 1.
    np.testing.assert_allclose(one.multipliers**2, other.multipliers, atol=1e-9)


def test_vectors_are_eigenvectors_up_to_the_known_directions() -> None:
    orbit = found(search(Row(count=3), 30))
    seen, matrix = floquet_of(orbit.shot), orbit.shot.monodromy
    velocity = orbit.shot.basis.T @ orbit.shot.velocity
    velocity /= np.linalg.norm(velocity)
    left = matrix @ seen.vectors - seen.vectors * seen.multipliers
    across = left - np.outer(velocity, velocity @ left)
    # Round-off of a matrix of norm below 10, and of the error of the velocity.
    assert np.abs(across).max() < 1e-10
    assert np.abs(velocity @ seen.vectors).max() < 1e-13
    np.testing.assert_allclose(np.linalg.norm(seen.vectors, axis=0), 1.0, rtol=1e-13)


def test_a_synchronous_motion_seen_in_the_row_has_the_row_s_multipliers() -> None:
    row, alone = Row(count=4), found(search(Row(), 30)).shot
    start, stages = np.tile(alone.y, 4), np.tile(alone.flow.stages, 4)
    columns = np.eye(8)
    change = linearised_flow(row, start, stages, alone.duration, columns)
    assert change is not None
    seen = floquet(change.by_start, np.tile(alone.velocity, 4)[:, None], np.ones(1))
    whole = floquet_of(found(search(row, 30)).shot)
    # The same orbit at another phase, which the discrete flow tells by its time error alone.
    np.testing.assert_allclose(seen.multipliers, whole.multipliers, atol=1e-7)


def known(values: list[Any], directions: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Return a matrix with these eigenvalues, and the eigenvectors of the first ones."""
    vectors = np.random.default_rng(seed).normal(size=(len(values),) * 2)
    matrix = vectors @ np.diag(values) @ np.linalg.inv(vectors)
    return matrix, vectors[:, :directions]


def test_known_multipliers_may_have_any_value() -> None:
    matrix, directions = known([1.0, -1.0, 0.3, -0.8], 2)
    seen = floquet(matrix, directions, np.array([1.0, -1.0]))
    # Round-off of a matrix of condition number below 100.
    np.testing.assert_allclose(seen.multipliers, [-0.8, 0.3], atol=1e-12)
    assert np.all(seen.trivial_errors < 1e-12)
    wrong = floquet(matrix, directions, np.array([1.0, 1.0]))
    assert wrong.trivial_errors[1] == pytest.approx(2.0, abs=1e-12)


def test_a_multiplier_that_meets_the_trivial_one_loses_no_accuracy() -> None:
    # At a fold of orbits the two share one eigenvector.
    vectors = np.random.default_rng(1).normal(size=(3, 3))
    block = np.array([[1.0, 5.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.2]])
    matrix = vectors @ block @ np.linalg.inv(vectors)
    matrix += 1e-13 * np.random.default_rng(2).normal(size=(3, 3))
    seen = floquet(matrix, vectors[:, :1], np.ones(1))
    # What was added, enlarged by a condition number below 100; a root of it would be 1e-6.
    np.testing.assert_allclose(seen.multipliers, [1.0, 0.2], atol=1e-10)
    assert np.abs(np.linalg.eigvals(matrix) - 1.0).min() > 1e-8


def test_without_known_directions_all_multipliers_are_found() -> None:
    matrix, _ = known([2.0, 0.5, -0.1], 0)
    seen = floquet(matrix, np.zeros((3, 0)), np.zeros(0))
    np.testing.assert_allclose(seen.multipliers, [2.0, 0.5, -0.1], atol=1e-12)
    assert seen.trivial_errors.shape == (0,)


def test_what_is_gone_after_an_orbit_has_no_exponent() -> None:
    seen = floquet(np.diag([1.0, 0.5, 0.0]), np.eye(3)[:, :1], np.ones(1))
    np.testing.assert_array_equal(seen.exponents(2.0), [np.log(0.5) / 2.0])


def test_a_motion_that_has_come_to_rest_has_multipliers_and_no_known_error() -> None:
    with np.errstate(all="raise"):
        told = floquet(np.diag([0.5, 0.25]), np.zeros((2, 1)), np.ones(1))
    assert np.isinf(told.trivial_errors).all()
    assert np.isfinite(told.multipliers).all()
