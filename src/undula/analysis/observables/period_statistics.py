"""Quantities of a periodic motion, from equally spaced samples of one period."""

import numpy as np

from undula.analysis.observables.shapes import Range, envelope
from undula.arrays import Array

# Extremes are read from so many times more points than there are samples.
_FINER = 8


def over_period(values: Array) -> Range:
    """Return the range and the mean of a quantity over its period.

    Parameters
    ----------
    values : ndarray of shape (m,)
        Samples at equally spaced instants of one period, of which one end is left out.
    """
    fine = finely(values)
    extremes = envelope(np.concatenate([fine[-1:], fine, fine[:1]]))
    return Range(extremes.min, extremes.max, float(np.mean(values)))


def finely(values: Array) -> Array:
    """Return the trigonometric polynomial through samples (m,) of a period at 8 m instants."""
    return np.asarray(np.fft.irfft(np.fft.rfft(values), _FINER * values.size) * _FINER)
