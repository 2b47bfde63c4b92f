"""Piecewise polynomials against numpy's, and the exactness of their quadrature."""

from itertools import pairwise

import numpy as np
import pytest
from numpy.polynomial import Polynomial
from numpy.polynomial.legendre import Legendre

from undula.arrays import Array, Points
from undula.numerics.linalg.legendre import gauss, legendre_elements

#: One element, two alike, three that differ by a factor of twenty, and a short one at the clamp.
DIVISIONS = [(0.0, 1.0), (0.0, 0.5, 1.0), (0.0, 0.03, 0.37, 1.0), (0.0, 1e-3, 1.0)]
DEGREE = 9

every_division = pytest.mark.parametrize("edges", DIVISIONS, ids=repr)


def between(edges: tuple[float, ...]) -> Points:
    """Return points on all elements, the ends of the filament among them."""
    inside = [np.linspace(*pair, 9)[1:-1] for pair in pairwise(edges)]
    return np.concatenate([[0.0], *inside, [1.0]])


def by_numpy(edges: tuple[float, ...], s: Points) -> Array:
    """Return the double integrals from 0 of the orthonormal polynomials, one after the other."""
    columns = []
    for left, right in pairwise(edges):
        for k in range(DEGREE + 1):
            p = Legendre.basis(k, domain=[left, right]) * np.sqrt((2 * k + 1) / (right - left))
            once, twice = p.integ(1, lbnd=left), p.integ(2, lbnd=left)
            beyond = twice(right) + (s - right) * once(right)
            columns.append(np.where(s < left, 0.0, np.where(s <= right, twice(s), beyond)))
    return np.stack(columns, axis=1)


@every_division
def test_double_integrals_are_those_of_numpy(edges: tuple[float, ...]) -> None:
    s = between(edges)
    _, integrals = legendre_elements(np.array(edges), DEGREE, s)
    # No entry exceeds 1; numpy sums terms of the size of degree^2.
    np.testing.assert_allclose(integrals, by_numpy(edges, s), rtol=0.0, atol=1e-14)


@every_division
def test_the_polynomials_are_orthonormal_over_all_elements(edges: tuple[float, ...]) -> None:
    s, weight = gauss(np.array(edges), DEGREE + 1)
    functions, _ = legendre_elements(np.array(edges), DEGREE, s)
    size = (len(edges) - 1) * (DEGREE + 1)
    gram = functions.T @ (weight[:, None] * functions)
    # Round-off of sums of ten terms of the size of the degree.
    np.testing.assert_allclose(gram, np.eye(size), rtol=0.0, atol=1e-13)


@every_division
def test_double_integrals_meet_the_clamp(edges: tuple[float, ...]) -> None:
    # Bounded functions: their double integrals are at most 1/2 s^2 times the largest of them.
    largest = np.sqrt((2 * DEGREE + 1) / np.diff(edges).min())
    for s in (0.0, 1e-6):
        _, integrals = legendre_elements(np.array(edges), DEGREE, np.array([s]))
        assert np.abs(integrals).max() <= 0.5 * s**2 * largest


@every_division
def test_the_gauss_rule_is_exact_up_to_its_degree_and_not_beyond(edges: tuple[float, ...]) -> None:
    count = 4
    s, weight = gauss(np.array(edges), count)
    assert s.shape == weight.shape == (count * (len(edges) - 1),)
    for degree in range(2 * count):
        # Round-off of a sum of a dozen positive terms.
        assert weight @ s**degree == pytest.approx(1.0 / (degree + 1), rel=1e-14)
    # On an element of width h, s^8 is off by h^9 (4!)^4 / (9 (8!)^2), the rule's error term.
    missing = 1.0 / 9.0 - weight @ s**8
    widths = np.diff(edges)
    expected = 24.0**4 / (9.0 * 40320.0**2) * np.sum(widths**9)
    # Round-off of 1/9.
    assert missing == pytest.approx(expected, abs=1e-15)


def test_a_function_that_jumps_between_elements_is_integrated_twice_exactly() -> None:
    edges, place = np.array([0.0, 0.3, 1.0]), 0.3
    s, weight = gauss(edges, 6)
    functions, integrals = legendre_elements(edges, 3, s)
    before, after = Polynomial([1.0, -2.0]), Polynomial([0.0, 0.0, 5.0])
    jumping = np.where(s < place, before(s), after(s))
    coefficients = functions.T @ (weight * jumping)
    slope, value = before.integ()(place), before.integ(2)(place)
    beyond = value + slope * (s - place) + after.integ(2, lbnd=place)(s)
    expected = np.where(s < place, before.integ(2)(s), beyond)
    # Round-off of some tens of operations on numbers up to 1.
    np.testing.assert_allclose(integrals @ coefficients, expected, rtol=0.0, atol=1e-14)
