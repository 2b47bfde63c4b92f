"""A flow from where an orbit may start, brought back by its symmetry, with its linearisation.

Where an orbit starts and how long it takes is one vector, u = (x, T[, angle]): positions, the time
after which the motion repeats itself up to a symmetry, and the angle by which it has turned then,
where the symmetry contains a rotation. A flow starts from positions that satisfy the constraints,
next to x: then none of it depends on displacements of x that leave them, to first order.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from undula.arrays import Array
from undula.errors import InputError
from undula.numerics.continuation.problem import Equations
from undula.numerics.linalg.banded import to_dense
from undula.numerics.orbits.collocation import Outcome
from undula.numerics.orbits.flow import RADAU_5, ByParameter, Flow, flow
from undula.numerics.orbits.radau import Radau
from undula.numerics.orbits.symmetry import OrbitSymmetry

# Newton's method for the constraints ends after a step that leaves round-off; none takes so many.
_SMALL_STEP, _MOST_STEPS = 1e-9, 10
# A central difference by the parameter loses the square of this part of it, and round-off over it.
_PART = float(np.finfo(float).eps ** (1.0 / 3.0))


@dataclass(frozen=True)
class Shot:
    """A flow from where an orbit may start.

    Attributes
    ----------
    y : ndarray of shape (n,)
        The start, which satisfies the constraints; its multipliers are 0.
    moving : ndarray of bool, shape (n,)
        Where positions are.
    duration, angle : float
        The time T, and the angle by which the motion has turned, 0 without a rotation.
    flow : Flow
    basis : ndarray of shape (n, k)
        Orthonormal displacements B of the start that the constraints allow.
    end : ndarray of shape (n,)
        The end brought back, Q y(T).
    returned : ndarray of shape (n, k)
        What the displacements have become, brought back: Q M.
    velocity : ndarray of shape (n,)
        The velocity at the end, brought back.
    turning : ndarray of shape (n,)
        S y, the velocity of a unit rate of turning at the start; 0 without a rotation.
    by_parameter : ndarray of shape (n,)
        The derivative of the end by the parameter, brought back.
    by_angle : ndarray of shape (n,)
        The derivative of the end, brought back, by the angle; 0 without a rotation.
    """

    y: Array
    moving: Array
    duration: float
    angle: float
    flow: Flow
    basis: Array
    end: Array
    returned: Array
    velocity: Array
    turning: Array
    by_parameter: Array
    by_angle: Array

    @property
    def monodromy(self) -> Array:
        """What becomes of displacements in the basis: B' Q M, shape (k, k)."""
        return np.asarray(self.basis.T @ self.returned)

    @property
    def extent(self) -> float:
        """The largest change of a position in the course of the flow."""
        away = np.abs(self.flow.stages - self.y)
        return float(away[:, :, self.moving].max())


@dataclass(frozen=True)
class Shooting:
    """How to shoot.

    Attributes
    ----------
    equations_at : function of a parameter
        Returns the equations; their unknowns have the same layout at all parameters.
    closure : Closure
        The symmetry that brings the end back.
    intervals : int
        Equal steps that T is cut into.
    method : Radau
    """

    equations_at: Callable[[float], Equations]
    closure: OrbitSymmetry
    intervals: int
    method: Radau = RADAU_5

    @property
    def turns(self) -> bool:
        """Whether the angle is among the unknowns."""
        return self.closure.rotation is not None

    def shoot(self, u: Array, p: float, guess: Array | None = None) -> Shot | Outcome:
        """Return the shot of u = (x, T[, angle]) at a parameter; how the flow failed if it did.

        Stage values (intervals, s, n) of a neighbouring flow can be given as a first guess.
        """
        equations = self.equations_at(p)
        moving = np.asarray(equations.differential, dtype=bool)
        x, duration, angle = self.parted(u)
        if not (np.isfinite(u).all() and duration > 0.0):
            return Outcome.NOT_FINITE
        y = np.zeros(moving.size)
        y[moving] = x
        y = admissible(equations, y)
        basis = equations.displacements(y)
        parameters = [_difference(self.equations_at, p)]
        came = flow(equations, y, duration, self.intervals, basis, parameters, guess, self.method)
        change, closure = came.sensitivities, self.closure
        if change is None:
            return came.outcome
        return Shot(
            y=y,
            moving=moving,
            duration=duration,
            angle=angle,
            flow=came,
            basis=basis,
            end=closure.apply(came.end, angle),
            returned=closure.apply(change.by_start, angle),
            velocity=closure.apply(change.by_duration, angle),
            turning=closure.turning(y),
            by_parameter=closure.apply(change.by_parameters[:, 0], angle),
            by_angle=closure.by_angle(came.end, angle),
        )

    def parted(self, u: Array) -> tuple[Array, float, float]:
        """Return positions, duration and angle of u."""
        if self.turns:
            return u[:-2], float(u[-2]), float(u[-1])
        return u[:-1], float(u[-1]), 0.0


def admissible(equations: Equations, y: Array) -> Array:
    """Return y (n,) with its positions moved, by about the least, to satisfy their constraints.

    Constraints that involve multipliers are satisfied by these.
    """
    moving, still = np.asarray(equations.differential, dtype=bool), np.zeros(y.size)
    for _ in range(_MOST_STEPS):
        violation = equations.residual(y, still)[~moving]
        slopes = to_dense(equations.parts(y, still, 0.0)[0])[~moving]
        alone = ~slopes[:, ~moving].any(axis=1)
        if not (alone.any() and np.isfinite(violation).all() and np.isfinite(slopes).all()):
            return y
        step = np.linalg.lstsq(slopes[alone][:, moving], -violation[alone])[0]
        y = y.copy()
        y[moving] += step
        if np.abs(step).max() <= _SMALL_STEP * np.abs(y[moving]).max():
            return y
    return y


def _difference(equations_at: Callable[[float], Equations], p: float) -> ByParameter:
    """Return the derivative of the residual by the parameter, by a central difference.

    At an end of the parameter's range the difference is one-sided, and good to fewer digits.
    """
    delta = _PART * (abs(p) or 1.0)
    (less, low), (more, high) = (_beside(equations_at, p, side * delta) for side in (-1.0, 1.0))

    def by_parameter(y: Array, w: Array) -> Array:
        return (more.residual(y, w) - less.residual(y, w)) / (high - low)

    return by_parameter


def _beside(
    equations_at: Callable[[float], Equations], p: float, away: float
) -> tuple[Equations, float]:
    """Return the equations beside a parameter, or at it if they are not defined there."""
    try:
        return equations_at(p + away), p + away
    except InputError:
        return equations_at(p), p
