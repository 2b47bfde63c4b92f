"""Compiled weighted inner products of harmonics and signals, and the least-squares fit by them."""

import math
from typing import Any

import numpy as np

from undula.jit.compilation import entry, kernel, overwrite


@kernel
def harmonic_sums(
    clock: Any, signals: Any, weights: Any, frequency: Any, even: Any, mixed: Any
) -> None:
    """Add up the inner products that a Gauss-Newton step needs, in one pass over the samples.

    Parameters
    ----------
    clock, weights
        Times t and weights w, shape ``(m,)``.
    signals
        z, complex, shape ``(m, channels)``.
    frequency
        f, with e_k = exp(2 pi i k f t).
    even
        Receives the sums of w e_k, w t e_k and w t^2 e_k for k = 0..2 K, shape ``(3, 2 K + 1)``.
    mixed
        Receives the sums of w z conj(e_k) and w t z conj(e_k) for k = -K..K, shape
        ``(2, channels, 2 K + 1)``.
    """
    top, middle = even.shape[1], mixed.shape[2] // 2
    cosine, sine = np.empty(top), np.empty(top)
    real, imaginary = np.zeros((3, top)), np.zeros((3, top))
    # Sums of products of real and imaginary parts give the sums for both signs of k.
    products = np.zeros((2, signals.shape[1], 4, middle + 1))
    for j in range(clock.shape[0]):
        phase = 2.0 * math.pi * frequency * clock[j]
        x, y, u, v = math.cos(phase), math.sin(phase), 1.0, 0.0
        for k in range(top):
            cosine[k], sine[k] = u, v
            u, v = u * x - v * y, u * y + v * x
        weight = weights[j]
        for power in range(3):
            for k in range(top):
                real[power, k] += weight * cosine[k]
                imaginary[power, k] += weight * sine[k]
            if power < 2:
                for a in range(signals.shape[1]):
                    p, q = weight * signals[j, a].real, weight * signals[j, a].imag
                    for k in range(middle + 1):
                        products[power, a, 0, k] += cosine[k] * p
                        products[power, a, 1, k] += sine[k] * q
                        products[power, a, 2, k] += cosine[k] * q
                        products[power, a, 3, k] += sine[k] * p
            weight *= clock[j]
    for power in range(3):
        for k in range(top):
            even[power, k] = complex(real[power, k], imaginary[power, k])
    for power in range(2):
        for a in range(signals.shape[1]):
            for k in range(middle + 1):
                cp, sq, cq, sp = products[power, a, :, k]
                mixed[power, a, middle - k] = complex(cp - sq, cq + sp)
                mixed[power, a, middle + k] = complex(cp + sq, cq - sp)


@kernel
def factor_gram(row: Any, lower: Any) -> None:
    """Write to lower (n, n) the Cholesky factor of the Hermitian matrix with entries r_(j - i).

    `row` (n,) contains r_0, r_1, ...
    """
    for j in range(row.shape[0]):
        for i in range(j, row.shape[0]):
            value = np.conj(row[i - j])
            for k in range(j):
                value -= lower[i, k] * np.conj(lower[j, k])
            lower[i, j] = value / lower[j, j] if i > j else complex(math.sqrt(value.real), 0.0)


@kernel
def solve_gram(lower: Any, x: Any) -> None:
    """Overwrite x (n,) by the solution of the factored system."""
    n = x.shape[0]
    for i in range(n):
        for k in range(i):
            x[i] -= lower[i, k] * x[k]
        x[i] /= lower[i, i]
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            x[i] -= np.conj(lower[k, i]) * x[k]
        x[i] /= lower[i, i]


@kernel
def times_gram(row: Any, x: Any, out: Any) -> None:
    """Write to out (n,) the product of the matrix of `factor_gram` with x (n,)."""
    for i in range(x.shape[0]):
        total = 0.0j
        for j in range(x.shape[0]):
            total += (row[j - i] if j >= i else np.conj(row[i - j])) * x[j]
        out[i] = total


