"""The flow of a constrained system over a given time, with its exact linearisation.

The time is cut into equal intervals (`undula.numerics.orbits.collocation`). Only the positions of a
start matter. Sensitivities are exact derivatives of the discrete flow, not a discretisation of the
derivative's equations.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from undula.arrays import Array
from undula.numerics.continuation.problem import Equations
from undula.numerics.orbits.collocation import Outcome, Scheme, Solved, Tangent, solve_stages
from undula.numerics.orbits.radau import Radau, interpolation, radau

#: The derivative of a residual by a parameter, as a function of y (n,) and w (n,).
ByParameter = Callable[[Array, Array], Array]

#: Three stages, order 5, and five stages, order 9.
RADAU_5, RADAU_9 = radau(3), radau(5)

# An interval whose stages are not found is gone through in so many parts, which are cut themselves
# if need be, so often.
_PARTS, _CUTS = 4, 3


@dataclass(frozen=True)
class Sensitivities:
    """Derivatives of the end of a flow by what it depends on.

    Attributes
    ----------
    by_start : ndarray of shape (n, k)
        By the amplitudes of k small displacements of the start.
    by_duration : ndarray of shape (n,)
        By the duration: the velocity at the end, to the order of the positions themselves.
    by_parameters : ndarray of shape (n, q)
        By parameters.
    """

    by_start: Array
    by_duration: Array
    by_parameters: Array


@dataclass(frozen=True)
class Flow:
    """The end of a flow, and the way there.

    Attributes
    ----------
    outcome : Outcome
        If it is not DONE the end is not a number.
    end : ndarray of shape (n,)
        Positions and multipliers at the end.
    stages : ndarray of shape (intervals, s, n)
        All stage values.
    steps : int
        Steps of Newton's method in all.
    sensitivities : Sensitivities or None
        None if none were asked for, or the end was not reached.
    """

    outcome: Outcome
    end: Array
    stages: Array
    steps: int
    sensitivities: Sensitivities | None


def flow(
    equations: Equations,
    y0: Array,
    duration: float,
    intervals: int,
    columns: Array | None = None,
    parameters: Sequence[ByParameter] = (),
    guess: Array | None = None,
    method: Radau = RADAU_5,
) -> Flow:
    """Follow a system from y0 over some time.

    Parameters
    ----------
    equations : Equations
    y0 : ndarray of shape (n,)
        The start; its multipliers only serve as a first guess.
    duration : float
        The time, > 0.
    intervals : int
        Number of equal steps.
    columns : ndarray of shape (n, k), optional
        Displacements of the start that the end is to be differentiated by; their multipliers do
        not matter. Without it there are no sensitivities.
    parameters : sequence of functions
        Derivatives of the residual by parameters that the end is to be differentiated by.
    guess : ndarray of shape (intervals, s, n), optional
        Stage values to begin with, such as those of a neighbouring flow. Without it each interval
        begins with the extrapolated polynomial of the one before. Where Newton's method fails
        from these, shorter intervals show where to begin.
    method : Radau

    Returns
    -------
    Flow
        A failure is an outcome, not an exception.
    """
    scheme = Scheme(equations, method, duration / intervals)
    stages = np.full((intervals, method.stages, y0.size), np.nan)
    carried = None if columns is None else _Carried(columns, intervals, parameters)
    y, ahead, steps = y0, np.tile(y0, (method.stages, 1)), 0
    for k in range(intervals):
        # Newton's method notices for itself that it has lost its way.
        with np.errstate(over="ignore", invalid="ignore"):
            solved = _found(scheme, method, y, ahead if guess is None else guess[k], _CUTS)
        steps += solved.steps
        if solved.tangent is None:
            return Flow(solved.outcome, np.full(y0.size, np.nan), stages, steps, None)
        if carried is not None:
            carried.through(scheme, solved.tangent)
        stages[k], ahead = solved.stages, scheme.extrapolate(y, solved.stages)
        y = stages[k, -1]
    return Flow(Outcome.DONE, y, stages, steps, carried.sensitivities if carried else None)


def linearised_flow(
    equations: Equations,
    y0: Array,
    stages: Array,
    duration: float,
    columns: Array,
    parameters: Sequence[ByParameter] = (),
    method: Radau = RADAU_5,
) -> Sensitivities | None:
    """Linearise a flow along known stage values (intervals, s, n), without solving for any.

    The stages may be those of a motion found with other, smaller equations. Returns None where a
    matrix is singular. For the rest see `flow`.
    """
    scheme = Scheme(equations, method, duration / stages.shape[0])
    carried = _Carried(columns, stages.shape[0], parameters)
    y = y0
    for values in stages:
        tangent = Tangent.at(scheme, y, values)
        if tangent is None:
            return None
        carried.through(scheme, tangent)
        y = values[-1]
    return carried.sensitivities


def resampled(
    y0: Array, stages: Array, intervals: int, differential: Array, method: Radau = RADAU_5
) -> Array:
    """Return stage values (intervals, s, n) on other intervals, from the stage polynomials.

    Multipliers (where `differential` (n,) is False) have no value at the start of an interval:
    their polynomial goes through the stages alone.
    """
    times = method.times(intervals).ravel() * stages.shape[0]
    # A time between two intervals is the end of the first.
    place = np.clip(np.ceil(times).astype(int) - 1, 0, stages.shape[0] - 1)
    starts = np.concatenate([y0[None], stages[:-1, -1]])
    whole = np.concatenate([starts[:, None], stages], axis=1)

    def along(grid: Array, values: Array) -> Array:
        return np.asarray(
            np.einsum("tj,tjn->tn", interpolation(grid, times - place), values[place])
        )

    found = np.where(differential, along(method.grid, whole), along(method.nodes, stages))
    return found.reshape(intervals, *stages.shape[1:])


def _found(scheme: Scheme, method: Radau, y: Array, guess: Array, cuts: int) -> Solved:
    """Return the stages of an interval, found from those of shorter ones if the guess fails."""
    solved = solve_stages(scheme, y, guess)
    if solved.outcome is Outcome.DONE or cuts == 0:
        return solved
    shorter = Scheme(scheme.equations, method, scheme.h / _PARTS)
    stages, start, ahead = [], y, np.tile(y, (method.stages, 1))
    for _ in range(_PARTS):
        part = _found(shorter, method, start, ahead, cuts - 1)
        if part.outcome is not Outcome.DONE:
            return solved
        stages.append(part.stages)
        start, ahead = part.stages[-1], shorter.extrapolate(start, part.stages)
    better = resampled(y, np.stack(stages), 1, scheme.moving, method)[0]
    return solve_stages(scheme, y, better)


class _Carried:
    """Changes of the state so far: by the displacements of the start, duration, parameters."""

    def __init__(self, columns: Array, intervals: int, parameters: Sequence[ByParameter]) -> None:
        self._starts, self._intervals, self._parameters = columns.shape[1], intervals, parameters
        self._changes = np.zeros((self._starts + 1 + len(parameters), columns.shape[0]))
        self._changes[: self._starts] = columns.T

    def through(self, scheme: Scheme, tangent: Tangent) -> None:
        """Carry the changes through an interval."""
        stages, velocities = tangent.stages, tangent.velocities
        (s, n), half = stages.shape, tangent.drag.shape[2] // 2
        right = np.zeros((self._changes.shape[0], n, s))
        moving = np.where(scheme.moving, self._changes, 0.0)
        # A longer duration makes all velocities smaller by the same part.
        slower = velocities / (scheme.h * self._intervals)
        for offset in range(-half, half + 1):
            rows = slice(max(0, -offset), n - max(0, offset))
            others = slice(max(0, offset), n + min(0, offset))
            drag = tangent.drag[:, rows, half + offset]
            right[:, rows] -= moving[:, others, None] * (scheme.rates[:, :1] * drag).T
            right[self._starts, rows] += (drag * slower[:, others]).T
        for j, by_parameter in enumerate(self._parameters, self._starts + 1):
            for i in range(s):
                right[j, :, i] -= by_parameter(stages[i], velocities[i])
        self._changes = tangent.solve(right)[:, :, -1]

    @property
    def sensitivities(self) -> Sensitivities:
        """The changes as a record."""
        k = self._starts
        return Sensitivities(self._changes[:k].T, self._changes[k], self._changes[k + 1 :].T)
