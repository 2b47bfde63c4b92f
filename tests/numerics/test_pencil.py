"""Pencils with eigenvalues known for every parameter, mixed so that nobody can see them.

Blocks stand on the diagonal of sigma - A(p), and random well-conditioned matrices from the left and
the right mix them: K(p) = -P A(p) Q, M = P Q. Eigenvalues are those of the blocks.
"""

from dataclasses import dataclass

import numpy as np
import pytest
import scipy.linalg as sl
from hypothesis import given
from hypothesis import strategies as st

from undula.arrays import Array
from undula.numerics.linalg.bialternate import coalescences, crossings
from undula.numerics.linalg.critical_points import refine_coalescence, refine_crossing
from undula.numerics.linalg.pencil import LinearPencil, eigenpairs, eigenvalues, reduced

#: Constant and linear part of a block A(p).
Block = tuple[Array, Array]


def swinging(p: float, omega: float, slope: float = 1.0) -> Block:
    """Return the block with the eigenvalues slope (x - p) +- i omega at the parameter x."""
    return np.array([[-slope * p, -omega], [omega, -slope * p]]), slope * np.eye(2)


def meeting(p: float, sigma: float) -> Block:
    """Return the block with the eigenvalues sigma +- sqrt(p - x)."""
    return np.array([[sigma, 1.0], [p, sigma]]), np.array([[0.0, 0.0], [-1.0, 0.0]])


def real(value: float, slope: float = 0.0) -> Block:
    """Return the block with the eigenvalue value + slope x."""
    return np.array([[value]]), np.array([[slope]])


def mixed(*blocks: Block, seed: int = 0) -> LinearPencil:
    """Return the pencil with the eigenvalues of the blocks."""
    base, change = (sl.block_diag(*(block[k] for block in blocks)) for k in (0, 1))
    random, size = np.random.default_rng(seed), base.shape[0]
    left, right = (
        np.linalg.qr(random.normal(size=(size, size)))[0] * random.uniform(0.5, 2.0, size)
        for _ in range(2)
    )
    return LinearPencil(-left @ base @ right, -left @ change @ right, left @ right)


@dataclass(frozen=True)
class Bent:
    """A pencil that depends on the parameter as another one does on its square."""

    inner: LinearPencil

    @property
    def mass(self) -> Array:
        return self.inner.mass

    def stiffness(self, p: float) -> Array:
        return self.inner.stiffness(p * p)

    def slope(self, p: float) -> Array:
        return 2.0 * p * self.inner.change


# Three crossings, the second of a pair that calms down, and reals that stay far behind.
SWINGING = mixed(
    swinging(1.0, 2.0), swinging(2.0, 7.0, -1.0), swinging(3.0, 5.0, 0.5), real(-20.0), real(-30.0)
)
# The two of a block meet at 2 and at 5; blocks are too far apart to meet one another before.
MEETING = mixed(meeting(2.0, -3.0), meeting(5.0, -40.0), real(-100.0))


def test_eigenvalues_come_by_falling_real_part_with_the_upper_of_a_pair_first() -> None:
    values = eigenvalues(SWINGING.stiffness(0.5), SWINGING.mass)
    expected = [1.5 + 7j, 1.5 - 7j, -0.5 + 2j, -0.5 - 2j, -1.25 + 5j, -1.25 - 5j, -20.0, -30.0]
    # Round-off of a matrix of size 8 with a condition of some tens.
    np.testing.assert_allclose(values, expected, rtol=1e-12)


def test_eigenvectors_solve_the_pencil() -> None:
    stiffness, mass = SWINGING.stiffness(0.5), SWINGING.mass
    values, vectors = eigenpairs(stiffness, mass)
    np.testing.assert_array_equal(values, eigenvalues(stiffness, mass))
    # Round-off relative to the largest eigenvalue, 30, and vectors of norm 1.
    np.testing.assert_allclose(stiffness @ vectors, -mass @ vectors * values, rtol=0.0, atol=1e-12)


def test_a_singular_mass_leaves_only_the_finite_eigenvalues() -> None:
    left, right = (np.random.default_rng(k).normal(size=(5, 5)) for k in (3, 4))
    stiffness = left @ np.diag([1.0, 2.0, 3.0, 4.0, 5.0]) @ right
    mass = left @ np.diag([1.0, 1.0, 0.5, 0.0, 0.0]) @ right
    # Round-off times the condition of the random matrices, some hundreds.
    np.testing.assert_allclose(eigenvalues(stiffness, mass), [-1.0, -2.0, -6.0], rtol=1e-11)
    values, vectors = eigenpairs(stiffness, mass)
    assert values.shape == (3,)
    assert vectors.shape == (5, 3)


