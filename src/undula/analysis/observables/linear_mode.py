"""Rate and frequency of the leading linear mode of a small motion about the straight state.

Near the straight filament the transverse motion is a sum of modes exp(sigma t). Late in a decay,
and early in a growth, one real mode or one complex pair remains. Samples joined with later ones
then span one or two dimensions. The matrix of the step in time is fitted there, its leading left
eigenvector projects the motion on the mode, and the slopes of the log-amplitude and the phase of
the mode over the whole window give sigma.

Source: dynamic mode decomposition with delays, Schmid (2010); Tu et al. (2014).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.linalg import lapack

from undula.analysis.observables.decay_sums import deflect, fit_step, follow, pair
from undula.analysis.observables.planarity import plane_angle
from undula.analysis.observables.sample_sums import line_slope
from undula.analysis.observables.shapes import arc_weights, as_shapes
from undula.arrays import Array, Instants, Shapes

# Least relative strength of the second direction; a weaker one is noise or a faster mode that
# vanishes, and one real mode is fitted.
MIN_SECOND_DIRECTION = 1e-3
# Lag between paired samples, as a share of the time between zero crossings (or of the window): long
# compared with the noise of neighbouring samples, short compared with half an oscillation.
LAG_SHARE = 0.2
# Number of nodes in the fit: a filament near straight moves in its longest waves, and the matrix of
# the correlations costs the square of the number.
FITTED_NODES = 10
# Least number of samples, which leave the fit a remainder.
MIN_SAMPLES = 8


@dataclass(frozen=True)
class LinearMotion:
    """Motion proportional to exp(rate t) cos(2 pi frequency t + phase).

    Attributes
    ----------
    rate
        Growth rate [1/T], negative for a decay.
    rate_error
        Largest difference between the rate and the rates of the two halves of the window [1/T].
    frequency
        Frequency [cycles/T]; 0 for a monotone motion.
    crossings
        Sign changes over the window of the mean deflection along the principal direction.
    """

    rate: float
    rate_error: float
    frequency: float
    crossings: int

    @property
    def rings(self) -> bool:
        """True if the fit oscillates and the samples cross the straight state."""
        return self.frequency > 0.0 and self.crossings > 0


def linear_motion(time: Instants, nodes: Shapes) -> LinearMotion | None:
    """Fit one real mode or one complex pair to a window of small motion.

    Parameters
    ----------
    time
        Equally spaced times [T], shape ``(m,)``.
    nodes
        Node positions [L], shape ``(m, N + 1, 3)``, close to straight in every sample.

    Returns
    -------
    LinearMotion or None
        None for fewer than 8 samples or a window with a sample that is exactly straight.
    """
    if len(time) < MIN_SAMPLES:
        return None
    along, weights = np.empty(nodes.shape[:2]), arc_weights(nodes.shape[1])
    crossings, moved = deflect(as_shapes(nodes), plane_angle(nodes), weights, along)
    if not moved:
        return None
    lag = max(1, int(LAG_SHARE * len(time) / (crossings + 1)))
    stride = -(-(nodes.shape[1] - 1) // FITTED_NODES)
    logs, phases = _amplitude_of_leading_mode(np.ascontiguousarray(along[:, :0:-stride]), lag)
    clock = np.ascontiguousarray(time[: len(logs)])
    half = len(clock) // 2
    rate, *rates = (
        line_slope(clock[part], logs[part], False)
        for part in (slice(None), slice(half), slice(half, None))
    )
    return LinearMotion(
        rate=rate,
        rate_error=max(abs(other - rate) for other in rates),
        frequency=abs(line_slope(clock, phases, False)) / (2.0 * np.pi),
        crossings=crossings,
    )


def _amplitude_of_leading_mode(along: Array, lag: int) -> tuple[Array, Array]:
    """Return logarithm and phase of the amplitude of the slowest mode, up to constants."""
    pairs = len(along) - lag
    even, sizes = np.empty((pairs, 2 * along.shape[1])), np.empty(pairs)
    pair(along, lag, even, sizes)
    # Squared singular values take less time, and are accurate enough for the first two directions.
    width = even.shape[1]
    squares, directions, *_ = lapack.dsyevr(even.T @ even, range="I", il=width - 1, iu=width)
    path = even @ np.ascontiguousarray(directions[:, ::-1])
    vector = np.array([1.0, 0.0, 0.0])
    if squares[0] > MIN_SECOND_DIRECTION**2 * squares[1]:
        step = np.empty((2, 2))
        fit_step(path, sizes, lag, step)
        vector[:] = leading_vector(*step.ravel().tolist())
    logs, phases = np.empty(pairs), np.empty(pairs)
    follow(path, sizes, vector, logs, phases)
    return logs, phases


def leading_vector(a: float, b: float, c: float, d: float) -> tuple[float, float, float]:
    """Return an eigenvector of [[a, b], [c, d]] for the eigenvalue of largest modulus.

    Parameters
    ----------
    a, b, c, d
        Entries of the matrix.

    Returns
    -------
    tuple of float
        The first entry, which is real, then real and imaginary part of the second.
    """
    half = 0.5 * (a - d)
    square = half * half + b * c
    if square < 0.0:
        return b, -half, math.sqrt(-square)
    root = math.copysign(math.sqrt(square), a + d)
    # Both rows give the eigenvector; this one has no cancellation.
    first, second = (half + root, c) if half * root >= 0.0 else (b, root - half)
    return (first, second, 0.0) if first or second else (1.0, 0.0, 0.0)
