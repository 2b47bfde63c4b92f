"""Hann weights, and the highest line of the weighted spectrum of a sampled signal."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from undula.arrays import Array, ComplexArray, Instants

# Zero padding of the spectrum, which gives its peak to 1/8 of the window's resolution.
PADDING_FACTOR = 4


@lru_cache(maxsize=64)
def hann(count: int, power: int = 1) -> Array:
    """Return Hann weights at the middles of equal cells of a window.

    Parameters
    ----------
    count : int
        Number of cells, at least 1.
    power : int
        Power of the Hann window sin^2, at least 1.

    Returns
    -------
    ndarray of shape (count,)
        Read-only, with sum 1.
    """
    weights = np.sin(np.pi * (np.arange(count) + 0.5) / count) ** (2 * power)
    weights = np.asarray(weights / np.sum(weights), dtype=np.float64)
    weights.setflags(write=False)
    return weights


def spectral_peak(time: Instants, signals: ComplexArray) -> float:
    """Return the frequency of the highest line of the power spectrum, summed over channels.

    Parameters
    ----------
    time : ndarray of shape (m,)
        Equally spaced times [T], m at least 2.
    signals : ndarray of shape (m, channels)
        Samples of complex signals, whose means are removed.

    Returns
    -------
    float
        Signed frequency [cycles/T], between minus and plus half the sampling rate.
    """
    weights = hann(len(time))[:, None]
    centred = weights * (signals - np.sum(weights * signals, axis=0))
    count = PADDING_FACTOR * len(time)
    power = np.sum(np.abs(np.fft.fft(centred, count, axis=0)) ** 2, axis=1)
    step = (time[-1] - time[0]) / (len(time) - 1)
    return float(np.fft.fftfreq(count, step)[int(np.argmax(power))])
