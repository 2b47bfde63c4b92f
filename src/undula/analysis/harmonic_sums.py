"""Compiled weighted sums of harmonics with one another and with signals."""

import math
from typing import Any

import numpy as np

from undula.compiled import entry


@entry
def harmonic_sums(
    clock: Any, signals: Any, weights: Any, frequency: Any, even: Any, mixed: Any
) -> None:
    """Add up all that a step of Gauss and Newton takes of the samples, in one pass.

    Parameters
    ----------
    clock, weights
        Times t and weights w, shape ``(m,)``.
    signals
        z, complex, shape ``(m, channels)``.
    frequency
        f; e_k stands for exp(2 pi i k f t).
    even
        Receives the sums of w e_k, w t e_k and w t^2 e_k for k = 0..2 K, shape ``(3, 2 K + 1)``.
    mixed
        Receives those of w z conj(e_k) and then of w t z conj(e_k) for k = -K..K, shape ``(2,
        channels, 2 K + 1)``.
    """
    top, middle = even.shape[1], mixed.shape[2] // 2
    cosine, sine = np.empty(top), np.empty(top)
    real, imaginary = np.zeros((3, top)), np.zeros((3, top))
    # Sums of products of real and imaginary parts, of which both signs of k are made.
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
