"""Shooting: a flow from the start of an orbit, mapped back by its symmetry, with linearisation.

The unknowns of an orbit are one vector, u = (x, T[, angle]): positions at the start, the time after
which the motion repeats itself up to a symmetry, and the angle of its rotation in that time, where
the symmetry contains a rotation. The flow starts from positions next to x that satisfy the
constraints: to first order it does not depend on displacements of x that violate them.
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

# Newton's method for the constraints: relative step that leaves only round-off, and a number of
# steps that is never reached.
_STEP_TOLERANCE, _MAX_STEPS = 1e-9, 10
# Relative change of the parameter in a central difference: its truncation error is the square of
# this, its round-off error that of the residual over this.
_RELATIVE_DIFFERENCE = float(np.finfo(float).eps ** (1.0 / 3.0))


@dataclass(frozen=True)
class Shot:
    """A flow from a start, mapped back by the symmetry Q of the orbit.

    Attributes
    ----------
    y : ndarray of shape (n,)
        The start, which satisfies the constraints; its multipliers are 0.
    moving : ndarray of bool, shape (n,)
        True for positions.
    duration, angle : float
        The time T, and the angle of rotation [rad], 0 without a rotation.
    flow : Flow
        The flow over T.
    basis : ndarray of shape (n, k)
        Orthonormal displacements B of the start that the constraints allow.
    end : ndarray of shape (n,)
        The end Q y(T).
    returned : ndarray of shape (n, k)
        The displacements at the end, Q M.
    velocity : ndarray of shape (n,)
        The velocity at the end, mapped by Q.
    turning : ndarray of shape (n,)
        S y, the velocity of a unit rate of rotation at the start; 0 without a rotation.
    by_parameter : ndarray of shape (n,)
        The derivative of Q y(T) by the parameter.
    by_angle : ndarray of shape (n,)
        The derivative of Q y(T) by the angle; 0 without a rotation.
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
        """The monodromy matrix in the basis, B' Q M, shape (k, k)."""
        return np.asarray(self.basis.T @ self.returned)

    @property
    def extent(self) -> float:
        """The largest change of a position along the flow."""
        distance = np.abs(self.flow.stages - self.y)
        return float(distance[:, :, self.moving].max())


@dataclass(frozen=True)
class Shooting:
    """Settings of shooting.

    Attributes
    ----------
    equations_at : function of a parameter
        Returns the equations; their unknowns have the same layout at all parameters.
    symmetry : OrbitSymmetry
        The symmetry Q that maps the end back to the start.
    intervals : int
        Number of equal intervals of T.
    method : Radau
        The collocation method.
    """

    equations_at: Callable[[float], Equations]
    symmetry: OrbitSymmetry
    intervals: int
    method: Radau = RADAU_5

    @property
    def has_rotation(self) -> bool:
        """True if the angle is among the unknowns."""
        return self.symmetry.rotation is not None

    def shoot(self, u: Array, p: float, guess: Array | None = None) -> Shot | Outcome:
        """Compute the flow of u at a parameter.

        Parameters
        ----------
        u : ndarray of shape (m,)
            (x, T[, angle]), with T above 0.
        p : float
            The parameter.
        guess : ndarray of shape (intervals, s, n), optional
            Stage values of a neighbouring flow.

        Returns
        -------
        Shot or Outcome
            The reason of the failure if the end was not reached.
        """
        equations = self.equations_at(p)
        moving = np.asarray(equations.differential, dtype=bool)
        x, duration, angle = self.split(u)
        if not (np.isfinite(u).all() and duration > 0.0):
            return Outcome.NOT_FINITE
        y = np.zeros(moving.size)
        y[moving] = x
        y = admissible(equations, y)
        basis = equations.displacements(y)
        parameters = [_difference(self.equations_at, p)]
        motion = flow(equations, y, duration, self.intervals, basis, parameters, guess, self.method)
        sensitivities, symmetry = motion.sensitivities, self.symmetry
        if sensitivities is None:
            return motion.outcome
        return Shot(
            y=y,
            moving=moving,
            duration=duration,
            angle=angle,
            flow=motion,
            basis=basis,
            end=symmetry.apply(motion.end, angle),
            returned=symmetry.apply(sensitivities.by_start, angle),
            velocity=symmetry.apply(sensitivities.by_duration, angle),
            turning=symmetry.turning(y),
            by_parameter=symmetry.apply(sensitivities.by_parameters[:, 0], angle),
            by_angle=symmetry.by_angle(motion.end, angle),
        )

    def split(self, u: Array) -> tuple[Array, float, float]:
        """Return positions, duration and angle of u."""
        if self.has_rotation:
            return u[:-2], float(u[-2]), float(u[-1])
        return u[:-1], float(u[-1]), 0.0


def admissible(equations: Equations, y: Array) -> Array:
    """Return y with its positions projected onto their constraints.

    Constraints that involve multipliers are left out, as the multipliers satisfy them.

    Parameters
    ----------
    equations : Equations
        The differential equation.
    y : ndarray of shape (n,)
        Positions near the constraints.

    Returns
    -------
    ndarray of shape (n,)
        The projection, by Gauss-Newton steps.
    """
    moving, at_rest = np.asarray(equations.differential, dtype=bool), np.zeros(y.size)
    for _ in range(_MAX_STEPS):
        violation = equations.residual(y, at_rest)[~moving]
        slopes = to_dense(equations.parts(y, at_rest, 0.0)[0])[~moving]
        alone = ~slopes[:, ~moving].any(axis=1)
        if not (alone.any() and np.isfinite(violation).all() and np.isfinite(slopes).all()):
            return y
        step = np.linalg.lstsq(slopes[alone][:, moving], -violation[alone])[0]
        y = y.copy()
        y[moving] += step
        if np.abs(step).max() <= _STEP_TOLERANCE * np.abs(y[moving]).max():
            return y
    return y


def _difference(equations_at: Callable[[float], Equations], p: float) -> ByParameter:
    """Return the derivative of the residual by the parameter, by a central difference.

    At an end of the parameter's range the difference is one-sided, and less accurate.
    """
    delta = _RELATIVE_DIFFERENCE * (abs(p) or 1.0)
    (less, low), (more, high) = (
        _equations_near(equations_at, p, side * delta) for side in (-1.0, 1.0)
    )

    def by_parameter(y: Array, w: Array) -> Array:
        return (more.residual(y, w) - less.residual(y, w)) / (high - low)

    return by_parameter


def _equations_near(
    equations_at: Callable[[float], Equations], p: float, distance: float
) -> tuple[Equations, float]:
    """Return the equations next to a parameter, or at it if they are undefined there."""
    try:
        return equations_at(p + distance), p + distance
    except InputError:
        return equations_at(p), p
