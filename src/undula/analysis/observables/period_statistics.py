"""Quantities of a periodic motion, from equally spaced samples of one period."""

import numpy as np

from undula.analysis.observables.shapes import Range, envelope
from undula.arrays import Array

# Points of the interpolated period for each sample, from which extremes are taken.
_OVERSAMPLING = 8


def over_period(values: Array) -> Range:
    """Return the range and the mean of a quantity over its period.

    Parameters
    ----------
    values : ndarray of shape (m,)
        Samples at equally spaced instants of one period without its end.

    Returns
    -------
    Range
        Extremes of the trigonometric interpolant, and the mean, in the unit of the values.
    """
    fine = oversampled(values)
    extremes = envelope(np.concatenate([fine[-1:], fine, fine[:1]]))
    return Range(extremes.min, extremes.max, float(np.mean(values)))


def oversampled(values: Array) -> Array:
    """Interpolate the samples of a period by a trigonometric polynomial.

    Parameters
    ----------
    values : ndarray of shape (m,)
        Samples at equally spaced instants of one period without its end.

    Returns
    -------
    ndarray of shape (8 m,)
        Values at equally spaced instants of the same period.
    """
    return np.asarray(
        np.fft.irfft(np.fft.rfft(values), _OVERSAMPLING * values.size) * _OVERSAMPLING
    )
