"""Tables of Radau IIA against closed forms and against what defines them."""

import numpy as np
import pytest

from undula.numerics.orbits.radau import interpolation, radau

every_table = pytest.mark.parametrize("stages", [1, 2, 3, 4, 5])


def runge_kutta(stages: int) -> np.ndarray:
    """Return Butcher's matrix of the method: the inverse of D on the stages."""
    return np.linalg.inv(radau(stages).differentiation[:, 1:])


def test_the_table_of_order_five_is_the_published_one() -> None:
    # Hairer & Wanner, Solving Ordinary Differential Equations II, section IV.5, table 5.6.
    root = np.sqrt(6.0)
    published = [
        [(88 - 7 * root) / 360, (296 - 169 * root) / 1800, (-2 + 3 * root) / 225],
        [(296 + 169 * root) / 1800, (88 + 7 * root) / 360, (-2 - 3 * root) / 225],
        [(16 - root) / 36, (16 + root) / 36, 1 / 9],
    ]
    # Round-off of an inverse of condition number below 100.
    np.testing.assert_allclose(runge_kutta(3), published, rtol=1e-13)
    np.testing.assert_allclose(radau(3).nodes, np.sum(published, axis=1), rtol=1e-14)


@every_table
def test_polynomials_of_degree_s_are_differentiated_exactly_and_no_others(stages: int) -> None:
    table = radau(stages)
    for degree in range(stages + 2):
        exact = degree * table.nodes ** max(0, degree - 1)
        wrong = np.abs(table.differentiation @ table.grid**degree - exact).max()
        # Round-off of entries below 100; a higher degree is off by more than 1e-3.
        assert wrong < 1e-12 if degree <= stages else wrong > 1e-3


@every_table
def test_the_quadrature_has_the_order_that_the_method_claims(stages: int) -> None:
    table, weights = radau(stages), runge_kutta(stages)[-1]
    wrong = [
        abs(weights @ table.nodes**degree - 1.0 / (degree + 1)) for degree in range(table.order + 1)
    ]
    # Round-off of sums of numbers below 1; the first degree that is not exact is off by 1e-6.
    assert max(wrong[:-1]) < 1e-14
    assert wrong[-1] > 1e-7


@every_table
def test_fast_decay_is_damped_at_once_and_oscillations_never_grow(stages: int) -> None:
    matrix, ones = runge_kutta(stages), np.ones(stages)

    def amplification(z: complex) -> float:
        return abs(1.0 + z * matrix[-1] @ np.linalg.solve(np.eye(stages) - z * matrix, ones))

    # It falls as 1/z, by a factor s^2 at most.
    assert amplification(-1e8) < 1e-6
    assert all(amplification(1j * y) <= 1.0 + 1e-12 for y in np.logspace(-3, 3, 61))


def test_a_polynomial_goes_through_values_anywhere() -> None:
    grid, points = radau(4).grid, np.array([-0.3, 0.0, 0.41, 1.0, 1.7])
    found = interpolation(grid, points) @ np.polyval([2.0, -1.0, 0.5, 3.0, 1.0], grid)
    # Round-off, enlarged by coefficients below 100 where the polynomial is extrapolated.
    np.testing.assert_allclose(found, np.polyval([2.0, -1.0, 0.5, 3.0, 1.0], points), rtol=1e-12)


def test_the_times_of_all_stages_end_with_the_end() -> None:
    times = radau(3).times(4)
    assert times.shape == (4, 3)
    np.testing.assert_array_equal(times[:, -1], [0.25, 0.5, 0.75, 1.0])
    assert np.all(np.diff(times.ravel()) > 0.0)
