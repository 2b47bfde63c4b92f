"""The first look at a sampled signal's frequency: a weighted spectrum and its highest line."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from undula.arrays import Array, ComplexArray, Instants

# Zero padding of the spectrum: its peak is then within 1/8 of the window's resolution.
PADDING = 4


@lru_cache(maxsize=64)
def hann(count: int, power: int = 1) -> Array:
    """Hann weight raised to a power at the middles of ``count`` equal cells, with sum 1.

    A run asks for the same few again and again; they are remembered and cannot be written to.
    """
    weights = np.sin(np.pi * (np.arange(count) + 0.5) / count) ** (2 * power)
    weights = np.asarray(weights / np.sum(weights), dtype=np.float64)
    weights.setflags(write=False)
    return weights


def spectral_peak(time: Instants, signals: ComplexArray) -> float:
    """Frequency of the highest line of the summed power spectra, with its sign.

    Parameters
    ----------
    time
        Equally spaced times, shape ``(m,)``, m at least 2.
    signals
        Shape ``(m, channels)``.

    Returns
    -------
    float
        Cycles per unit of time, between minus and plus half the sampling rate.
    """
    weights = hann(len(time))[:, None]
    centred = weights * (signals - np.sum(weights * signals, axis=0))
    count = PADDING * len(time)
    power = np.sum(np.abs(np.fft.fft(centred, count, axis=0)) ** 2, axis=1)
    step = (time[-1] - time[0]) / (len(time) - 1)
    return float(np.fft.fftfreq(count, step)[int(np.argmax(power))])
