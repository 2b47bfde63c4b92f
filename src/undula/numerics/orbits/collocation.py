"""One interval of a flow: its stages by Newton's method, and their exact linearisation.

On an interval of length h the stage values Y_1, ..., Y_s of a collocation method
(`undula.numerics.orbits.radau`) solve

    residual(Y_i, W_i) = 0,    W_i = (1 / h) sum_{j=0..s} D_ij Y_j,    i = 1, ..., s,

all together. With A_i, R_i the derivatives of the residual by y and w, their matrix has the blocks

    delta_ij A_i + (D_ij / h) R_i,

and is banded where unknowns are sorted by component first, by stage second. Its factors serve
Newton's method and then the sensitivities: what changes the equations by r_i changes the stages by
the solution of the same system with -r_i.
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

_MOST_STEPS = 12
# Newton's method converges quadratically: after a step this small, for the size of the positions,
# nothing is left but round-off, and the matrix of that step is exact to as many digits.
_SMALL_STEP = 1e-10
# The residual is linear in the multipliers, so that a rough last step of them does no harm.
_SMALL_STEP_OF_MULTIPLIERS = 1e-6


class Outcome(Enum):
    """How a flow ended; the value says what to do."""

    DONE = "the end was reached"
    NOT_CONVERGED = "the stages of an interval were not found; use more intervals"
    SINGULAR = "the stages of an interval are not determined; use more intervals"
    NOT_FINITE = "the stages of an interval grew beyond all bounds; use more intervals"


class Scheme:
    """What all intervals of a flow have in common."""

    def __init__(self, equations: Equations, method: Radau, h: float) -> None:
        self.equations, self.h = equations, h
        self.moving = np.asarray(equations.differential, dtype=bool)
        self.rates = method.differentiation / h
        self._ahead = interpolation(method.grid, 1.0 + method.nodes)
        self._ahead_of_multipliers = interpolation(method.nodes, 1.0 + method.nodes)

    def velocities(self, y: Array, stages: Array) -> Array:
        """Return W (s, n) for a start y (n,) and stages (s, n)."""
        return np.where(self.moving, self.rates @ np.vstack([y, stages]), 0.0)

    def extrapolate(self, y: Array, stages: Array) -> Array:
        """Return the polynomial of an interval at the stages of the next one, shape (s, n)."""
        positions = self._ahead @ np.vstack([y, stages])
        return np.where(self.moving, positions, self._ahead_of_multipliers @ stages)


@dataclass(frozen=True)
class Tangent:
    """The equations of an interval, linearised at stage values and factored.

    Attributes
    ----------
    stages, velocities : ndarray of shape (s, n)
        Where it was taken.
    drag : ndarray of shape (s, n, 2 e + 1)
        The bands of R, as far as they are in use.
    """

    stages: Array
    velocities: Array
    drag: Array
    _factors: Array
    _pivots: Array
    _reach: int  # half-bandwidth of the matrix

    @classmethod
    def at(cls, scheme: Scheme, y: Array, stages: Array) -> Self | None:
        """Return it for a start y (n,) at stages (s, n); None if the matrix is singular."""
        velocities = scheme.velocities(y, stages)
        pairs = zip(stages, velocities, strict=True)
        slopes, drags = zip(*(scheme.equations.parts(*pair, 0.0) for pair in pairs), strict=True)
        drag = _trimmed(np.stack(drags))
        matrix, reach = _stage_matrix(_trimmed(np.stack(slopes)), drag, scheme.rates[:, 1:])
        factors, pivots, failed = dgbtrf(matrix, reach, reach, overwrite_ab=1)
        return None if failed else cls(stages, velocities, drag, factors, pivots, reach)

    def solve(self, right: Array) -> Array:
        """Return changes of the stages (c, n, s) for right-hand sides (c, n, s), overwritten."""
        flat = right.reshape(right.shape[0], -1).T
        answer, _ = dgbtrs(
            self._factors, self._reach, self._reach, flat, self._pivots, overwrite_b=1
        )
        return np.asarray(answer.T.reshape(right.shape))


def _trimmed(bands: Array) -> Array:
    """Return bands (s, n, 2 b + 1) without outer diagonals that are all zero."""
    half = bands.shape[2] // 2
    used = np.flatnonzero(np.any(bands, axis=(0, 1)))
    reach = int(np.abs(used - half).max()) if used.size else 0
    return bands[:, :, half - reach : half + reach + 1]


def _stage_matrix(slopes: Array, drag: Array, rates: Array) -> tuple[Array, int]:
    """Return the matrix in LAPACK's band storage, with room for its factors, and its bandwidth.

    The entry of row i s + p and column (i + o) s + q lies p - q - o s below the diagonal. In
    memory, columns one after the other, its place is linear in p, q, i and o: the whole matrix is
    filled through one strided view. Columns beyond both ends take what sticks out.
    """
    s, n, _ = slopes.shape
    wide, narrow = slopes.shape[2] // 2, drag.shape[2] // 2
    beyond = max(wide, narrow)
    reach = max(wide * s, narrow * s + s - 1)
    rows = 3 * reach + 1
    padded = np.zeros((n + 2 * beyond) * s * rows)

    def blocks(half: int) -> Array:
        """Return the view [p, q, i, half + o] of the diagonals o up to `half`."""
        first = (beyond - half) * s * rows + 2 * reach + half * s
        steps = np.array([1, rows - 1, s * rows, s * rows - s]) * padded.itemsize
        return as_strided(padded[first:], (s, s, n, 2 * half + 1), steps)

    blocks(narrow)[...] = rates[:, :, None, None] * drag[:, None]
    on_diagonal = np.einsum("ppik->pik", blocks(wide))
    on_diagonal += slopes
    inner = padded.reshape(-1, rows)[beyond * s : (beyond + n) * s]
    return inner.T, reach


@dataclass(frozen=True)
class Solved:
    """The stages (s, n) of an interval, and the last matrix of Newton's method."""

    outcome: Outcome
    stages: Array
    steps: int
    tangent: Tangent | None = None


def solve_stages(scheme: Scheme, y: Array, guess: Array) -> Solved:
    """Find the stages (s, n) of the interval that starts at y (n,), from a guess.

    Newton's method ends after a step that is small for the size of the positions; multipliers that
    are not within round-off yet get one more.
    """
    stages, settled = guess, False
    for steps in range(1, _MOST_STEPS + 1):
        tangent = Tangent.at(scheme, y, stages)
        if tangent is None:
            return Solved(Outcome.SINGULAR, stages, steps)
        pairs = zip(stages, tangent.velocities, strict=True)
        wrong = np.stack([scheme.equations.residual(*pair) for pair in pairs], axis=1)
        step = -tangent.solve(wrong[None])[0].T
        if not np.isfinite(step).all():
            return Solved(Outcome.NOT_FINITE, stages, steps)
        stages = stages + step
        small = _small(step, stages, scheme.moving, _SMALL_STEP)
        if small and (settled or _small(step, stages, ~scheme.moving, _SMALL_STEP_OF_MULTIPLIERS)):
            return Solved(Outcome.DONE, stages, steps, tangent)
        settled = small
    return Solved(Outcome.NOT_CONVERGED, stages, _MOST_STEPS)


def _small(step: Array, value: Array, part: Array, limit: float) -> bool:
    """Tell whether a step is small for the largest value of a part of the unknowns."""
    size = np.abs(value[:, part]).max(initial=0.0)
    return bool(np.abs(step[:, part]).max(initial=0.0) <= limit * size)
