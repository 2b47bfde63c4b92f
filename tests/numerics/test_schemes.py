"""Coefficients of the stiff steppers, derived anew, and the orders they reach."""

from fractions import Fraction
from math import comb, factorial

import numpy as np
import pytest

from systems import (
    BEAD,
    FOLLOWER,
    SPINNER,
    Known,
    always_accepting,
    begin,
    choices,
    exact,
    follow,
    pinned,
)
from undula.numerics.integration.schemes import SCHEMES, BackwardDifferentiation
from undula.numerics.integration.status import Status
from undula.numerics.integration.stepper_state import FAILED, STEPS

ORDERS = range(1, 6)

#: Shampine & Reichelt (1997), table 1.
PUBLISHED_KAPPA = {
    "BDF": [Fraction(0)] * 5,
    "NDF": [
        Fraction("-0.1850"),
        Fraction(-1, 9),
        Fraction("-0.0823"),
        Fraction("-0.0415"),
        Fraction(0),
    ],
}

#: A system, whether it is seen from the co-rotating frame, and the columns not exact anyway: times
#: are straight lines, and only the spinner turns.
CASES = {
    "follower": (Known(FOLLOWER, 10.0), False, [0, 3]),
    "stiff follower": (Known(FOLLOWER, 1e2), False, [0, 3]),
    "bead": (Known(BEAD, 10.0), False, [0, 1, 2, 5]),
    "stiff bead": (Known(BEAD, 1e2), False, [0, 1, 2, 5]),
    "spinner in the lab": (Known(SPINNER, 1e2, 1.0, 1.0, 1.0), False, [0, 1, 2, 3, 4]),
    "spinner in the frame": (Known(SPINNER, 1e2, 1.0, 1.0, 1.0), True, [0, 1, 2, 3, 4]),
}


def backward_difference(values: list[Fraction], j: int) -> Fraction:
    """Return D^j at the last of `values`."""
    return sum((-1) ** i * comb(j, i) * values[-1 - i] for i in range(j + 1))


def defect(order: int, kappa: Fraction, power: int) -> Fraction:
    """Return the left side less the right side of the formula for y = t^power at t = 0, h = 1.

    The left side is the derivative's expansion in differences at the new time, cut off at the
    order, less kappa gamma times the next one.
    """
    values = [Fraction(-i) ** power for i in range(order + 1, -1, -1)]
    gamma = sum(Fraction(1, j) for j in range(1, order + 1))
    left = sum(backward_difference(values, j) / j for j in range(1, order + 1))
    left -= kappa * gamma * backward_difference(values, order + 1)
    return left - (1 if power == 1 else 0)


def tabled_defect(scheme: BackwardDifferentiation, order: int, power: int) -> float:
    """Return the same from the table, whose differences are those at the old time."""
    gamma, alpha, _ = scheme.tables
    values = [Fraction(-i) ** power for i in range(order + 1, -1, -1)]
    old = values[:-1]
    ahead = values[-1] - sum(backward_difference(old, j) for j in range(order + 1))
    left = sum(gamma[j] * float(backward_difference(old, j)) for j in range(1, order + 1))
    return float(left + alpha[order] * float(ahead)) - (1.0 if power == 1 else 0.0)


