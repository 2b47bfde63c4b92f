"""Collocation on one interval of a flow: stages by Newton's method, and their linearisation.

On an interval of length h the stage values Y_1, ..., Y_s of a collocation method
(`undula.numerics.orbits.radau`) solve

    residual(Y_i, W_i) = 0,    W_i = (1 / h) sum_{j=0..s} D_ij Y_j,    i = 1, ..., s,

simultaneously. With the derivatives A_i and R_i of the residual by y and w, their matrix has blocks

    delta_ij A_i + (D_ij / h) R_i,

and it is banded where unknowns are sorted by component first, by stage second. Its factors serve
Newton's method and then the sensitivities: a change r_i of the equations changes the stages by the
solution of the same system with -r_i.
"""

from dataclasses import dataclass
from enum import Enum
from typing import Self

import numpy as np
from numpy.lib.stride_tricks import as_strided
from scipy.linalg.lapack import dgbtrf, dgbtrs

from undula.arrays import Array
from undula.numerics.continuation.problem import Equations
from undula.numerics.orbits.radau import Radau, interpolation

_MAX_STEPS = 12
# Relative step of the positions after which quadratic convergence leaves only round-off; the matrix
# of that step is then exact to as many digits.
_STEP_TOLERANCE = 1e-10
# Relative last step of the multipliers, in which the residual is linear.
_MULTIPLIER_TOLERANCE = 1e-6


class Outcome(Enum):
    """Outcome of a flow; the value states the cure."""

    DONE = "the end was reached"
    NOT_CONVERGED = "the stages of an interval were not found; use more intervals"
    SINGULAR = "the stages of an interval are not determined; use more intervals"
    NOT_FINITE = "the stages of an interval grew beyond all bounds; use more intervals"


class Scheme:
    """A collocation method on intervals of one length.

    Parameters
    ----------
    equations : Equations
        The differential equation.
    method : Radau
        Table of the method, with s stages.
    h : float
        Length of the intervals, above 0.
    """

    def __init__(self, equations: Equations, method: Radau, h: float) -> None:
        self.equations, self.h = equations, h
        self.moving = np.asarray(equations.differential, dtype=bool)
        self.rates = method.differentiation / h
        self._ahead = interpolation(method.grid, 1.0 + method.nodes)
        self._ahead_of_multipliers = interpolation(method.nodes, 1.0 + method.nodes)

    def velocities(self, y: Array, stages: Array) -> Array:
        """Return the velocities W (s, n) for a start y (n,) and stages (s, n)."""
        return np.where(self.moving, self.rates @ np.vstack([y, stages]), 0.0)

    def extrapolate(self, y: Array, stages: Array) -> Array:
        """Return the polynomial of an interval at the stages of the next interval, (s, n)."""
        positions = self._ahead @ np.vstack([y, stages])
        return np.where(self.moving, positions, self._ahead_of_multipliers @ stages)


@dataclass(frozen=True)
class Linearisation:
    """The equations of an interval, linearised at stage values and factored.

    Attributes
    ----------
    stages, velocities : ndarray of shape (s, n)
        The point of the linearisation.
    drag : ndarray of shape (s, n, 2 e + 1)
        The bands of R, without outer diagonals that are zero.
    """

    stages: Array
    velocities: Array
    drag: Array
    _factors: Array
    _pivots: Array
    _half_bandwidth: int  # half-bandwidth of the matrix

    @classmethod
    def at(cls, scheme: Scheme, y: Array, stages: Array) -> Self | None:
        """Return the linearisation for a start y (n,) at stages (s, n); None if it is singular."""
        velocities = scheme.velocities(y, stages)
        pairs = zip(stages, velocities, strict=True)
        slopes, drags = zip(*(scheme.equations.parts(*pair, 0.0) for pair in pairs), strict=True)
        drag = _trimmed(np.stack(drags))
        matrix, half_bandwidth = _stage_matrix(
            _trimmed(np.stack(slopes)), drag, scheme.rates[:, 1:]
        )
        factors, pivots, failed = dgbtrf(matrix, half_bandwidth, half_bandwidth, overwrite_ab=1)
        return None if failed else cls(stages, velocities, drag, factors, pivots, half_bandwidth)

    def solve(self, right: Array) -> Array:
        """Return changes of the stages (c, n, s) for right-hand sides (c, n, s), in place."""
        flat = right.reshape(right.shape[0], -1).T
        changes, _ = dgbtrs(
            self._factors,
            self._half_bandwidth,
            self._half_bandwidth,
            flat,
            self._pivots,
            overwrite_b=1,
        )
        return np.asarray(changes.T.reshape(right.shape))


