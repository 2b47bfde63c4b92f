"""Fundamental frequency of a window of signals, with its error; None where it is not resolved."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from undula.analysis.observables.harmonics import (
    MAX_HARMONICS,
    HarmonicFit,
    fit_harmonics,
    harmonic_count,
    misfit_at,
    refined,
)
from undula.analysis.observables.spectrum import spectral_peak
from undula.arrays import ComplexArray, Instants

# Least number of periods in the window: with fewer, frequency and drift are indistinguishable.
MIN_PERIODS = 2.5
# Least number of samples a period: with fewer, strong harmonics are aliased onto the fundamental.
MIN_SAMPLES_PER_PERIOD = 5.0
# Least number of samples of a fit: MIN_PERIODS of MIN_SAMPLES_PER_PERIOD, rounded up.
MIN_SAMPLES = 13
# Length of the two overlapping parts of the window that are fitted again, as a share of it: they
# keep most of its resolution and still contain different data.
PART_SHARE = 2.0 / 3.0
# Largest remainder of the harmonics, as a share of the RMS of the motion, with which a frequency
# is reported (half of the variance is 0.71; white noise leaves nearly 1).
MAX_MISFIT = 0.7
# Largest error, as a share of the frequency: above it the parts of the window disagree.
MAX_RELATIVE_ERROR = 0.2
# Factor on the pull of the remainder, which is that of one typical draw: rarely exceeded.
FLOOR_FACTOR = 4.0
# Factor on the largest deviation over parts and weights, which is the largest of only four.
DEVIATION_FACTOR = 2.0
# Round-off of the fit [cycles over the window].
ROUND_OFF_CYCLES = 1e-11
# Relative difference of clockwise and anticlockwise parts up to which a motion is an oscillation:
# an ellipse of axes 50 to 1, which the first verdict also calls planar.
SENSE_TOLERANCE = 0.04
# Share of the former remainder that a longer period has to leave at most: more terms always leave
# a little less.
SUBHARMONIC_GAIN = 0.3
# Remainder of the harmonics of the strongest line above which a longer period is tried.
SUBHARMONIC_FLOOR = 1e-3


@dataclass(frozen=True)
class Frequency:
    """A frequency with an estimate of its error.

    Attributes
    ----------
    value
        Frequency [cycles/T]; the sign is the sense of rotation where the motion has one.
    error
        Bound that holds nearly always [cycles/T], at least the round-off of the fit.
    """

    value: float
    error: float


def find_frequency(
    time: Instants, signals: ComplexArray, *, longest_period: int = 1
) -> Frequency | None:
    """Return the frequency of the strongest spectral line, refined with its harmonics.

    The error is the sum of the deviation under other weights and on other parts of the window, the
    pull of the remainder of the harmonics, and round-off.

    Parameters
    ----------
    time
        Equally spaced times [T], shape ``(m,)``.
    signals
        Complex, shape ``(m, channels)``, with one frequency common to all.
    longest_period
        Largest ratio, at least 1, of the period to that of the strongest line, for signals with
        subharmonics.

    Returns
    -------
    Frequency or None
        Negative when the clockwise parts are stronger. None when no line stands out, or the window
        holds fewer than 2.5 periods or a period fewer than 5 samples.
    """
    if len(time) < MIN_SAMPLES:
        return None
    guess = abs(spectral_peak(time, signals))
    fit = _longest_needed(time, signals, guess, longest_period)
    return None if fit is None else _with_error(time, signals, fit)


def _fundamental(
    time: Instants, signals: ComplexArray, guess: float, subharmonic: int = 1
) -> HarmonicFit | None:
    """Fit over the whole window; None where the window or the sampling do not resolve it."""
    if not _resolves(time, guess, subharmonic):
        return None
    harmonics = harmonic_count(time, guess, subharmonic * MAX_HARMONICS)
    return fit_harmonics(time, signals, guess, harmonics=harmonics)


def _resolves(time: Instants, guess: float, subharmonic: int) -> bool:
    span = float(time[-1] - time[0])
    rate = (len(time) - 1) / span
    return guess * span >= MIN_PERIODS and subharmonic * guess * MIN_SAMPLES_PER_PERIOD <= rate


def _worth_fitting(
    time: Instants, signals: ComplexArray, line: HarmonicFit, factor: int, least: float
) -> bool:
    """Return True if a period longer by a factor, unrefined, leaves nearly a small enough rest."""
    guess = line.frequency / factor
    if not _resolves(time, guess, factor):
        return False
    harmonics = harmonic_count(time, guess, factor * MAX_HARMONICS)
    # The factor of two allows for the refinement, which gains little at the line's own frequency.
    return misfit_at(time, signals, guess, harmonics=harmonics) < 2.0 * SUBHARMONIC_GAIN * least


def _longest_needed(
    time: Instants, signals: ComplexArray, guess: float, longest_period: int
) -> HarmonicFit | None:
    """Fit the strongest line, or a longer period where the signals have subharmonics."""
    chosen = line = _fundamental(time, signals, guess)
    for factor in range(2, longest_period + 1):
        if line is None or chosen is None or chosen.misfit <= SUBHARMONIC_FLOOR:
            break
        if not _worth_fitting(time, signals, line, factor, chosen.misfit):
            continue
        longer = _fundamental(time, signals, guess / factor, factor)
        if longer is not None and longer.misfit < SUBHARMONIC_GAIN * chosen.misfit:
            chosen = longer
    return chosen


def _with_error(time: Instants, signals: ComplexArray, fit: HarmonicFit) -> Frequency | None:
    """Return the frequency with its error from other weights and parts; None if they disagree."""
    harmonics = len(fit.coefficients) // 2
    part = round(PART_SHARE * len(time))
    whole, first, last = slice(None), slice(0, part), slice(-part, None)
    deviation = 0.0
    for window, taper in ((whole, 2), (first, 1), (last, 1)):
        other = refined(
            time[window], signals[window], fit.frequency, harmonics=harmonics, taper=taper, steps=1
        )
        if other is None:
            return None
        deviation = max(deviation, abs(other - fit.frequency))
    rounding = ROUND_OFF_CYCLES / float(time[-1] - time[0])
    error = DEVIATION_FACTOR * deviation + FLOOR_FACTOR * fit.floor + rounding
    valid = fit.misfit <= MAX_MISFIT and error <= MAX_RELATIVE_ERROR * fit.frequency
    return Frequency(_sense(fit) * fit.frequency, error) if valid else None


def _sense(fit: HarmonicFit) -> float:
    middle = len(fit.coefficients) // 2
    clockwise = float(np.linalg.norm(fit.coefficients[middle - 1]))
    counter = float(np.linalg.norm(fit.coefficients[middle + 1]))
    return -1.0 if clockwise > (1.0 + SENSE_TOLERANCE) * counter else 1.0