@pytest.mark.parametrize("scheme", SCHEMES, ids=lambda scheme: scheme.name)
def test_the_free_coefficients_are_the_published_ones(scheme: BackwardDifferentiation) -> None:
    assert list(scheme.kappa) == [float(kappa) for kappa in PUBLISHED_KAPPA[scheme.name]]


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("scheme", SCHEMES, ids=lambda scheme: scheme.name)
def test_the_table_equals_the_formula_derived_in_fractions(
    scheme: BackwardDifferentiation, order: int
) -> None:
    kappa = PUBLISHED_KAPPA[scheme.name][order - 1]
    for power in range(1, order + 2):
        expected = float(defect(order, kappa, power))
        # Sums of numbers up to 6^6 leave round-off near 1e-11.
        assert tabled_defect(scheme, order, power) == pytest.approx(expected, abs=1e-10)
        assert (expected == 0.0) == (power <= order)


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("scheme", SCHEMES, ids=lambda scheme: scheme.name)
def test_the_error_constant_is_the_formula_s_defect_on_the_next_power(
    scheme: BackwardDifferentiation, order: int
) -> None:
    kappa = PUBLISHED_KAPPA[scheme.name][order - 1]
    expected = -defect(order, kappa, order + 1) / factorial(order + 1)
    assert scheme.tables[2][order] == pytest.approx(float(expected), rel=1e-14)


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("scheme", SCHEMES, ids=lambda scheme: scheme.name)
def test_the_stability_angle_follows_from_the_root_locus(
    scheme: BackwardDifferentiation, order: int
) -> None:
    gamma, alpha, _ = scheme.tables
    shift = np.exp(-1j * np.linspace(1e-3, np.pi, 20001))  # from y_{n+1} to y_n on the unit circle
    locus = alpha[order] * (1.0 - shift) ** (order + 1)
    locus += sum(gamma[j] * shift * (1.0 - shift) ** j for j in range(1, order + 1))
    left = locus[locus.real < -1e-9]
    angle = np.degrees(np.abs(np.pi - np.abs(np.angle(left)))).min() if left.size else 90.0
    # The published angles are rounded, or cut off, to full degrees.
    assert angle == pytest.approx(scheme.stability_angle[order - 1], abs=1.0)


def error_with_fixed_steps(
    case: str, scheme: BackwardDifferentiation, order: int, count: int, place: float
) -> np.ndarray:
    """Return the largest errors in [0, 2] at one place, from 0 to 1, in each of `count` steps.

    Newton's method runs to round-off with a fresh matrix, and the past is exact.
    """
    system, in_frame, columns = CASES[case]
    step, radius = 2.0 / count, 0.5
    told = choices(system, scheme=scheme, rtol=1e-13, stale_after=0.0)
    memory = begin(system, scheme, step=step, order=order, radius=radius, in_frame=in_frame)
    times = step * (np.arange(count) + place)
    status, rows = follow(system, pinned(memory), always_accepting(told), times)
    assert status is Status.DONE
    assert (memory.count[STEPS], memory.count[FAILED]) == (count, 0)
    return np.abs(rows - exact(system, times, radius)).max(axis=0)[columns]


def step_counts(case: str, order: int) -> list[int]:
    """Return numbers of steps whose errors are asymptotic and yet far above round-off."""
    return [32, 64, 128] if "follower" in case and order == 5 else [64, 128, 256]


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("scheme", SCHEMES, ids=lambda scheme: scheme.name)
@pytest.mark.parametrize("case", CASES)
def test_every_formula_reaches_its_order_in_unknowns_multipliers_and_integrals(
    case: str, scheme: BackwardDifferentiation, order: int
) -> None:
    counts = step_counts(case, order)
    errors = [error_with_fixed_steps(case, scheme, order, count, 1.0) for count in counts]
    slopes = -np.polyfit(np.log(counts), np.log(errors), 1)[0]
    np.testing.assert_allclose(slopes, order, atol=0.15)


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("scheme", SCHEMES, ids=lambda scheme: scheme.name)
@pytest.mark.parametrize("case", CASES)
def test_output_between_the_steps_is_of_the_order_of_the_steps(
    case: str, scheme: BackwardDifferentiation, order: int
) -> None:
    counts = step_counts(case, order)
    errors = [error_with_fixed_steps(case, scheme, order, count, 0.5) for count in counts]
    slopes = -np.polyfit(np.log(counts), np.log(errors), 1)[0]
    # The polynomial between the steps is of one order more. A stiff system damps the errors of the
    # steps, not those of the polynomial, and then this higher order is what is seen.
    assert (slopes > order - 0.15).all()
    assert (slopes < order + 1.15).all()
