"""Compiled passes over the samples of a decay, for `undula.analysis.observables.linear_mode`."""

import math
from typing import Any

import numpy as np

from undula.jit.compilation import entry

_TINY = float(np.finfo(np.float64).tiny)
# Square of the sine between two columns below which they are parallel to round-off.
_MIN_SINE_SQUARED = 1e-26


@entry("nodes (m, k, 3), weights (k), along (m, k)")
def deflect(nodes: Any, angle: Any, weights: Any, along: Any) -> Any:
    """Write to along (m, N + 1) the deflections of shapes (m, N + 1, 3) in the plane at an azimuth.

    Returns the number of sign changes of their mean, with weights (N + 1,), and True if all samples
    have a deflection other than 0.
    """
    cosine, sine = math.cos(angle), math.sin(angle)
    crossings, sign, moved = 0, 0.0, True
    for i in range(nodes.shape[0]):
        mean, square = 0.0, 0.0
        for k in range(nodes.shape[1]):
            along[i, k] = cosine * nodes[i, k, 0] + sine * nodes[i, k, 1]
            mean += weights[k] * along[i, k]
            square += along[i, k] ** 2
        moved = moved and square > 0.0
        if mean != 0.0:
            crossings += mean * sign < 0.0
            sign = math.copysign(1.0, mean)
    return crossings, moved


@entry("along (m, k), even (p, 2 * k), sizes (p)", where=lambda lag, m, p: 0 <= lag <= m - p)
def pair(along: Any, lag: Any, even: Any, sizes: Any) -> None:
    """Write to even (p, 2 (N + 1)) each deflection and the one `lag` later, scaled to norm 1.

    The norms are written to sizes (p,).
    """
    nodes = along.shape[1]
    for i in range(even.shape[0]):
        square = 0.0
        for k in range(nodes):
            square += along[i, k] ** 2 + along[i + lag, k] ** 2
        sizes[i] = math.sqrt(square)
        inverse = 1.0 / sizes[i]
        for k in range(nodes):
            even[i, k] = inverse * along[i, k]
            even[i, nodes + k] = inverse * along[i + lag, k]


@entry("path (p, 2), sizes (p), step (2, 2)", where=lambda lag: lag >= 0)
def fit_step(path: Any, sizes: Any, lag: Any, step: Any) -> None:
    """Write to step (2, 2) the matrix S that maps samples to those `lag` later.

    `path` (p, 2) contains the coordinates z of the samples, each divided by its norm. S minimises
    the squares of z_later - z S with equal weight for each sample; the columns are orthogonalised
    first.
    """
    first, mixed, second = 0.0, 0.0, 0.0
    for i in range(path.shape[0] - lag):
        first += path[i, 0] ** 2
        mixed += path[i, 0] * path[i, 1]
    mixed /= first
    step[:] = 0.0
    for i in range(path.shape[0] - lag):
        growth, rest = sizes[i + lag] / sizes[i], path[i, 1] - mixed * path[i, 0]
        second += rest * rest
        for b in range(2):
            later = growth * path[i + lag, b]
            step[0, b] += path[i, 0] * later
            step[1, b] += rest * later
    for b in range(2):
        step[1, b] = step[1, b] / second if second > _MIN_SINE_SQUARED * first else 0.0
        step[0, b] = step[0, b] / first - mixed * step[1, b]


@entry("path (p, 2), sizes (p), vector (3), logs (p), phases (p)")
def follow(path: Any, sizes: Any, vector: Any, logs: Any, phases: Any) -> None:
    """Write logarithm and continuous phase (p,) of the amplitude of a mode.

    `path` (p, 2) and `sizes` (p,) are those of `fit_step`. The amplitude is the product of the
    coordinates z with `vector` (3,): its first entry, real, and real and imaginary part of its
    second one.
    """
    last = 0.0
    for i in range(path.shape[0]):
        x = vector[0] * path[i, 0] + vector[1] * path[i, 1]
        y = vector[2] * path[i, 1]
        logs[i] = math.log(max(sizes[i] * math.sqrt(x * x + y * y), _TINY))
        phase = math.atan2(y, x) if vector[2] != 0.0 else 0.0
        change = phase - last
        phases[i] = change - 2.0 * math.pi * round(change / (2.0 * math.pi))
        phases[i] += phases[i - 1] if i > 0 else 0.0
        last = phase
