"""The flow of a constrained system over a given time, with its exact linearisation.

The time is divided into equal intervals (`undula.numerics.orbits.collocation`). The flow depends on
the positions of the start only. Sensitivities are exact derivatives of the discrete flow, not a
discretisation of the variational equations.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from undula.arrays import Array
from undula.numerics.continuation.problem import Equations
from undula.numerics.orbits.collocation import (
    Linearisation,
    Outcome,
    Scheme,
    StageSolution,
    solve_stages,
)
from undula.numerics.orbits.radau import Radau, interpolation, radau

#: The derivative of a residual by a parameter, as a function of y (n,) and w (n,).
ByParameter = Callable[[Array, Array], Array]

#: Three stages, order 5, and five stages, order 9.
RADAU_5, RADAU_9 = radau(3), radau(5)

# Number of parts into which an interval is divided whose stages are not found, and number of
# recursive divisions.
_SUBINTERVALS, _MAX_SUBDIVISIONS = 4, 3


@dataclass(frozen=True)
class Sensitivities:
    """Derivatives of the end of a flow.

    Attributes
    ----------
    by_start : ndarray of shape (n, k)
        By the amplitudes of k small displacements of the start.
    by_duration : ndarray of shape (n,)
        By the duration: the velocity at the end, with the order of the positions.
    by_parameters : ndarray of shape (n, q)
        By q parameters.
    """

    by_start: Array
    by_duration: Array
    by_parameters: Array


@dataclass(frozen=True)
class Flow:
    """The end and the stages of a flow.

    Attributes
    ----------
    outcome : Outcome
        If it is not DONE, the end is NaN.
    end : ndarray of shape (n,)
        Positions and multipliers at the end.
    stages : ndarray of shape (intervals, s, n)
        All stage values.
    steps : int
        Total number of Newton steps.
    sensitivities : Sensitivities or None
        None if they were not requested, or the end was not reached.
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
    """Integrate a system from y0 over a given time.

    Parameters
    ----------
    equations : Equations
        The differential equation.
    y0 : ndarray of shape (n,)
        The start; its multipliers serve as a guess only.
    duration : float
        The time, above 0.
    intervals : int
        Number of equal intervals, at least 1.
    columns : ndarray of shape (n, k), optional
        Displacements of the start for which the end is differentiated; their multipliers do not
        matter. Without it no sensitivities are computed.
    parameters : sequence of functions
        Derivatives of the residual by the parameters for which the end is differentiated.
    guess : ndarray of shape (intervals, s, n), optional
        Guess of the stage values, such as those of a neighbouring flow. By default it is the
        extrapolated polynomial of the interval before. Where Newton's method fails from a guess,
        a better one is computed on shorter intervals.
    method : Radau
        The collocation method.

    Returns
    -------
    Flow
        A failure is an outcome, not an exception.
    """
    scheme = Scheme(equations, method, duration / intervals)
    stages = np.full((intervals, method.stages, y0.size), np.nan)
    propagation = None if columns is None else _Propagation(columns, intervals, parameters)
    y, extrapolated, steps = y0, np.tile(y0, (method.stages, 1)), 0
    for k in range(intervals):
        # Newton's method detects its divergence by itself.
        with np.errstate(over="ignore", invalid="ignore"):
            solved = _solve_interval(
                scheme, method, y, extrapolated if guess is None else guess[k], _MAX_SUBDIVISIONS
            )
        steps += solved.steps
        if solved.linearisation is None:
            return Flow(solved.outcome, np.full(y0.size, np.nan), stages, steps, None)
        if propagation is not None:
            propagation.propagate(scheme, solved.linearisation)
        stages[k], extrapolated = solved.stages, scheme.extrapolate(y, solved.stages)
        y = stages[k, -1]
    return Flow(Outcome.DONE, y, stages, steps, propagation.sensitivities if propagation else None)


def linearised_flow(
    equations: Equations,
    y0: Array,
    stages: Array,
    duration: float,
    columns: Array,
    parameters: Sequence[ByParameter] = (),
    method: Radau = RADAU_5,
) -> Sensitivities | None:
    """Linearise a flow along given stage values.

    Parameters
    ----------
    equations, y0, duration, columns, parameters, method
        As for `flow`.
    stages : ndarray of shape (intervals, s, n)
        The stage values, for example of a motion computed with smaller equations.

    Returns
    -------
    Sensitivities or None
        None where a matrix is singular.
    """
    scheme = Scheme(equations, method, duration / stages.shape[0])
    propagation = _Propagation(columns, stages.shape[0], parameters)
    y = y0
    for values in stages:
        linearisation = Linearisation.at(scheme, y, values)
        if linearisation is None:
            return None
        propagation.propagate(scheme, linearisation)
        y = values[-1]
    return propagation.sensitivities


