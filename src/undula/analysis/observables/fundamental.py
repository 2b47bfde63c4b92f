"""The fundamental frequency of a window of signals, with an error, or the admission of none."""

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

# Below this many periods in the window a frequency and a drift cannot be told apart: no answer.
MIN_PERIODS = 2.5
# Below this many samples a period strong harmonics fold back onto the fundamental: no answer.
MIN_SAMPLES_PER_PERIOD = 5.0
# The fewest samples worth a fit: MIN_PERIODS of MIN_SAMPLES_PER_PERIOD, rounded up.
MIN_SAMPLES = 13
# Two overlapping parts of the window this long are fitted again; they keep most of its resolution
# and still see different data.
PART = 2.0 / 3.0
# A motion whose harmonics leave more than this share of its RMS has no frequency of its own
# (half of the variance left would be 0.71; white noise leaves nearly 1).
MAX_MISFIT = 0.7
# An error above this share of the value means that the parts of the window disagree: no answer.
MAX_RELATIVE_ERROR = 0.2
# The pull of the remainder is that of one typical draw; four times it is exceeded rarely.
DEVIATIONS = 4.0
# The spread over parts and weights is a sample of four; the largest of so few is doubled.
SPREAD_FACTOR = 2.0
# Round-off of the fit, in windings over the window.
ROUND_OFF = 1e-11
# Clockwise and anticlockwise parts that agree to this are an oscillation, not a rotation: an
# ellipse of axes 50 to 1, which the first verdict calls planar too.
SENSE_TOLERANCE = 0.04
# It is taken when it leaves less than this share of that: more terms always leave a little less.
SUBHARMONIC_GAIN = 0.3
# A longer period is tried when the strongest line's harmonics leave more than this.
SUBHARMONIC_FLOOR = 1e-3


@dataclass(frozen=True)
class Frequency:
    """A frequency and the error it is believed to have.

    Attributes
    ----------
    value
        Cycles per unit of time (T); the sign is the sense of turning where there is one.
    error
        Bound meant to hold nearly always, same unit, at least the round-off of the fit.
    """

    value: float
    error: float


def find_frequency(
    time: Instants, signals: ComplexArray, *, longest_period: int = 1
) -> Frequency | None:
    """Find the frequency of the strongest line, refined with its harmonics.

    The error adds up the spread over other weights and other parts of the window, the pull of what
    the harmonics leave, and round-off.

    Parameters
    ----------
    time
        Equally spaced times [T], shape ``(m,)``.
    signals
        Shape ``(m, channels)``, one frequency common to all; real signals as complex ones.
    longest_period
        The period may be up to this many times that of the strongest line, where the signal repeats
        only then.

    Returns
    -------
    Frequency or None
        Negative when the parts turning clockwise are stronger. None when no line stands out, or
        the window holds fewer than 2.5 periods or a period fewer than 5 samples.
    """
    if len(time) < MIN_SAMPLES:
        return None
    guess = abs(spectral_peak(time, signals))
    fit = _longest_needed(time, signals, guess, longest_period)
    return None if fit is None else _with_error(time, signals, fit)


def _fundamental(
    time: Instants, signals: ComplexArray, guess: float, subharmonic: int = 1
) -> HarmonicFit | None:
    """Fit over the whole window, if the window and the sampling allow one."""
    if not _seen(time, guess, subharmonic):
        return None
    harmonics = harmonic_count(time, guess, subharmonic * MAX_HARMONICS)
    return fit_harmonics(time, signals, guess, harmonics=harmonics)


def _seen(time: Instants, guess: float, subharmonic: int) -> bool:
    span = float(time[-1] - time[0])
    rate = (len(time) - 1) / span
    return guess * span >= MIN_PERIODS and subharmonic * guess * MIN_SAMPLES_PER_PERIOD <= rate


def _worth_fitting(
    time: Instants, signals: ComplexArray, line: HarmonicFit, factor: int, least: float
) -> bool:
    """Whether a period so many times longer, unrefined, leaves about as little as it has to."""
    guess = line.frequency / factor
    if not _seen(time, guess, factor):
        return False
    harmonics = harmonic_count(time, guess, factor * MAX_HARMONICS)
    # What refining could still mend: at the line's own frequency little.
    return misfit_at(time, signals, guess, harmonics=harmonics) < 2.0 * SUBHARMONIC_GAIN * least


def _longest_needed(
    time: Instants, signals: ComplexArray, guess: float, longest_period: int
) -> HarmonicFit | None:
    """Fit the strongest line, or a longer period where the signals need one."""
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
    """Compare with other weights and other parts of the window; None if they tell nothing."""
    harmonics = len(fit.coefficients) // 2
    part = round(PART * len(time))
    everywhere, first, last = slice(None), slice(0, part), slice(-part, None)
    spread = 0.0
    for where, taper in ((everywhere, 2), (first, 1), (last, 1)):
        other = refined(
            time[where], signals[where], fit.frequency, harmonics=harmonics, taper=taper, steps=1
        )
        if other is None:
            return None
        spread = max(spread, abs(other - fit.frequency))
    rounding = ROUND_OFF / float(time[-1] - time[0])
    error = SPREAD_FACTOR * spread + DEVIATIONS * fit.floor + rounding
    told = fit.misfit <= MAX_MISFIT and error <= MAX_RELATIVE_ERROR * fit.frequency
    return Frequency(_sense(fit) * fit.frequency, error) if told else None


def _sense(fit: HarmonicFit) -> float:
    middle = len(fit.coefficients) // 2
    clockwise = float(np.linalg.norm(fit.coefficients[middle - 1]))
    counter = float(np.linalg.norm(fit.coefficients[middle + 1]))
    return -1.0 if clockwise > (1.0 + SENSE_TOLERANCE) * counter else 1.0
