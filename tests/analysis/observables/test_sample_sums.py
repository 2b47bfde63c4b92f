"""Compiled sums over the samples of one quantity against numpy, written as the formulas are."""

import numpy as np
import pytest

from undula.analysis.observables.sample_sums import (
    largest_ahead,
    largest_imbalance,
    line_slope,
    mean_and_deviation,
)
from undula.analysis.observables.shapes import envelope
from undula.arrays import Array


def noise(count: int, seed: int = 1) -> Array:
    return np.random.default_rng(seed).normal(size=count)


@pytest.mark.parametrize("count", [7, 60])
@pytest.mark.parametrize("tapered", [False, True])
def test_the_slope_is_that_of_the_line_of_least_squares(count: int, tapered: bool) -> None:
    time = np.linspace(3.0, 5.0, count)
    values = 7.0 - 4.0 * time + noise(count)
    weights = np.sin(np.pi * (np.arange(count) + 0.5) / count) ** 2 if tapered else np.ones(count)
    expected = np.polyfit(time, values, 1, w=np.sqrt(weights))[0]
    # Some digits go with the Vandermonde matrix of the fit.
    assert line_slope(time, values, tapered) == pytest.approx(expected, rel=1e-11)


def test_a_straight_line_has_its_slope_whatever_the_weight() -> None:
    time = 100.0 + np.linspace(0.0, 1.0, 50)
    for tapered in (False, True):
        # Round-off of times of a hundred.
        assert line_slope(time, 2.5 * time, tapered) == pytest.approx(2.5, rel=1e-12)


def test_mean_and_deviation_are_those_of_the_samples() -> None:
    values = 4.0 + noise(90)
    # Ninety terms of order one, in another order.
    assert mean_and_deviation(values) == pytest.approx((values.mean(), values.std()), rel=1e-13)


def test_extremes_between_samples_are_those_of_parabolas() -> None:
    values = noise(50, 3)
    before, here, after = values[:-2], values[1:-1], values[2:]
    vertex = here + (after - before) ** 2 / (8.0 * (2.0 * here - before - after))
    tops = vertex[(here >= before) & (here >= after)]
    bottoms = vertex[(here <= before) & (here <= after)]
    found = envelope(values)
    assert found.max == pytest.approx(max(tops.max(), values.max()), rel=1e-14)
    assert found.min == pytest.approx(min(bottoms.min(), values.min()), rel=1e-14)
    assert found.mean == pytest.approx(values.mean(), rel=1e-13)
    level = envelope(np.full(5, 0.25))
    assert (level.min, level.max, level.mean) == (0.25, 0.25, 0.25)


def test_the_largest_imbalance_is_what_stores_gain_beyond_what_comes_in() -> None:
    first, second, gain, loss = (noise(40, seed) for seed in range(4))
    stored = first + second
    expected = np.abs(stored - stored[0] - gain + loss).max()
    assert largest_imbalance(first, second, gain, loss) == pytest.approx(expected, rel=1e-14)
    assert largest_imbalance(first, second, stored - stored[0] + loss, loss) < 1e-14


@pytest.mark.parametrize("decay", [0.0, 0.1])
def test_what_is_still_ahead_is_the_largest_of_the_rest(decay: float) -> None:
    values = np.abs(noise(60)) * np.exp(-decay * np.arange(60.0))
    ahead = np.empty(60)
    peak, count = largest_ahead(values, 0.3, ahead)
    np.testing.assert_array_equal(ahead, [values[k:].max() for k in range(60)])
    assert (peak, count) == (values.argmax(), np.count_nonzero(ahead > 0.3 * values.max()))


def test_of_equal_peaks_the_last_one_counts() -> None:
    assert largest_ahead(np.array([1.0, 3.0, 2.0, 3.0, 0.5]), 0.5, np.empty(5)) == (3, 4)