def _trimmed(bands: Array) -> Array:
    """Return bands (s, n, 2 b + 1) without outer diagonals that are all zero."""
    half = bands.shape[2] // 2
    used = np.flatnonzero(np.any(bands, axis=(0, 1)))
    half_bandwidth = int(np.abs(used - half).max()) if used.size else 0
    return bands[:, :, half - half_bandwidth : half + half_bandwidth + 1]


def _stage_matrix(slopes: Array, drag: Array, rates: Array) -> tuple[Array, int]:
    """Return the matrix in LAPACK's band storage, with room for fill-in, and its half-bandwidth.

    The entry of row i s + p and column (i + o) s + q lies p - q - o s below the diagonal. As
    columns are contiguous, its address is linear in p, q, i and o, and the whole matrix is filled
    through one strided view. Padding columns at both ends hold entries beyond the matrix.
    """
    s, n, _ = slopes.shape
    wide, narrow = slopes.shape[2] // 2, drag.shape[2] // 2
    padding = max(wide, narrow)
    half_bandwidth = max(wide * s, narrow * s + s - 1)
    rows = 3 * half_bandwidth + 1
    padded = np.zeros((n + 2 * padding) * s * rows)

    def blocks(half: int) -> Array:
        """Return the view [p, q, i, half + o] of the diagonals o up to `half`."""
        first = (padding - half) * s * rows + 2 * half_bandwidth + half * s
        steps = np.array([1, rows - 1, s * rows, s * rows - s]) * padded.itemsize
        return as_strided(padded[first:], (s, s, n, 2 * half + 1), steps)

    blocks(narrow)[...] = rates[:, :, None, None] * drag[:, None]
    on_diagonal = np.einsum("ppik->pik", blocks(wide))
    on_diagonal += slopes
    inner = padded.reshape(-1, rows)[padding * s : (padding + n) * s]
    return inner.T, half_bandwidth


@dataclass(frozen=True)
class StageSolution:
    """The stages (s, n) of an interval, and the last matrix of Newton's method."""

    outcome: Outcome
    stages: Array
    steps: int
    linearisation: Linearisation | None = None


def solve_stages(scheme: Scheme, y: Array, guess: Array) -> StageSolution:
    """Solve for the stages of an interval by Newton's method.

    It ends after a step that is small relative to the positions. Multipliers that are not within
    round-off then get one more step.

    Parameters
    ----------
    scheme : Scheme
        The method.
    y : ndarray of shape (n,)
        Start of the interval.
    guess : ndarray of shape (s, n)
        Guess of the stages.

    Returns
    -------
    StageSolution
        Failure is an outcome, not an exception.
    """
    stages, positions_converged = guess, False
    for steps in range(1, _MAX_STEPS + 1):
        linearisation = Linearisation.at(scheme, y, stages)
        if linearisation is None:
            return StageSolution(Outcome.SINGULAR, stages, steps)
        pairs = zip(stages, linearisation.velocities, strict=True)
        residuals = np.stack([scheme.equations.residual(*pair) for pair in pairs], axis=1)
        step = -linearisation.solve(residuals[None])[0].T
        if not np.isfinite(step).all():
            return StageSolution(Outcome.NOT_FINITE, stages, steps)
        stages = stages + step
        positions_small = _is_small(step, stages, scheme.moving, _STEP_TOLERANCE)
        if positions_small and (
            positions_converged or _is_small(step, stages, ~scheme.moving, _MULTIPLIER_TOLERANCE)
        ):
            return StageSolution(Outcome.DONE, stages, steps, linearisation)
        positions_converged = positions_small
    return StageSolution(Outcome.NOT_CONVERGED, stages, _MAX_STEPS)


def _is_small(step: Array, value: Array, part: Array, limit: float) -> bool:
    """Return whether a step is small relative to the largest value of a part of the unknowns."""
    size = np.abs(value[:, part]).max(initial=0.0)
    return bool(np.abs(step[:, part]).max(initial=0.0) <= limit * size)
