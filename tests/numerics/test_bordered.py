"""Bordered banded systems, against numpy's dense ones."""

import numpy as np
import pytest

from undula.arrays import Array
from undula.numerics.linalg.banded import to_dense
from undula.numerics.linalg.bordered import BandFactors, BorderedBand

SHAPES = [(1, 0), (2, 1), (7, 1), (7, 6), (30, 3), (60, 11)]
every_shape = pytest.mark.parametrize(("rows", "half"), SHAPES)


def random_band(rows: int, half: int, rng: np.random.Generator) -> Array:
    """Return a random band, zero where a row sticks out of the matrix."""
    columns = np.arange(rows)[:, None] + np.arange(-half, half + 1)
    inside = (columns >= 0) & (columns < rows)
    return np.where(inside, rng.normal(size=(rows, 2 * half + 1)), 0.0)


def with_null_vector(band: Array, vector: Array) -> Array:
    """Return the band with a diagonal for which it takes the vector, which has no zeros, to 0."""
    half = band.shape[1] // 2
    singular = band.copy()
    singular[:, half] = 0.0
    singular[:, half] = -(to_dense(singular) @ vector) / vector
    return singular


def random_null_vector(rows: int, rng: np.random.Generator) -> Array:
    return np.asarray(rng.uniform(0.5, 2.0, rows) * rng.choice([-1.0, 1.0], rows))


def assert_solves_like_numpy(
    band: Array, borders: int, rng: np.random.Generator, shifted: int | None = None
) -> None:
    n, q = band.shape[0], borders
    columns, rows, corner = (rng.normal(size=size) for size in ((n, q), (q, n), (q, q)))
    column, row, right = rng.normal(size=(3, n + q))
    dense = np.block(
        [
            [to_dense(band), columns, column[:n, None]],
            [rows, corner, column[n:, None]],
            [row[None, :], np.array([[0.7]])],
        ]
    )
    expected = np.linalg.solve(dense, np.append(right, -1.3))
    linear = BorderedBand(band, columns, rows, corner, shifted)
    x, y = linear.solve(column, row, 0.7, right, -1.3)
    assert x.shape == (n + q,)
    # Condition numbers of up to 1e5 leave this of sixteen digits.
    np.testing.assert_allclose(np.append(x, y), expected, atol=1e-10 * np.abs(expected).max())


@every_shape
def test_a_band_is_solved_like_numpy_does(rows: int, half: int) -> None:
    rng = np.random.default_rng(rows)
    band = random_band(rows, half, rng)
    for right in (rng.normal(size=rows), rng.normal(size=(rows, 3))):
        expected = np.linalg.solve(to_dense(band), right)
        found = BandFactors(band).solve(right)
        np.testing.assert_allclose(found, expected, atol=1e-10 * np.abs(expected).max())


@every_shape
@pytest.mark.parametrize("borders", [0, 1, 3])
@pytest.mark.parametrize("seed", range(5))
def test_a_bordered_band_is_solved_like_numpy_does(
    rows: int, half: int, borders: int, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    assert_solves_like_numpy(random_band(rows, half, rng), borders, rng)


@pytest.mark.parametrize(("rows", "half"), SHAPES[1:])
@pytest.mark.parametrize("borders", [0, 1, 3])
@pytest.mark.parametrize("seed", range(5))
def test_a_singular_band_is_solved_where_its_null_vector_is_known(
    rows: int, half: int, borders: int, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    vector = random_null_vector(rows, rng)
    band = with_null_vector(random_band(rows, half, rng), vector)
    assert np.linalg.matrix_rank(to_dense(band)) == rows - 1
    assert_solves_like_numpy(band, borders, rng, shifted=int(np.argmax(np.abs(vector))))


@pytest.mark.parametrize("distance", [1e-4, 1e-8, 1e-12, 0.0])
def test_no_digit_is_lost_on_the_way_to_a_singular_band(distance: float) -> None:
    rng = np.random.default_rng(4)
    vector = random_null_vector(40, rng)
    band = with_null_vector(random_band(40, 4, rng), vector)
    band[:, 4] += distance
    assert_solves_like_numpy(band, 1, rng, shifted=int(np.argmax(np.abs(vector))))


def test_a_regular_band_may_be_softened_as_well() -> None:
    rng = np.random.default_rng(3)
    assert_solves_like_numpy(random_band(20, 2, rng), 1, rng, shifted=7)


def test_the_matrices_that_were_given_are_left_alone() -> None:
    rng = np.random.default_rng(1)
    given = random_band(9, 2, rng), rng.normal(size=(9, 1)), rng.normal(size=(1, 9)), np.eye(1)
    copies = [matrix.copy() for matrix in given]
    linear = BorderedBand(*given, shifted=4)
    first = linear.solve(np.ones(10), np.ones(10), 0.0, np.ones(10), 1.0)
    second = linear.solve(np.ones(10), np.ones(10), 0.0, np.ones(10), 1.0)
    for matrix, copy in zip(given, copies, strict=True):
        np.testing.assert_array_equal(matrix, copy)
    np.testing.assert_array_equal(first[0], second[0])


@pytest.mark.parametrize("row", [0, 3, 8])
def test_a_pivot_that_vanishes_is_an_error(row: int) -> None:
    band = np.zeros((9, 5))
    band[:, 2] = 1.0
    band[row, 2] = 0.0
    with pytest.raises(np.linalg.LinAlgError, match="vanishes"):
        BandFactors(band)
    with pytest.raises(np.linalg.LinAlgError, match=f"pivot {row + 1}"):
        BorderedBand(band, np.ones((9, 1)), np.ones((1, 9)), np.zeros((1, 1)))
    # Softened there it is regular.
    band[row, 1 if row else 3] = 1.0
    BorderedBand(band, np.ones((9, 1)), np.ones((1, 9)), np.zeros((1, 1)), shifted=row)