def test_slow_eigenvalues_are_resolved_beside_ones_twelve_orders_faster() -> None:
    rates = np.array([1.0, 3.0, 1e4, 1e8, 1e12])
    turn = np.linalg.qr(np.random.default_rng(5).normal(size=(5, 5)))[0]
    # K is the identity and M compact, as for a filament.
    found = eigenvalues(np.eye(5), turn @ np.diag(1.0 / rates) @ turn.T)
    np.testing.assert_allclose(found[:2], [-1.0, -3.0], rtol=1e-14)


def test_the_reduced_pencil_keeps_the_slowest_eigenvalues_without_the_parameter() -> None:
    pencil = mixed(*(real(-float(k), 0.1 * k) for k in range(1, 9)))
    small = reduced(pencil, 3)
    assert small.mass.shape == (3, 3)
    # Modes do not mix in this family: the slowest keep their eigenvalues at any parameter.
    for p in (0.0, 2.0):
        found = eigenvalues(small.stiffness(p), small.mass)
        np.testing.assert_allclose(found, [-1 + 0.1 * p, -2 + 0.2 * p, -3 + 0.3 * p], rtol=1e-11)


def test_the_reduced_pencil_of_a_bent_one_is_its_tangent() -> None:
    inner = mixed(real(-1.0, 0.5), real(-2.0, 0.7))
    small = reduced(Bent(inner), 2)
    found = eigenvalues(small.stiffness(3.0), small.mass)
    # p^2 has no slope at 0: nothing changes.
    np.testing.assert_allclose(found, [-1.0, -2.0], rtol=1e-12)


def test_all_crossings_are_found_and_no_others() -> None:
    # The bialternate matrix of size 28 has the square of the condition of the pencil.
    np.testing.assert_allclose(
        crossings(SWINGING), [(1.0, 2.0), (2.0, 7.0), (3.0, 5.0)], rtol=1e-10
    )


def test_two_real_eigenvalues_of_opposite_sign_are_no_crossing() -> None:
    saddle = mixed(real(-2.0, 1.5), real(-4.0), real(-9.0), swinging(-1.0, 3.0, -1.0))
    at_rest = eigenvalues(saddle.stiffness(4.0), saddle.mass).real
    # It is there, at 4, and so are -1 and +1 nowhere else.
    assert at_rest.max() == pytest.approx(4.0, rel=1e-12)
    assert crossings(saddle) == []


def test_a_crossing_at_a_negative_parameter_is_not_reported() -> None:
    assert crossings(mixed(swinging(-1.0, 2.0), real(-5.0))) == []


@given(
    first=st.floats(0.5, 20.0),
    apart=st.floats(0.1, 50.0),
    omegas=st.tuples(st.floats(0.5, 200.0), st.floats(0.5, 200.0)),
    slopes=st.tuples(st.floats(0.1, 10.0), st.floats(0.1, 10.0)),
    seed=st.integers(0, 1000),
)
def test_two_crossings_are_found_wherever_they_are(
    first: float,
    apart: float,
    omegas: tuple[float, float],
    slopes: tuple[float, float],
    seed: int,
) -> None:
    places = (first, first + apart)
    blocks = [swinging(*each) for each in zip(places, omegas, slopes, strict=True)]
    found = crossings(mixed(*blocks, real(-300.0), seed=seed))
    # The wedge product's condition: the square of some hundreds.
    np.testing.assert_allclose(found, list(zip(places, omegas, strict=True)), rtol=1e-7)


def test_all_meetings_of_real_eigenvalues_are_found_and_no_others() -> None:
    # A meeting's sigma has the square root of the round-off of its parameter.
    np.testing.assert_allclose(coalescences(MEETING), [(2.0, -3.0), (5.0, -40.0)], rtol=1e-6)


def test_complex_pairs_are_no_meeting() -> None:
    assert coalescences(mixed(swinging(1.0, 2.0), real(-60.0))) == []


GUESSES = [(1.05, 1.0), (0.95, 1.05), (1.0, 0.95), (1.05, 1.05), (0.95, 0.95)]