def resampled(
    y0: Array, stages: Array, intervals: int, differential: Array, method: Radau = RADAU_5
) -> Array:
    """Return the stage values of a flow on another number of intervals, by interpolation.

    Parameters
    ----------
    y0 : ndarray of shape (n,)
        The start.
    stages : ndarray of shape (m, s, n)
        Stage values on m intervals.
    intervals : int
        The new number of intervals.
    differential : ndarray of bool, shape (n,)
        False for multipliers, which have no value at the start of an interval: their polynomial
        interpolates the stages only.
    method : Radau
        The collocation method.

    Returns
    -------
    ndarray of shape (intervals, s, n)
        The interpolated stage values.
    """
    times = method.times(intervals).ravel() * stages.shape[0]
    # A common end of two intervals belongs to the first.
    interval = np.clip(np.ceil(times).astype(int) - 1, 0, stages.shape[0] - 1)
    starts = np.concatenate([y0[None], stages[:-1, -1]])
    whole = np.concatenate([starts[:, None], stages], axis=1)

    def along(grid: Array, values: Array) -> Array:
        return np.asarray(
            np.einsum("tj,tjn->tn", interpolation(grid, times - interval), values[interval])
        )

    values_at_nodes = np.where(differential, along(method.grid, whole), along(method.nodes, stages))
    return values_at_nodes.reshape(intervals, *stages.shape[1:])


def _solve_interval(
    scheme: Scheme, method: Radau, y: Array, guess: Array, subdivisions: int
) -> StageSolution:
    """Solve for the stages of an interval, on shorter intervals first if the guess fails."""
    solved = solve_stages(scheme, y, guess)
    if solved.outcome is Outcome.DONE or subdivisions == 0:
        return solved
    shorter = Scheme(scheme.equations, method, scheme.h / _SUBINTERVALS)
    stages, start, extrapolated = [], y, np.tile(y, (method.stages, 1))
    for _ in range(_SUBINTERVALS):
        part = _solve_interval(shorter, method, start, extrapolated, subdivisions - 1)
        if part.outcome is not Outcome.DONE:
            return solved
        stages.append(part.stages)
        start, extrapolated = part.stages[-1], shorter.extrapolate(start, part.stages)
    refined_guess = resampled(y, np.stack(stages), 1, scheme.moving, method)[0]
    return solve_stages(scheme, y, refined_guess)


class _Propagation:
    """Changes of the state by displacements of the start, by duration and by parameters."""

    def __init__(self, columns: Array, intervals: int, parameters: Sequence[ByParameter]) -> None:
        self._starts, self._intervals, self._parameters = columns.shape[1], intervals, parameters
        self._changes = np.zeros((self._starts + 1 + len(parameters), columns.shape[0]))
        self._changes[: self._starts] = columns.T

    def propagate(self, scheme: Scheme, linearisation: Linearisation) -> None:
        """Propagate the changes through an interval."""
        stages, velocities = linearisation.stages, linearisation.velocities
        (s, n), half = stages.shape, linearisation.drag.shape[2] // 2
        right = np.zeros((self._changes.shape[0], n, s))
        moving = np.where(scheme.moving, self._changes, 0.0)
        # A longer duration reduces all velocities by the same factor.
        velocity_change = velocities / (scheme.h * self._intervals)
        for offset in range(-half, half + 1):
            rows = slice(max(0, -offset), n - max(0, offset))
            others = slice(max(0, offset), n + min(0, offset))
            drag = linearisation.drag[:, rows, half + offset]
            right[:, rows] -= moving[:, others, None] * (scheme.rates[:, :1] * drag).T
            right[self._starts, rows] += (drag * velocity_change[:, others]).T
        for j, by_parameter in enumerate(self._parameters, self._starts + 1):
            for i in range(s):
                right[j, :, i] -= by_parameter(stages[i], velocities[i])
        self._changes = linearisation.solve(right)[:, :, -1]

    @property
    def sensitivities(self) -> Sensitivities:
        """The changes as a record."""
        k = self._starts
        return Sensitivities(self._changes[:k].T, self._changes[k], self._changes[k + 1 :].T)
