"""Banded linear systems, against numpy's dense ones."""

import numpy as np
import pytest

from undula.numerics.banded import factor_kernel, solve_kernel, to_dense

HALF_BANDWIDTHS = range(1, 12)


def random_band(rows: int, half: int, rng: np.random.Generator) -> np.ndarray:
    """Return a random band, zero where a row sticks out of the matrix."""
    columns = np.arange(rows)[:, None] + np.arange(-half, half + 1)
    inside = (columns >= 0) & (columns < rows)
    return np.where(inside, rng.normal(size=(rows, 2 * half + 1)), 0.0)


def dominant_band(rows: int, half: int, rng: np.random.Generator) -> np.ndarray:
    """Return a band whose diagonal outweighs its row, so that no pivot can be small."""
    band = random_band(rows, half, rng)
    band[:, half] = np.sign(band[:, half]) * (1.0 + np.abs(band).sum(axis=1))
    return band


def saddle_band(points: int, half: int, rng: np.random.Generator) -> np.ndarray:
    """Return the band of a chain: each point has half - 1 positions and then one multiplier.

    A constraint weighs the positions of its own point, and the diagonal of its row is zero.
    """
    width = half  # positions and the multiplier of one point
    band = np.zeros((points * width, 2 * half + 1))
    for first in range(0, points * width, width):
        for i in range(first, first + width - 1):
            band[i, half] = 4.0 + rng.random()
            if i >= width:
                band[i, 0] = band[i - width, 2 * half] = -1.0 - rng.random()
            weight = 1.0 + rng.random()
            last = first + width - 1
            band[i, half + last - i] = band[last, half + i - last] = weight
    return band


def solution(band: np.ndarray, right: np.ndarray) -> np.ndarray:
    half = band.shape[1] // 2
    factors, x = band.copy(), right.copy()
    assert factor_kernel(half)(factors)
    solve_kernel(half)(factors, x)
    return x


@pytest.mark.parametrize("half", HALF_BANDWIDTHS)
def test_a_dominant_system_of_any_size_is_solved_like_numpy_does(half: int) -> None:
    rng = np.random.default_rng(half)
    for rows in [*range(1, half + 3), 3 * half + 1, 60]:
        band, right = dominant_band(rows, half, rng), rng.normal(size=rows)
        expected = np.linalg.solve(to_dense(band), right)
        # Dominant rows keep the condition number near 10, so round-off stays near 1e-15.
        np.testing.assert_allclose(solution(band, right), expected, rtol=1e-12, atol=1e-14)


@pytest.mark.parametrize("half", range(2, 12))
def test_a_saddle_with_zeros_on_its_diagonal_needs_no_pivoting(half: int) -> None:
    rng = np.random.default_rng(half)
    for points in (1, 2, 3, 12):
        band = saddle_band(points, half, rng)
        right = rng.normal(size=band.shape[0])
        matrix = to_dense(band)
        assert np.count_nonzero(matrix.diagonal() == 0.0) == points
        # Elimination without pivoting loses the growth of its factors, below 1e3 here.
        np.testing.assert_allclose(matrix @ solution(band, right), right, atol=1e-12)


@pytest.mark.parametrize("half", [1, 4, 11])
@pytest.mark.parametrize("row", [0, 2, 19])
def test_a_pivot_that_vanishes_is_reported(half: int, row: int) -> None:
    band = np.zeros((20, 2 * half + 1))
    band[:, half] = 1.0
    band[row, half] = 0.0
    assert not factor_kernel(half)(band)


@pytest.mark.parametrize("half", [1, 4, 11])
@pytest.mark.parametrize("row", [0, 19])
def test_a_pivot_that_is_no_number_is_reported(half: int, row: int) -> None:
    band = np.zeros((20, 2 * half + 1))
    band[:, half] = 1.0
    band[row, half] = np.nan
    assert not factor_kernel(half)(band)


def test_a_pivot_that_vanishes_by_elimination_is_reported() -> None:
    ones = np.array([[0.0, 1.0, 1.0], [1.0, 1.0, 0.0]])
    assert np.linalg.matrix_rank(to_dense(ones)) == 1
    assert not factor_kernel(1)(ones)


def test_the_dense_matrix_holds_every_entry_of_the_band_at_its_place() -> None:
    band = np.array([[0.0, 1.0, 2.0], [3.0, 4.0, 5.0], [6.0, 7.0, 0.0]])
    expected = [[1.0, 2.0, 0.0], [3.0, 4.0, 5.0], [0.0, 6.0, 7.0]]
    np.testing.assert_array_equal(to_dense(band), expected)
