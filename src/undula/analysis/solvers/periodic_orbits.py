"""Motions that are periodic up to a turn as equations, and those that flapping gives birth to.

A body that is held in one direction, as one that is curved by nature, has none to be turned by: its
motions are periodic as they are, x(t + T) = x(t), whether they go round or to and fro.

Where planar flapping loses or gains stability by a real disturbance out of its plane, a motion out
of the plane is born. In the frame of half a beat, turned by pi, both are x(t + T) = R(angle) x(t),
so that the new branch is found along the null vector of these equations.
"""

from collections.abc import Callable

import numpy as np

from undula.analysis.parameters import FORCE, changed, value_of
from undula.analysis.solvers.flapping import INTERVALS, METHOD, flapping_unknowns
from undula.analysis.solvers.symmetry import require_space
from undula.analysis.states.branch import Bifurcation, Branch
from undula.analysis.states.follow_branch import Family, Progress, UnresolvedError, follow_branch
from undula.analysis.states.periodic_record import Periodic
from undula.analysis.states.records import Flapping
from undula.arrays import Array
from undula.errors import InputError
from undula.models.model import Model
from undula.numerics.continuation.arclength import Point, Steps
from undula.numerics.continuation.problem import DenseLinear
from undula.numerics.orbits.floquet import floquet_of
from undula.numerics.orbits.periodic_orbit import (
    LastShot,
    Orbit,
    OrbitProblem,
    Reference,
    orbit_at,
)
from undula.numerics.orbits.shooting import Shooting, Shot
from undula.numerics.orbits.symmetry import OrbitSymmetry, Rotation

# A motion that turns back with less variation of its energy than this, over the mean, has become a
# steady one.
_STEADY = 0.01


def periodic_family(state: Periodic, parameter: str, scale: float) -> Family[Periodic]:
    """Return the family of a motion that is periodic up to a turn, along a parameter."""
    shooting = periodic_shooting(state.model, parameter, len(state.unknowns))
    start = shooting.shoot(periodic_unknowns(state), value_of(state.model, parameter))
    assert isinstance(start, Shot)  # the state was found so
    problem = OrbitProblem(shooting, Reference.of(start), LastShot(start))
    return _family(state.model, problem, parameter, scale)


def periodic_unknowns(state: Periodic) -> Array:
    """Return the unknowns of a state in the equations of its family."""
    last = [state.duration, state.angle] if state.model.axisymmetric else [state.duration]
    return np.concatenate([state.start, last])


def follow_from_bifurcation(
    bifurcation: Bifurcation[Flapping],
    to: float,
    *,
    parameter: str = FORCE,
    progress: Progress | None = None,
) -> Branch[Periodic]:
    """Follow the motion out of the plane that is born on a branch of planar flapping.

    Parameters
    ----------
    bifurcation : Bifurcation
        A symmetry breaking of planar flapping, out of its plane.
    to : float
        Value of the parameter at which to end; the branch may turn back before.
    parameter : str
        Name of the parameter that the bifurcation is a value of.
    progress : callable, optional
        Called with each value that was reached.

    Raises
    ------
    InputError
        The bifurcation is none of this kind.
    """
    state = bifurcation.state
    if not isinstance(state, Flapping) or bifurcation.kind != "symmetry breaking":
        raise InputError(
            f"a {bifurcation.kind} of {type(state).__name__} gives birth to no motion that could be"
            " followed; give a symmetry breaking of planar flapping"
        )
    require_space(state.model)
    u, shooting = _in_space(state), periodic_shooting(state.model, parameter, INTERVALS)
    start = shooting.shoot(u, bifurcation.value)
    assert isinstance(start, Shot)  # the planar motion was found so
    problem = OrbitProblem(shooting, Reference.of(start), LastShot(start))
    scale = abs(to - bifurcation.value) or 1.0
    point = Point(u, bifurcation.value, _null_vector(problem, u, bifurcation.value), 0.0)
    family = _family(state.model, problem, parameter, scale)
    # Born sideways: the first steps are short.
    steps = Steps(first=0.03, most=0.3, scale=scale)
    return follow_branch(
        family, u, bifurcation.value, to, steps, progress, enough=_dies, start=point
    )


def _dies(bifurcation: Bifurcation[Periodic]) -> bool:
    """Tell whether a motion has become a steady one: what follows is the branch's mirror image."""
    energy = bifurcation.state.energy
    return bifurcation.kind == "fold" and energy.max - energy.min <= _STEADY * energy.mean


def _in_space(state: Flapping) -> Array:
    """Return half a beat as a motion in space that has turned by pi."""
    planar = flapping_unknowns(state)
    equations = state.model.equations
    x = equations.from_plane(state.unknowns[-1])[equations.differential]
    return np.concatenate([x, [planar[-1], np.pi]])


def _null_vector(problem: OrbitProblem, u: Array, p: float) -> Array:
    """Return the direction in which the equations are singular, of length 1 in their norm."""
    linear = problem.evaluate(u, p).linear
    assert isinstance(linear, DenseLinear)  # as orbits have it
    direction = np.linalg.svd(linear.matrix)[2][-1]
    return np.asarray(direction / np.sqrt(problem.weights @ direction**2))


def periodic_shooting(model: Model, parameter: str, intervals: int) -> Shooting:
    """Return how to shoot from a start over a period of so many intervals, along a parameter."""

    equations = model.equations

    def generator(y: Array) -> Array:
        return equations.turning(np.ascontiguousarray(y))[0]

    turns = Rotation(equations.rotated, generator) if model.axisymmetric else None
    return Shooting(
        equations_at=lambda p: changed(model, parameter, p).equations,
        closure=OrbitSymmetry(rotation=turns),
        intervals=intervals,
        method=METHOD,
    )


def periodic_start(model: Model) -> None:  # noqa: ARG001
    """Refuse to begin at an onset: other motions do."""
    raise InputError(
        "periodic motions begin where others lose stability, not at the onset; follow one from a"
        " value at which there is one"
    )


def periodic_judge(
    model: Model, parameter: str
) -> Callable[[OrbitProblem, Array, float], Periodic]:
    """Return the function from a problem along a parameter and its solution to the state."""

    def judge(problem: OrbitProblem, u: Array, p: float) -> Periodic:
        orbit = orbit_at(problem, u, p)
        if orbit is None:
            raise UnresolvedError
        return periodic_state(changed(model, parameter, p), orbit)

    return judge


def _family(model: Model, problem: OrbitProblem, parameter: str, scale: float) -> Family[Periodic]:
    return Family(parameter, problem, periodic_judge(model, parameter), _named, scale)


def periodic_state(model: Model, orbit: Orbit) -> Periodic:
    """Return the motion that an orbit is, judged."""
    shot = orbit.shot
    judged = floquet_of(shot)
    return Periodic(
        model=model,
        duration=shot.duration,
        angle=shot.angle,
        unknowns=shot.flow.stages[:, -1],
        residual=float(np.abs((shot.end - shot.y)[shot.moving]).max()),
        exponents=judged.exponents(shot.duration),
        trivial=tuple(float(error) for error in judged.known_errors),
    )


def _named(state: Periodic, index: int) -> str:
    swing = abs(state.exponents[index].imag) * state.duration
    if min(swing, abs(swing - np.pi)) > 1e-6:
        return "torus"
    return "period doubling" if swing > 1.0 else "branch point"
