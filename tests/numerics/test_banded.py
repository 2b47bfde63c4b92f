"""Banded linear systems, against numpy's dense ones."""

import numpy as np
import pytest

from undula.models.rod.tables import PlanarRod, SpatialRod
from undula.numerics.linalg.banded import (
    Structure,
    clear_kernel,
    factor_kernel,
    fill_in,
    full,
    solve_kernel,
    to_dense,
)

HALF_BANDWIDTHS = range(1, 12)
STRUCTURES = {
    "in space": SpatialRod.structure,
    "confined": PlanarRod.structure,
    "in a plane": SpatialRod.planar_structure,
}

every_structure = pytest.mark.parametrize("name", STRUCTURES)


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


def structured_band(structure: Structure, blocks: int, rng: np.random.Generator) -> np.ndarray:
    """Return a band with random entries where it may have some, dominated by its diagonal."""
    length, half = structure.block, structure.half_bandwidth
    band = np.zeros((blocks * length, 2 * half + 1))
    for block in range(blocks):
        for row, shift, column in structure.entries:
            if 0 <= block + shift < blocks:
                band[block * length + row, length * shift + column - row + half] = rng.normal()
    band[:, half] = 1.0 + np.abs(band).sum(axis=1)
    return band


def solution(band: np.ndarray, right: np.ndarray, structure: Structure | None = None) -> np.ndarray:
    structure = structure or full(band.shape[1] // 2)
    factors, x = band.copy(), right.copy()
    assert factor_kernel(structure)(factors)
    solve_kernel(structure)(factors, x)
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


@every_structure
def test_a_structured_system_of_any_size_is_solved_like_numpy_does(name: str) -> None:
    rng, structure = np.random.default_rng(5), STRUCTURES[name]
    for blocks in (1, 2, 3, 4, 5, 20):
        band = structured_band(structure, blocks, rng)
        right = rng.normal(size=band.shape[0])
        stored = np.arange(right.size).reshape(blocks, -1)[::-1].ravel()  # the tip comes first
        expected = np.linalg.solve(to_dense(band), right[stored])[stored]
        # As above: dominant rows keep round-off near 1e-15.
        found = solution(band, right, structure)
        np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-14)


def test_what_the_structure_leaves_zero_is_neither_read_nor_written() -> None:
    structure, half = SpatialRod.structure, SpatialRod.half_bandwidth
    band = structured_band(structure, 12, np.random.default_rng(6))
    left_out = np.ones((4, 2 * half + 1), dtype=bool)
    for row, (lower, upper) in enumerate(fill_in(structure)):
        for shift, column in [*lower, (0, row), *upper]:
            left_out[row, 4 * shift + column - row + half] = False
    assert left_out.sum() == 4 * 17 - 4 - 54  # 54 of the 64 entries beside the diagonal fill
    marked = band.copy()
    marked.reshape(12, 4, -1)[:, left_out] = np.nan
    right = np.ones(48)
    np.testing.assert_array_equal(
        solution(marked, right, structure), solution(band, right, structure)
    )


@every_structure
def test_what_is_going_to_fill_in_is_blanked_and_nothing_else(name: str) -> None:
    structure, given = STRUCTURES[name], np.random.default_rng(7)
    block, half = structure.block, structure.half_bandwidth
    band = given.normal(size=(3 * block, 2 * half + 1))
    expected = band.copy()
    for row, (lower, upper) in enumerate(fill_in(structure)):
        for shift, column in {*lower, *upper}:
            if (row, shift, column) not in structure.entries:
                expected[block + row, block * shift + column - row + half] = 0.0
    assert (expected == 0.0).any()
    clear_kernel(structure)(band, block)
    np.testing.assert_array_equal(band, expected)


def test_apart_in_and_across_a_plane_there_is_a_third_of_the_work() -> None:
    # Multiplications with subtraction in the elimination of a node.
    work = {
        name: sum(len(rows[c][1]) for lower, _ in rows for _, c in lower)
        for name, rows in ((name, fill_in(structure)) for name, structure in STRUCTURES.items())
    }
    assert work["in a plane"] == work["confined"] + 4
    assert work["in space"] / work["in a plane"] > 2.5


def test_a_structure_that_fills_in_outside_its_band_is_refused() -> None:
    # Eliminating (0, 0) joins (0, 1), which has an entry in its column, to the block before.
    corner = {(0, 0, 0), (1, 0, 1), (1, 0, 0), (0, 1, 1)}
    with pytest.raises(ValueError, match="filled outside the band"):
        factor_kernel(Structure(1, 2, frozenset(corner)))


@pytest.mark.parametrize("half", [1, 4, 11])
@pytest.mark.parametrize("row", [0, 2, 19])
def test_a_pivot_that_vanishes_is_reported(half: int, row: int) -> None:
    band = np.zeros((20, 2 * half + 1))
    band[:, half] = 1.0
    band[row, half] = 0.0
    assert not factor_kernel(full(half))(band)


@pytest.mark.parametrize("half", [1, 4, 11])
@pytest.mark.parametrize("row", [0, 19])
def test_a_pivot_that_is_no_number_is_reported(half: int, row: int) -> None:
    band = np.zeros((20, 2 * half + 1))
    band[:, half] = 1.0
    band[row, half] = np.nan
    assert not factor_kernel(full(half))(band)


def test_a_pivot_that_vanishes_by_elimination_is_reported() -> None:
    ones = np.array([[0.0, 1.0, 1.0], [1.0, 1.0, 0.0]])
    assert np.linalg.matrix_rank(to_dense(ones)) == 1
    assert not factor_kernel(full(1))(ones)


def test_the_dense_matrix_holds_every_entry_of_the_band_at_its_place() -> None:
    band = np.array([[0.0, 1.0, 2.0], [3.0, 4.0, 5.0], [6.0, 7.0, 0.0]])
    expected = [[1.0, 2.0, 0.0], [3.0, 4.0, 5.0], [0.0, 6.0, 7.0]]
    np.testing.assert_array_equal(to_dense(band), expected)
