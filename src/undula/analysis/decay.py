"""How the straight filament is approached or left: rate and frequency of the leading linear mode.

Near the straight filament the transverse motion is a sum of modes exp(sigma t). Late in a decay,
and early in a growth, one real mode or one complex pair is left. The samples, each with a later
one beside it, then move in a space of one or two dimensions; the matrix that steps them there is
fitted, its leading left eigenvector picks the mode out of the motion, and the slopes of that
mode's log-amplitude and phase over the whole window give sigma.
(Dynamic mode decomposition with delays: Schmid 2010; Tu et al. 2014.)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from undula.analysis.observables import arc_weights
from undula.analysis.planes import in_plane, plane_angle
from undula.arrays import Array, ComplexArray, Instants, Shapes

# A second direction weaker than this is noise or a faster mode about to vanish: one mode is left.
SECOND_DIRECTION = 1e-3
# The lag between the paired samples, as a share of the time between zero crossings (or of the
# window): long against the noise of neighbouring samples, short against half a swing.
LAG_SHARE = 0.2
# Fewer samples give the fit no remainder to judge it by.
MIN_SAMPLES = 8


@dataclass(frozen=True)
class LinearMotion:
    """Motion proportional to exp(rate t) cos(2 pi frequency t + phase).

    Attributes
    ----------
    rate
        Growth rate [1/T], negative for a decay.
    rate_error
        Larger difference between the rate and that of either half of the window [1/T].
    frequency
        Cycles per T; 0 for a monotone motion.
    crossings
        Sign changes, over the window, of the mean deflection along the principal direction.
    """

    rate: float
    rate_error: float
    frequency: float
    crossings: int

    @property
    def rings(self) -> bool:
        """Whether the motion was seen to swing through straight, and not just computed to."""
        return self.frequency > 0.0 and self.crossings > 0


def linear_motion(time: Instants, nodes: Shapes) -> LinearMotion | None:
    """Fit one real mode or one complex pair to a window of small motion.

    Parameters
    ----------
    time
        Equally spaced times [T], shape ``(m,)``.
    nodes
        Node positions [L], shape ``(m, N + 1, 3)``; close to straight in every sample.

    Returns
    -------
    LinearMotion or None
        None for fewer than 8 samples or a window in which nothing moves sideways.
    """
    if len(time) < MIN_SAMPLES:
        return None
    deflection, _ = in_plane(nodes, plane_angle(nodes))
    sizes = np.linalg.norm(deflection, axis=1)
    if not np.all(sizes > 0.0):
        return None
    crossings = _crossings(deflection)
    lag = max(1, int(LAG_SHARE * len(time) / (crossings + 1)))
    amplitude = _leading_amplitude(deflection, lag)
    clock = time[: len(amplitude)]
    rate, turning = _slopes(clock, amplitude)
    half = len(clock) // 2
    rates = [_slopes(clock[:half], amplitude[:half])[0], _slopes(clock[half:], amplitude[half:])[0]]
    return LinearMotion(
        rate=rate,
        rate_error=max(abs(other - rate) for other in rates),
        frequency=abs(turning) / (2.0 * np.pi),
        crossings=crossings,
    )


def _crossings(deflection: Array) -> int:
    mean = deflection @ arc_weights(deflection.shape[1])
    signs = np.sign(mean[mean != 0.0])
    return int(np.count_nonzero(signs[1:] != signs[:-1]))


def _leading_amplitude(deflection: Array, lag: int) -> ComplexArray:
    """Amplitude of the slowest mode, sample by sample, up to a constant factor."""
    paired = np.concatenate([deflection[:-lag], deflection[lag:]], axis=1)
    sizes = np.linalg.norm(paired, axis=1)
    even = paired / sizes[:, None]
    # The squares of singular values: quicker than these, and exact enough for the first two.
    squares, directions = np.linalg.eigh(even.T @ even)
    rank = 2 if squares[-2] > SECOND_DIRECTION**2 * squares[-1] else 1
    path = paired @ directions[:, : -rank - 1 : -1]
    # Each pair counts the same in the fit, however far the motion has decayed.
    before, after = path[:-lag] / sizes[:-lag, None], path[lag:] / sizes[:-lag, None]
    step, *_ = np.linalg.lstsq(before, after, rcond=None)
    values, vectors = np.linalg.eig(step)
    leading = int(np.argmax(np.abs(values)))
    return np.asarray(path @ vectors[:, leading], dtype=np.complex128)


def _slopes(clock: Instants, amplitude: ComplexArray) -> tuple[float, float]:
    """Rate [1/T] and angular frequency from straight lines through log-amplitude and phase."""
    logs = np.log(np.maximum(np.abs(amplitude), np.finfo(np.float64).tiny))
    centred = clock - np.mean(clock)
    steepness = float(np.sum(centred**2))
    turning = 0.0
    if np.any(amplitude.imag != 0.0):
        turning = float(centred @ np.unwrap(np.angle(amplitude))) / steepness
    return float(centred @ logs) / steepness, turning
