"""Periodic orbits, exact or up to a symmetry, by single shooting.

An orbit u = (x, T[, angle]) with the symmetry Q (`undula.numerics.orbits.symmetry`) solves

    Q x(T) - x = 0,    <v_ref, x - x_ref> = 0,    <S x_ref, x - x_ref> = 0.

The last two are phase conditions, with the velocity v_ref at a reference x_ref, such as an orbit
computed before. They select one point of the orbit, and one of the orbits that differ by a
rotation.

The flow starts from the projection of x onto the constraints (`undula.numerics.orbits.shooting`)
and is linearised for the displacements B that they allow there: the derivative of Q x(T) - x is
taken as Q M B' - 1, with the sensitivities M (n, k). The neglected terms are of the order of the
constraint violation of x, which is the square of Newton's last step: convergence stays quadratic.

Source: Keller (1968), Numerical Methods for Two-Point Boundary-Value Problems; for the phase
conditions Doedel, Keller & Kernevez (1991), Int. J. Bifurcation Chaos 1, 745.
"""

import math
from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np

from undula.arrays import Array
from undula.numerics.continuation.newton import Solution, newton
from undula.numerics.continuation.problem import DenseLinear, Evaluation
from undula.numerics.orbits.collocation import Outcome
from undula.numerics.orbits.flow import resampled
from undula.numerics.orbits.shooting import Shooting, Shot

# Relative extent below which an orbit is an equilibrium. Near an equilibrium the residual is of
# second order, so that Newton's method ends at a distance of about the square root of round-off.
_REST_TOLERANCE = 1e-7


@dataclass
class LastShot:
    """The last shot that succeeded, whose stages are the guess of the next shot."""

    shot: Shot | None = None


@dataclass(frozen=True)
class Reference:
    """The reference of the phase conditions.

    Attributes
    ----------
    x, velocity, turning : ndarray of shape (k,)
        Positions at the start of a motion near the orbit, their velocity, and S x.
    duration : float
        Its time T, above 0.
    """

    x: Array
    velocity: Array
    turning: Array
    duration: float

    @classmethod
    def of(cls, shot: Shot) -> Self:
        """Return the start of a shot as a reference."""
        moving = shot.moving
        return cls(shot.y[moving], shot.velocity[moving], shot.turning[moving], shot.duration)


@dataclass(frozen=True)
class OrbitProblem:
    """Equations of an orbit: a `continuation.problem.Problem` in u = (x, T[, angle]).

    Its residual is NaN where the flow fails.

    Attributes
    ----------
    shooting : Shooting
        Settings of the flow.
    reference : Reference
        Reference of the phase conditions.
    last : LastShot
        Changed by each evaluation.
    """

    shooting: Shooting
    reference: Reference
    last: LastShot = field(default_factory=LastShot)

    @property
    def weights(self) -> Array:
        """Weights (m,) for the mean square of positions, T in units of the reference's, radians."""
        count = self.reference.x.size
        last = [self.reference.duration**-2] + [1.0] * self.shooting.has_rotation
        return np.append(np.full(count, 1.0 / count), last)

    def shoot(self, u: Array, p: float) -> Shot | Outcome:
        """Return the shot of u (m,), with the stages of the last successful shot as guess."""
        last = self.last.shot
        shot = self.shooting.shoot(u, p, None if last is None else last.flow.stages)
        if isinstance(shot, Shot):
            self.last.shot = shot
        return shot

    def with_reference(self, u: Array) -> Self:
        """Return the problem with the solution u (m,), near its last evaluation, as reference."""
        last = self.last.shot
        reference = self.reference if last is None else Reference.of(last)
        x, duration, _ = self.shooting.split(u)
        return replace(self, reference=replace(reference, x=x, duration=duration))

    def evaluate(self, u: Array, p: float) -> Evaluation:
        """Return residual and derivatives at u (m,) and a parameter."""
        shot = self.shoot(u, p)
        if isinstance(shot, Outcome):
            undefined = np.full(u.size, np.nan)
            return Evaluation(undefined, DenseLinear(np.full((u.size, u.size), np.nan)), undefined)
        moving, count = shot.moving, self.reference.x.size
        rows = self._phase_rows()
        residual, by_parameter, matrix = np.zeros(u.size), np.zeros(u.size), np.zeros((u.size,) * 2)
        residual[:count] = shot.end[moving] - u[:count]
        residual[count:] = rows @ (u[:count] - self.reference.x)
        by_parameter[:count] = shot.by_parameter[moving]
        matrix[:count, :count] = shot.returned[moving] @ shot.basis[moving].T - np.eye(count)
        matrix[:count, count] = shot.velocity[moving]
        if self.shooting.has_rotation:
            matrix[:count, count + 1] = shot.by_angle[moving]
        matrix[count:, :count] = rows
        return Evaluation(residual, DenseLinear(matrix), by_parameter)

    def _phase_rows(self) -> Array:
        """Return the unit directions in which the start must not differ from the reference.

        A direction that vanishes leaves the linearised problem singular.
        """
        rows = [self.reference.velocity] + [self.reference.turning] * self.shooting.has_rotation
        return np.stack([row / (np.linalg.norm(row) or 1.0) for row in rows])


