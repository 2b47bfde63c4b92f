"""Periodic orbits, also up to a symmetry, by single shooting.

An orbit u = (x, T[, angle]) with the symmetry Q (`undula.numerics.orbits.symmetry`) solves

    Q x(T) - x = 0,    <v_ref, x - x_ref> = 0,    <S x_ref, x - x_ref> = 0.

The last two choose one point of the orbit, and one orbit of those that differ by a rotation, with
the velocity v_ref at a reference x_ref, such as an orbit found before.

The flow starts from where x satisfies the constraints (`undula.numerics.orbits.shooting`) and is
linearised along the displacements B that they allow there: the derivative of Q x(T) - x is taken as
Q M B' - 1 with M the sensitivities (n, k). What that leaves out is of the order of the violation by
x, which is that of the square of Newton's last step: the method stays quadratic.

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

# What moves less than this part of its size in the course of an orbit is an equilibrium: near one,
# the residual is the square of the distance, so that it is met to the root of round-off.
_AT_REST = 1e-7


@dataclass
class LastShot:
    """The last shot that succeeded; its stages are where the next one begins."""

    shot: Shot | None = None


@dataclass(frozen=True)
class Reference:
    """What the phase conditions refer to.

    Attributes
    ----------
    x, velocity, turning : ndarray of shape (k,)
        Positions at the start of a motion near the orbit, their velocity, and S x.
    duration : float
        Its time T, > 0.
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

    Its residual is not a number where there is no flow.

    Attributes
    ----------
    shooting : Shooting
    reference : Reference
    last : LastShot
        Changed by each evaluation.
    """

    shooting: Shooting
    reference: Reference
    last: LastShot = field(default_factory=LastShot)

    @property
    def weights(self) -> Array:
        """Weights (m,) for the mean square of positions, parts of the reference's T, radians."""
        count = self.reference.x.size
        last = [self.reference.duration**-2] + [1.0] * self.shooting.turns
        return np.append(np.full(count, 1.0 / count), last)

    def shoot(self, u: Array, p: float) -> Shot | Outcome:
        """Return the shot of u (m,), begun from the stages of the last one that succeeded."""
        last = self.last.shot
        shot = self.shooting.shoot(u, p, None if last is None else last.flow.stages)
        if isinstance(shot, Shot):
            self.last.shot = shot
        return shot

    def referred_to(self, u: Array) -> Self:
        """Return the problem with the solution u (m,) as reference, which it was evaluated near."""
        last = self.last.shot
        reference = self.reference if last is None else Reference.of(last)
        x, duration, _ = self.shooting.parted(u)
        return replace(self, reference=replace(reference, x=x, duration=duration))

    def evaluate(self, u: Array, p: float) -> Evaluation:
        """Return residual and derivatives at u (m,) and a parameter."""
        shot = self.shoot(u, p)
        if isinstance(shot, Outcome):
            nothing = np.full(u.size, np.nan)
            return Evaluation(nothing, DenseLinear(np.full((u.size, u.size), np.nan)), nothing)
        moving, count = shot.moving, self.reference.x.size
        rows = self._phase_rows()
        residual, by_parameter, matrix = np.zeros(u.size), np.zeros(u.size), np.zeros((u.size,) * 2)
        residual[:count] = shot.end[moving] - u[:count]
        residual[count:] = rows @ (u[:count] - self.reference.x)
        by_parameter[:count] = shot.by_parameter[moving]
        matrix[:count, :count] = shot.returned[moving] @ shot.basis[moving].T - np.eye(count)
        matrix[:count, count] = shot.velocity[moving]
        if self.shooting.turns:
            matrix[:count, count + 1] = shot.by_angle[moving]
        matrix[count:, :count] = rows
        return Evaluation(residual, DenseLinear(matrix), by_parameter)

    def _phase_rows(self) -> Array:
        """Return the directions that a start must not differ from the reference in, each unit.

        One that vanishes fixes nothing, which leaves the linearised problem singular.
        """
        rows = [self.reference.velocity] + [self.reference.turning] * self.shooting.turns
        return np.stack([row / (np.linalg.norm(row) or 1.0) for row in rows])


@dataclass(frozen=True)
class Orbit:
    """A periodic orbit, perhaps up to a symmetry.

    Attributes
    ----------
    u : ndarray of shape (m,)
        Positions at the start, T[, angle].
    p : float
        The parameter.
    shot : Shot
        The motion along it, with its linearisation.
    problem : OrbitProblem
        Its equations with itself as reference, to go on from.
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
        What was found.
    advice : str
        What happened and, if no orbit was found, what to do, in one sentence.
    solution : Solution or None
        How Newton's method went; None if it could not begin.
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
    u : ndarray of shape (m,)
        Guess of the positions at the start, the time T, and the angle where there is a rotation.
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
    orbit = orbit_at(problem, solution.u, p) if solution.converged else None
    if orbit is None:
        return Search(None, solution.outcome.value, solution)
    if not _moves(orbit.shot):
        return Search(None, "an equilibrium was found; begin nearer to the orbit", solution)
    return Search(orbit, solution.outcome.value, solution)


def orbit_at(problem: OrbitProblem, u: Array, p: float) -> Orbit | None:
    """Return the orbit that a solution u (m,) of its problem is; None where there is no flow."""
    shot = problem.shoot(u, p)
    return Orbit(u, p, shot, problem.referred_to(u)) if isinstance(shot, Shot) else None


def with_shorter_steps(orbit: Orbit) -> Orbit | None:
    """Return the same orbit with half as many intervals again, None if that is not found."""
    shooting, shot = orbit.problem.shooting, orbit.shot
    finer = replace(shooting, intervals=math.ceil(1.5 * shooting.intervals))
    stages = resampled(shot.y, shot.flow.stages, finer.intervals, shot.moving, shooting.method)
    return find_orbit(finer, orbit.u, orbit.p, stages).orbit


def time_error(orbit: Orbit) -> float:
    """Return the error of T, from the same orbit with shorter steps; NaN if that is not found."""
    found = with_shorter_steps(orbit)
    return math.nan if found is None else abs(found.shot.duration - orbit.shot.duration)


def _moves(shot: Shot) -> bool:
    return shot.extent > _AT_REST * float(np.abs(shot.y[shot.moving]).max())
