"""The fundamental frequency of sampled signals by a tapered fit of harmonics.

The model is z(t) = sum over k of c_k exp(2 pi i k f t), k = -K..K, with one set of c_k for each
channel and one f for all. The fit is least squares under a Hann weight: the harmonics take what is
periodic, even with two or three periods in the window, and the weight keeps what is not (other
frequencies, a transient, a drift) from leaking into f. For each f the c_k solve a linear system,
so one variable is left, refined by Gauss-Newton with the harmonics projected out.
(Golub & Pereyra 1973 for the projection; Harris 1978 for the weights.)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from undula.analysis.observables.harmonic_sums import judge_fit, refine
from undula.analysis.observables.spectrum import hann
from undula.arrays import ComplexArray, Instants

# More harmonics gain nothing: those of a smooth motion fall geometrically.
MAX_HARMONICS = 6
# The highest harmonic fitted stays this fraction of the sampling rate or below: Nyquist is 0.5.
TOP_FREQUENCY = 0.45
# From the peak of a spectrum Gauss-Newton gains two or more digits a step; ten are never needed.
NEWTON_STEPS = 10
# Newton stops at a change of this many windings over the whole window: what is left is smaller by
# those digits, and far below any noise.
NEWTON_TOLERANCE = 1e-11


@dataclass(frozen=True)
class HarmonicFit:
    """A fitted fundamental.

    Attributes
    ----------
    frequency
        The fundamental [cycles per unit of time], positive.
    coefficients
        c_k, k = -K..K, shape ``(2 K + 1, channels)``; times count from the window's middle.
    misfit
        Weighted RMS of what the harmonics leave over that of the signal without its mean.
    floor
        How far the remainder might pull the frequency; see ``_fitted``.
    """

    frequency: float
    coefficients: ComplexArray
    misfit: float
    floor: float


def harmonic_count(time: Instants, frequency: float, most: int = MAX_HARMONICS) -> int:
    """How many harmonics of a frequency the sampling resolves, between 1 and ``most``."""
    rate = (len(time) - 1) / (time[-1] - time[0])
    resolved = min(TOP_FREQUENCY * rate / frequency, len(time) / 4.0)
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
        Equally spaced times, shape ``(m,)``.
    signals
        Shape ``(m, channels)``; real signals are passed as complex ones.
    frequency
        First guess, positive, right to well within one winding over the window.
    harmonics
        Highest harmonic K, at least 1.
    taper
        Power of the Hann weight, 1 or 2.

    Returns
    -------
    HarmonicFit or None
        None when the refinement leaves the peak that it started on.
    """
    found = refined(time, signals, frequency, harmonics=harmonics, taper=taper)
    return None if found is None else _fitted(time, signals, found, harmonics, taper)


def refined(
    time: Instants,
    signals: ComplexArray,
    frequency: float,
    *,
    harmonics: int,
    taper: int = 1,
    steps: int = NEWTON_STEPS,
) -> float | None:
    """Return the frequency alone that `fit_harmonics` finds, which is quicker.

    One step is enough to tell to two digits by how much a frequency differs from the first guess.
    """
    clock, span = _clock(time)
    found, stayed = refine(
        clock,
        np.ascontiguousarray(signals, dtype=np.complex128),
        hann(len(time), taper),
        frequency,
        harmonics,
        steps,
        NEWTON_TOLERANCE / span,
        1.0 / span,
    )
    return float(found) if stayed else None


def misfit_at(time: Instants, signals: ComplexArray, frequency: float, *, harmonics: int) -> float:
    """Return the misfit of a fit of harmonics of a frequency that is not refined."""
    return _fitted(time, signals, frequency, harmonics, 1).misfit


def _clock(time: Instants) -> tuple[Instants, float]:
    """Return times from the middle on, and the length of the window."""
    return time - 0.5 * (time[0] + time[-1]), float(time[-1] - time[0])


def _fitted(
    time: Instants, signals: ComplexArray, frequency: float, harmonics: int, taper: int
) -> HarmonicFit:
    """Return the fit at a frequency.

    Its floor is the pull of the remainder on f, harmonic by harmonic, largest over five weights. At
    f the pulls of all harmonics cancel, for so f was chosen. One by one they show harmonics that
    are no exact multiples; under a weight that swings once or twice over the window they show
    what the fit had no chance to remove. Only the part in quadrature pulls; the other is a change
    of amplitude.
    """
    found = np.empty((signals.shape[1], 2 * harmonics + 1), dtype=np.complex128)
    size, rest, steepness, pull = judge_fit(
        _clock(time)[0],
        np.ascontiguousarray(signals, dtype=np.complex128),
        hann(len(time), taper),
        frequency,
        harmonics,
        found,
    )
    return HarmonicFit(
        frequency=frequency,
        coefficients=found.T,
        misfit=float(np.sqrt(rest / size)) if size > 0.0 else 0.0,
        floor=float(pull / steepness) if steepness > 0.0 else float("inf"),
    )