@dataclass(frozen=True)
class Orbit:
    """A periodic orbit, exact or up to a symmetry.

    Attributes
    ----------
    u : ndarray of shape (m,)
        Positions at the start, T[, angle].
    p : float
        The parameter.
    shot : Shot
        The motion along it, with its linearisation.
    problem : OrbitProblem
        Its equations with itself as reference, for continuation.
    """

    u: Array
    p: float
    shot: Shot
    problem: OrbitProblem


@dataclass(frozen=True)
class Search:
    """The outcome of a search for an orbit.

    Attributes
    ----------
    orbit : Orbit or None
        The orbit; None if the search failed.
    advice : str
        Outcome and, for a failure, the cure, in one sentence.
    solution : Solution or None
        Result of Newton's method; None if it could not begin.
    """

    orbit: Orbit | None
    advice: str
    solution: Solution | None = None


def find_orbit(
    shooting: Shooting,
    u: Array,
    p: float,
    stages: Array | None = None,
) -> Search:
    """Find the periodic orbit near a guess.

    Parameters
    ----------
    shooting : Shooting
        Settings of the flow.
    u : ndarray of shape (m,)
        Guess of the positions at the start, the time T, and the angle with a rotation.
    p : float
        The parameter.
    stages : ndarray of shape (intervals, s, n), optional
        Guess of the stage values of the motion.

    Returns
    -------
    Search
        A failure is an outcome with advice, not an exception.
    """
    first = shooting.shoot(u, p, stages)
    if isinstance(first, Outcome):
        return Search(None, f"the motion from the guess could not be followed: {first.value}")
    if not _moves(first):
        return Search(None, "the guess is an equilibrium; begin from a motion")
    problem = OrbitProblem(shooting, Reference.of(first), LastShot(first))
    solution = newton(problem, u, p)
    orbit = orbit_at(problem, solution.u, p) if solution.has_converged else None
    if orbit is None:
        return Search(None, solution.outcome.value, solution)
    if not _moves(orbit.shot):
        return Search(None, "an equilibrium was found; begin nearer to the orbit", solution)
    return Search(orbit, solution.outcome.value, solution)


def orbit_at(problem: OrbitProblem, u: Array, p: float) -> Orbit | None:
    """Return the orbit of a solution.

    Parameters
    ----------
    problem : OrbitProblem
        Its equations.
    u : ndarray of shape (m,)
        The solution.
    p : float
        The parameter.

    Returns
    -------
    Orbit or None
        None if the flow fails.
    """
    shot = problem.shoot(u, p)
    return Orbit(u, p, shot, problem.with_reference(u)) if isinstance(shot, Shot) else None


def with_shorter_steps(orbit: Orbit) -> Orbit | None:
    """Return the same orbit with 1.5 times as many intervals; None if the search fails."""
    shooting, shot = orbit.problem.shooting, orbit.shot
    finer = replace(shooting, intervals=math.ceil(1.5 * shooting.intervals))
    stages = resampled(shot.y, shot.flow.stages, finer.intervals, shot.moving, shooting.method)
    return find_orbit(finer, orbit.u, orbit.p, stages).orbit


def time_error(orbit: Orbit) -> float:
    """Return the error of T, from the same orbit on shorter intervals; NaN if that search fails."""
    finer_orbit = with_shorter_steps(orbit)
    return math.nan if finer_orbit is None else abs(finer_orbit.shot.duration - orbit.shot.duration)


def _moves(shot: Shot) -> bool:
    return shot.extent > _REST_TOLERANCE * float(np.abs(shot.y[shot.moving]).max())
