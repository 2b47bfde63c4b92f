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
from functools import cached_property

import numpy as np
from scipy.linalg import toeplitz

from undula.analysis.harmonic_sums import harmonic_sums
from undula.analysis.spectral import hann
from undula.arrays import Array, ComplexArray, Instants

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
        How far the remainder might pull the frequency; see ``_pull``.
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
    return None if found is None else _finished(time, signals, found, harmonics, taper)


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
    weights = hann(len(time), taper)
    clock, span = _clock(time)
    start = frequency
    for _ in range(steps):
        step = _Sums.of(clock, signals, weights, frequency, harmonics).newton_step()
        frequency += step
        if abs(frequency - start) * span > 1.0:
            return None
        if abs(step) * span <= NEWTON_TOLERANCE:
            break
    return frequency


def misfit_at(time: Instants, signals: ComplexArray, frequency: float, *, harmonics: int) -> float:
    """Return the misfit of a fit of harmonics of a frequency that is not refined."""
    weights = hann(len(time))
    sums = _Sums.of(_clock(time)[0], signals, weights, frequency, harmonics)
    mean = np.sum(weights[:, None] * signals, axis=0)
    size = _weighted_square(signals - mean, weights)
    explained = np.sum((sums.coefficients.conj() * sums.plain).real) - np.sum(np.abs(mean) ** 2)
    return float(np.sqrt(max(0.0, 1.0 - explained / size))) if size > 0.0 else 0.0


def _clock(time: Instants) -> tuple[Instants, float]:
    """Return times from the middle on, and the length of the window."""
    return time - 0.5 * (time[0] + time[-1]), float(time[-1] - time[0])


def _basis(clock: Instants, frequency: float, harmonics: int) -> ComplexArray:
    """Columns exp(2 pi i k f t), k = -K..K, by repeated products: one exponential a sample."""
    first = np.exp(2j * np.pi * frequency * clock)
    upper = np.cumprod(np.broadcast_to(first[:, None], (len(clock), harmonics)), axis=1)
    middle = np.ones((len(clock), 1), dtype=np.complex128)
    return np.concatenate([upper[:, ::-1].conj(), middle, upper], axis=1)


@dataclass(frozen=True)
class _Projection:
    """Harmonics under a weight, with what is needed to fit them to several signals.

    The Gram matrix is Toeplitz, its entries the transform of the weight at multiples of f, so one
    product with the highest harmonic gives it whole.
    """

    basis: ComplexArray
    dual: ComplexArray
    gram: ComplexArray

    @classmethod
    def of(cls, basis: ComplexArray, weights: Array) -> _Projection:
        dual = (basis * weights[:, None]).conj().T
        row = dual[0] @ basis
        return cls(basis, dual, toeplitz(row.conj(), row))

    def fit(self, signals: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        """Coefficients and what they leave."""
        coefficients = np.linalg.solve(self.gram, self.dual @ signals).astype(np.complex128)
        return coefficients, signals - self.basis @ coefficients


def _slope(clock: Instants, onto: _Projection, coefficients: ComplexArray) -> ComplexArray:
    """Change of the model with f, without what a change of the coefficients could undo."""
    moved = onto.basis @ (_order(coefficients) * coefficients)
    return onto.fit(2j * np.pi * clock[:, None] * moved)[1]


def _order(coefficients: ComplexArray) -> Array:
    """Return the k of each coefficient, as a column."""
    return np.arange(len(coefficients), dtype=np.float64)[:, None] - len(coefficients) // 2


@dataclass(frozen=True)
class _Sums:
    """All that a step of Gauss and Newton takes of the samples.

    Weighted sums of the harmonics with one another, shape ``(3, 2 K + 1, 2 K + 1)``, plain, times t
    and times t^2; and with the signals, plain and times t, each ``(2 K + 1, channels)``.
    """

    gram: ComplexArray
    plain: ComplexArray
    timed: ComplexArray

    @classmethod
    def of(
        cls,
        clock: Instants,
        signals: ComplexArray,
        weights: Array,
        frequency: float,
        harmonics: int,
    ) -> _Sums:
        top, channels = 2 * harmonics + 1, signals.shape[1]
        even = np.empty((3, top), dtype=np.complex128)
        mixed = np.empty((2, channels, top), dtype=np.complex128)
        signals = np.ascontiguousarray(signals, dtype=np.complex128)
        harmonic_sums(clock, signals, weights, frequency, even, mixed)
        row = np.concatenate([even[:, :0:-1].conj(), even], axis=1)
        order = np.arange(top)
        gram = row[:, top - 1 + order[None, :] - order[:, None]]
        return cls(gram, mixed[0].T, mixed[1].T)

    @cached_property
    def coefficients(self) -> ComplexArray:
        """The fit."""
        return np.linalg.solve(self.gram[0], self.plain).astype(np.complex128)

    def newton_step(self) -> float:
        """Return the change of the frequency."""
        moved = 2j * np.pi * _order(self.coefficients) * self.coefficients
        seen = self.gram[1] @ moved
        # What a change of the coefficients could undo does not count.
        undone = np.sum((seen.conj() * np.linalg.solve(self.gram[0], seen)).real)
        steepness = float(np.sum((moved.conj() * (self.gram[2] @ moved)).real) - undone)
        left = self.timed - self.gram[1] @ self.coefficients
        pull = float(np.sum((moved.conj() * left).real))
        return pull / steepness if steepness > 0.0 else 0.0


def _weighted_square(values: ComplexArray, weights: Array) -> float:
    return float(np.sum(weights[:, None] * (values.real**2 + values.imag**2)))


def _finished(
    time: Instants, signals: ComplexArray, frequency: float, harmonics: int, taper: int
) -> HarmonicFit:
    weights, clock = hann(len(time), taper), _clock(time)[0]
    onto = _Projection.of(_basis(clock, frequency, harmonics), weights)
    coefficients, left = onto.fit(signals)
    size = _weighted_square(signals - np.sum(weights[:, None] * signals, axis=0), weights)
    rest = _weighted_square(left, weights)
    steepness = _weighted_square(_slope(clock, onto, coefficients), weights)
    pull = _pull(clock, onto, coefficients, left)
    return HarmonicFit(
        frequency=frequency,
        coefficients=coefficients,
        misfit=float(np.sqrt(rest / size)) if size > 0.0 else 0.0,
        floor=pull / steepness if steepness > 0.0 else float("inf"),
    )


def _pull(
    clock: Instants, onto: _Projection, coefficients: ComplexArray, left: ComplexArray
) -> float:
    """Pull of the remainder on f, harmonic by harmonic, largest over five weights.

    At f the pulls of all harmonics cancel, for so f was chosen. One by one they show harmonics that
    are no exact multiples; under a weight that swings once or twice over the window they show
    what the fit had no chance to remove. Only the part in quadrature pulls; the other is a change
    of amplitude.
    """
    phase = 2.0 * np.pi * clock / (clock[-1] - clock[0])
    waves = (f(n * phase) * np.sqrt(2.0) for n in (1, 2) for f in (np.cos, np.sin))
    lever = 2.0 * np.pi * _order(coefficients) * coefficients.conj()
    pulls = (
        np.sum(lever * (onto.dual @ ((clock * w)[:, None] * left)), axis=1)
        for w in (np.ones_like(phase), *waves)
    )
    return max(float(np.sum(np.abs(pull.imag))) for pull in pulls)