@pytest.mark.parametrize(("by", "by_omega"), GUESSES)
@pytest.mark.parametrize(
    ("p", "omega", "slope"), [(1.0, 2.0, 1.0), (2.0, 7.0, -1.0), (3.0, 5.0, 0.5)]
)
def test_a_crossing_is_refined_to_round_off_from_five_per_cent_off(
    p: float, omega: float, slope: float, by: float, by_omega: float
) -> None:
    pair = refine_crossing(SWINGING, by * p, by_omega * omega)
    assert pair is not None
    # Some tens of rounding errors.
    assert pair.p == pytest.approx(p, rel=1e-14)
    assert pair.omega == pytest.approx(omega, rel=1e-14)
    assert pair.slope == pytest.approx(slope, rel=1e-12)
    residual = (SWINGING.stiffness(p) + 1j * omega * SWINGING.mass) @ pair.vector
    # The vector is that before the last step, which was of 1e-9 at most; the matrix is of size 30.
    assert np.abs(residual).max() < 3e-8 * np.linalg.norm(pair.vector)


@pytest.mark.parametrize("by", [0.95, 1.05])
@pytest.mark.parametrize(("p", "sigma"), [(2.0, -3.0), (5.0, -40.0)])
def test_a_meeting_is_refined_to_round_off_from_five_per_cent_off(
    p: float, sigma: float, by: float
) -> None:
    # The two are sqrt(p) from their middle: five per cent of that, not of sigma.
    found = refine_coalescence(MEETING, by * p, sigma + 0.05 * np.sqrt(p))
    assert found is not None
    assert found.p == pytest.approx(p, rel=1e-13)
    assert found.sigma == pytest.approx(sigma, rel=1e-13)


def test_a_parameter_that_enters_nonlinearly_is_no_hindrance() -> None:
    pair = refine_crossing(Bent(SWINGING), 1.7, 4.8)
    assert pair is not None
    assert pair.p == pytest.approx(np.sqrt(3.0), rel=1e-14)
    assert pair.slope == pytest.approx(0.5 * 2.0 * np.sqrt(3.0), rel=1e-12)
    met = refine_coalescence(Bent(MEETING), 1.43, -3.0)
    assert met is not None
    assert met.p == pytest.approx(np.sqrt(2.0), rel=1e-13)


def test_where_nothing_crosses_nothing_is_refined() -> None:
    real_ones = mixed(real(-1.0, 0.1), real(-2.0), real(-5.0, 0.2))
    constant = mixed(swinging(1.0, 2.0, 0.0), real(-3.0))
    for guess in [(1.0, 1.0), (10.0, 0.1), (0.1, 30.0)]:
        assert refine_crossing(real_ones, *guess) is None
        assert refine_crossing(constant, *guess) is None
    assert refine_crossing(mixed(swinging(-1.0, 2.0), real(-3.0)), 0.1, 2.0) is None


def test_where_nothing_meets_nothing_is_refined() -> None:
    apart = mixed(real(-1.0, -0.1), real(-20.0, -2.0), real(-50.0, -5.0))
    for guess in [(1.0, -2.0), (10.0, -10.0), (0.1, -30.0)]:
        assert refine_coalescence(apart, *guess) is None
    assert refine_coalescence(mixed(meeting(-1.0, -3.0), real(-9.0)), 0.1, -3.0) is None


# Mixing with factors from 1e-3 to 1e3 costs digits, which the bound has to tell of. It is for
# entries that are rounded once; those here are made by two products of six terms each.
ROUNDINGS = 12


@given(seed=st.integers(0, 10_000), spread=st.floats(0.0, 3.0))
def test_the_bound_on_round_off_covers_the_error(seed: int, spread: float) -> None:
    random = np.random.default_rng(seed)
    scale = 10.0 ** random.uniform(-spread, spread, (2, 6))

    def scaled(pencil: LinearPencil) -> LinearPencil:
        parts = (pencil.base, pencil.change, pencil.mass)
        turn = np.linalg.qr(random.normal(size=(6, 6)))[0]
        return LinearPencil(*(turn @ (scale[0, :, None] * part * scale[1]) for part in parts))

    swings = mixed(swinging(1.3, 2.7, 0.7), swinging(4.0, 9.0), real(-3.0), real(-7.0), seed=seed)
    pair = refine_crossing(scaled(swings), 1.3, 2.7)
    assert pair is not None
    assert abs(pair.p - 1.3) <= ROUNDINGS * pair.round_off
    meets = mixed(meeting(1.3, -2.7), meeting(9.0, -40.0), real(-80.0), real(-90.0), seed=seed)
    met = refine_coalescence(scaled(meets), 1.3, -2.7)
    assert met is not None
    assert abs(met.p - 1.3) <= ROUNDINGS * met.round_off
    # Nor is it so wide that it says nothing: six digits are lost at most.
    assert max(pair.round_off, met.round_off) < 1e-8