@kernel
def fit(
    row: Any, lower: Any, fitted: Any, delayed: Any, rates: Any, product: Any, compensated: Any
) -> Any:
    """Overwrite the inner products of a signal by its fit; return gradient and curvature in f.

    Parameters
    ----------
    row, lower
        The inner products of harmonics, shape ``(3, 2 K + 1)``, and the factor of the first row.
    fitted, delayed
        The inner products of the signal with harmonics, without and with a factor t, shape
        ``(2 K + 1,)``.
    rates
        Receives the coefficients of the time derivative of the fit.
    product, compensated
        Scratch.
    """
    top, pull, steepness = fitted.shape[0], 0.0, 0.0
    solve_gram(lower, fitted)
    times_gram(row[1], fitted, product)
    for k in range(top):
        rates[k] = 2.0j * math.pi * (k - top // 2) * fitted[k]
        pull += (np.conj(rates[k]) * (delayed[k] - product[k])).real
    times_gram(row[2], rates, product)
    for k in range(top):
        steepness += (np.conj(rates[k]) * product[k]).real
    times_gram(row[1], rates, product)
    overwrite(compensated, product)
    solve_gram(lower, compensated)
    # The part of the change in f that a change of the coefficients compensates does not count.
    for k in range(top):
        steepness -= (np.conj(product[k]) * compensated[k]).real
    return pull, steepness


@entry("clock (m), signals (m, c) complex, weights (m)", where=lambda harmonics: harmonics >= 0)
def refine(
    clock: Any,
    signals: Any,
    weights: Any,
    frequency: Any,
    harmonics: Any,
    most: Any,
    tolerance: Any,
    farthest: Any,
) -> Any:
    """Return a frequency after Gauss-Newton steps, and True if it has stayed on its peak.

    Parameters
    ----------
    clock, signals, weights
        As in `harmonic_sums`.
    frequency
        First guess [cycles/T].
    harmonics
        K.
    most
        Largest number of steps.
    tolerance
        Length of the last step [cycles/T].
    farthest
        Largest distance from the first guess on the same peak [cycles/T].
    """
    top, channels, start = 2 * harmonics + 1, signals.shape[1], frequency
    even = np.empty((3, top), dtype=np.complex128)
    mixed = np.empty((2, channels, top), dtype=np.complex128)
    lower, scratch = np.empty((top, top), dtype=np.complex128), np.empty_like(even)
    for _ in range(most):
        harmonic_sums(clock, signals, weights, frequency, even, mixed)
        factor_gram(even[0], lower)
        pull, steepness = 0.0, 0.0
        for a in range(channels):
            terms = fit(even, lower, mixed[0, a], mixed[1, a], scratch[0], scratch[1], scratch[2])
            pull += terms[0]
            steepness += terms[1]
        step = pull / steepness if steepness > 0.0 else 0.0
        frequency += step
        if not abs(frequency - start) <= farthest:
            return frequency, False
        if abs(step) <= tolerance:
            break
    return frequency, True


@entry(
    "clock (m), signals (m, c) complex, weights (m), coefficients (c, 2 * harmonics + 1) complex",
    where=lambda m, harmonics: m > 0 and harmonics >= 0,
)
def judge_fit(
    clock: Any, signals: Any, weights: Any, frequency: Any, harmonics: Any, coefficients: Any
) -> Any:
    """Write the fit at a frequency to coefficients (channels, 2 K + 1), and measure its remainder.

    The parameters are those of `refine`. Returns the weighted squares of the signals without their
    means and of the remainder, the curvature of the fit in f, and the pull of the remainder on f,
    largest over five weights, as `undula.analysis.observables.harmonics` describes it.
    """
    count, top, channels = clock.shape[0], 2 * harmonics + 1, signals.shape[1]
    even = np.empty((3, top), dtype=np.complex128)
    mixed = np.empty((2, channels, top), dtype=np.complex128)
    lower, scratch = np.empty((top, top), dtype=np.complex128), np.empty_like(even)
    pulls = np.zeros((5, top), dtype=np.complex128)
    harmonic_sums(clock, signals, weights, frequency, even, mixed)
    factor_gram(even[0], lower)
    square, rest, steepness = 0.0, 0.0, 0.0
    wave, turns = np.empty(top, dtype=np.complex128), 2.0 * math.pi / (clock[-1] - clock[0])
    for a in range(channels):
        mean = mixed[0, a, harmonics]
        steepness += fit(even, lower, mixed[0, a], mixed[1, a], scratch[0], scratch[1], scratch[2])[
            1
        ]
        coefficients[a] = mixed[0, a]
        for j in range(count):
            left, phase = signals[j, a], 2.0 * math.pi * frequency * clock[j]
            square += weights[j] * abs(left - mean) ** 2
            step = complex(math.cos(phase), math.sin(phase))
            wave[harmonics] = complex(1.0, 0.0)
            for k in range(harmonics, top - 1):
                wave[k + 1] = wave[k] * step
                wave[top - 2 - k] = np.conj(wave[k + 1])
            for k in range(top):
                left -= coefficients[a, k] * wave[k]
            rest += weights[j] * abs(left) ** 2
            once, twice, root = turns * clock[j], 2.0 * turns * clock[j], math.sqrt(2.0)
            modulations = (1.0, math.cos(once), math.sin(once), math.cos(twice), math.sin(twice))
            for n in range(5):
                part = weights[j] * clock[j] * modulations[n] * (root if n > 0 else 1.0) * left
                for k in range(top):
                    pulls[n, k] += np.conj(scratch[0, k] * wave[k]) * part
    # The pulls lack a factor i, as `fit` has left the time derivatives in the scratch array.
    return square, rest, steepness, np.max(np.sum(np.abs(pulls.real), axis=1))
