"""Compiled sums of harmonics against exponentials, one by one."""

import numpy as np
import pytest

from undula.analysis.observables.harmonic_sums import harmonic_sums, judge_fit, refine
from undula.arrays import Array, ComplexArray


@pytest.mark.parametrize("channels", [1, 2])
def test_sums_are_those_of_exponentials(channels: int) -> None:
    random, top = np.random.default_rng(1), 4
    clock, weights = np.linspace(-0.5, 0.5, 90), random.uniform(size=90)
    signals = random.normal(size=(90, channels)) + 1j * random.normal(size=(90, channels))
    even = np.empty((3, 2 * top + 1), dtype=complex)
    mixed = np.empty((2, channels, 2 * top + 1), dtype=complex)
    harmonic_sums(clock, signals, weights, 3.7, even, mixed)
    for power in range(3):
        for k in range(2 * top + 1):
            expected = np.sum(weights * clock**power * np.exp(2j * np.pi * k * 3.7 * clock))
            assert even[power, k] == pytest.approx(expected, abs=1e-12)
    for power in range(2):
        for k in range(-top, top + 1):
            wave = weights * clock**power * np.exp(-2j * np.pi * k * 3.7 * clock)
            # Ninety terms of order one.
            np.testing.assert_allclose(mixed[power, :, top + k], wave @ signals, atol=1e-12)


def beat(channels: int = 2) -> tuple[Array, ComplexArray, Array]:
    """Times, signals of three harmonics of 3.7 with noise, and weights."""
    random = np.random.default_rng(4)
    clock, weights = np.linspace(-0.5, 0.5, 90), random.uniform(0.5, 1.0, 90) / 90.0
    waves = np.exp(2j * np.pi * 3.7 * np.outer(clock, np.arange(-3, 4)))
    signals = waves @ (random.normal(size=(7, channels)) + 1j * random.normal(size=(7, channels)))
    return clock, signals + 0.1 * random.normal(size=signals.shape), weights


def fitted(
    clock: Array, signals: ComplexArray, weights: Array, frequency: float, harmonics: int = 3
) -> tuple[ComplexArray, ComplexArray]:
    """Coefficients (2 K + 1, channels) by least squares, and what they leave."""
    waves = np.exp(2j * np.pi * frequency * np.outer(clock, np.arange(-harmonics, harmonics + 1)))
    root = np.sqrt(weights)[:, None]
    coefficients = np.linalg.lstsq(root * waves, root * signals, rcond=None)[0]
    return coefficients, signals - waves @ coefficients


def test_a_refined_frequency_leaves_the_least() -> None:
    clock, signals, weights = beat()
    found, stayed = refine(clock, signals, weights, 3.65, 3, 20, 1e-12, 1.0)
    assert stayed

    def left(frequency: float) -> float:
        rest = fitted(clock, signals, weights, frequency)[1]
        return float(np.sum(weights[:, None] * np.abs(rest) ** 2))

    # A minimum: to first order it does not change, and to second it grows.
    assert left(found) < min(left(found - 1e-3), left(found + 1e-3))
    slope = (left(found + 1e-5) - left(found - 1e-5)) / 2e-5
    bend = (left(found + 1e-3) + left(found - 1e-3) - 2.0 * left(found)) / 1e-6
    # Differences of numbers of order 0.1 are known to 1e-12.
    assert abs(slope) < 1e-6 * bend


def test_a_frequency_that_leaves_its_peak_is_given_up() -> None:
    clock, signals, weights = beat()
    assert not refine(clock, signals, weights, 3.0, 3, 20, 1e-12, 1e-3)[1]


@pytest.mark.slow
def test_a_fit_is_judged_as_by_least_squares() -> None:
    clock, signals, weights = beat()
    weights = weights / weights.sum()
    found = np.empty((2, 7), dtype=complex)
    size, rest, steepness, pull = judge_fit(clock, signals, weights, 3.7, 3, found)
    coefficients, left = fitted(clock, signals, weights, 3.7)
    np.testing.assert_allclose(found.T, coefficients, atol=1e-12)
    column = weights[:, None]
    assert rest == pytest.approx(np.sum(column * np.abs(left) ** 2), rel=1e-10)
    centred = signals - np.sum(column * signals, axis=0) / weights.sum()
    assert size == pytest.approx(np.sum(column * np.abs(centred) ** 2), rel=1e-10)
    orders = np.arange(-3, 4)
    waves = np.exp(2j * np.pi * 3.7 * np.outer(clock, orders))
    moved = 2j * np.pi * clock[:, None] * (waves @ (orders[:, None] * coefficients))
    unseen = fitted(clock, moved, weights, 3.7)[1]
    assert steepness == pytest.approx(np.sum(column * np.abs(unseen) ** 2), rel=1e-10)
    phase = 2.0 * np.pi * clock / (clock[-1] - clock[0])
    swings = [np.ones(90)] + [
        np.sqrt(2.0) * wave(n * phase) for n in (1, 2) for wave in (np.cos, np.sin)
    ]
    pulls = [
        np.sum(
            2.0
            * np.pi
            * orders[:, None]
            * coefficients.conj()
            * (waves.conj().T @ (column * (clock * swing)[:, None] * left)),
            axis=1,
        )
        for swing in swings
    ]
    assert pull == pytest.approx(max(np.sum(np.abs(each.imag)) for each in pulls), rel=1e-10)
