"""Compiled sums of harmonics against exponentials, one by one."""

import numpy as np
import pytest

from undula.analysis.harmonic_sums import harmonic_sums


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
