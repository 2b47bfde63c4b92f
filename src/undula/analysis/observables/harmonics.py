"""Fundamental frequency of sampled signals by a tapered least-squares fit of harmonics.

The model is z(t) = sum over k of c_k exp(2 pi i k f t), k = -K..K, with one set of c_k for each
channel and one f for all. The harmonics represent the periodic part, even with two or three periods
in the window; the Hann weight keeps other frequencies, transients and drifts from leaking into f.
For each f the c_k solve a linear system; the remaining variable f is refined by Gauss-Newton with
the harmonics projected out (variable projection).

Sources: Golub & Pereyra (1973) for the projection, Harris (1978) for the weights.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from undula.analysis.observables.harmonic_sums import judge_fit, refine
from undula.analysis.observables.spectrum import hann
from undula.arrays import ComplexArray, Instants

# Largest number of harmonics: those of a smooth motion fall geometrically.
MAX_HARMONICS = 6
# Largest frequency of a fitted harmonic, as a share of the sampling rate (Nyquist: 0.5).
MAX_CYCLES_PER_SAMPLE = 0.45
# Largest number of Gauss-Newton steps: each gains two or more digits from the spectral peak on.
NEWTON_STEPS = 10
# Last Gauss-Newton step [cycles over the window]: the remaining error is far below any noise.
NEWTON_TOLERANCE = 1e-11


@dataclass(frozen=True)
class HarmonicFit:
    """A fitted fundamental.

    Attributes
    ----------
    frequency
        The fundamental [cycles/T], positive.
    coefficients
        c_k, k = -K..K, shape ``(2 K + 1, channels)``, for times from the middle of the window.
    misfit
        Weighted RMS of the remainder over that of the signal without its mean, from 0 to 1.
    floor
        Estimated change of the frequency by the remainder [cycles/T]; see ``_fitted``.
    """

    frequency: float
    coefficients: ComplexArray
    misfit: float
    floor: float


def harmonic_count(time: Instants, frequency: float, most: int = MAX_HARMONICS) -> int:
    """Return the number of harmonics of a frequency that the sampling resolves.

    Parameters
    ----------
    time
        Equally spaced times [T], shape ``(m,)``.
    frequency
        Positive [cycles/T].
    most
        Largest number returned, at least 1.

    Returns
    -------
    int
        From 1 to ``most``.
    """
    rate = (len(time) - 1) / (time[-1] - time[0])
    resolved = min(MAX_CYCLES_PER_SAMPLE * rate / frequency, len(time) / 4.0)
    return int(min(most, max(1.0, resolved)))


def fit_harmonics(
    time: Instants,
    signals: ComplexArray,
    frequency: float,
    *,
    harmonics: int,
    taper: int = 1,
) -> HarmonicFit | None:
    """Fit harmonics of one fundamental to all channels.

    Parameters
    ----------
    time
        Equally spaced times [T], shape ``(m,)``.
    signals
        Complex, shape ``(m, channels)``.
    frequency
        First guess, positive [cycles/T], with an error of less than one cycle over the window.
    harmonics
        Highest harmonic K, at least 1.
    taper
        Power of the Hann weight, 1 or 2.

    Returns
    -------
    HarmonicFit or None
        None when the refinement leaves the peak of the first guess.
    """
    fundamental = refined(time, signals, frequency, harmonics=harmonics, taper=taper)
    return None if fundamental is None else _fitted(time, signals, fundamental, harmonics, taper)


def refined(
    time: Instants,
    signals: ComplexArray,
    frequency: float,
    *,
    harmonics: int,
    taper: int = 1,
    steps: int = NEWTON_STEPS,
) -> float | None:
    """Return only the frequency that `fit_harmonics` finds, in less time.

    Parameters
    ----------
    time, signals, frequency, harmonics, taper
        As in `fit_harmonics`.
    steps
        Largest number of Gauss-Newton steps, at least 1: one gives the difference from the first
        guess to two digits.

    Returns
    -------
    float or None
        Frequency [cycles/T]; None when the refinement leaves the peak of the first guess.
    """
    clock, span = _clock(time)
    fundamental, stayed = refine(
        clock,
        np.ascontiguousarray(signals, dtype=np.complex128),
        hann(len(time), taper),
        frequency,
        harmonics,
        steps,
        NEWTON_TOLERANCE / span,
        1.0 / span,
    )
    return float(fundamental) if stayed else None


def misfit_at(time: Instants, signals: ComplexArray, frequency: float, *, harmonics: int) -> float:
    """Return the misfit of a fit of harmonics at a fixed frequency.

    Parameters
    ----------
    time, signals, frequency, harmonics
        As in `fit_harmonics`.

    Returns
    -------
    float
        From 0 to 1, as in `HarmonicFit`.
    """
    return _fitted(time, signals, frequency, harmonics, 1).misfit


def _clock(time: Instants) -> tuple[Instants, float]:
    """Return times relative to the middle of the window, and its length."""
    return time - 0.5 * (time[0] + time[-1]), float(time[-1] - time[0])


def _fitted(
    time: Instants, signals: ComplexArray, frequency: float, harmonics: int, taper: int
) -> HarmonicFit:
    """Return the fit at a frequency.

    The floor is the sum of the pulls of the remainder on f over the harmonics, largest over five
    weights. The signed pulls cancel at the fitted f; their moduli show harmonics that are not exact
    multiples, and weights that oscillate once or twice over the window show what the fit could not
    remove. Only the part in quadrature changes f; the other part changes the amplitude.
    """
    coefficients = np.empty((signals.shape[1], 2 * harmonics + 1), dtype=np.complex128)
    square, rest, steepness, pull = judge_fit(
        _clock(time)[0],
        np.ascontiguousarray(signals, dtype=np.complex128),
        hann(len(time), taper),
        frequency,
        harmonics,
        coefficients,
    )
    return HarmonicFit(
        frequency=frequency,
        coefficients=coefficients.T,
        misfit=float(np.sqrt(rest / square)) if square > 0.0 else 0.0,
        floor=float(pull / steepness) if steepness > 0.0 else float("inf"),
    )
