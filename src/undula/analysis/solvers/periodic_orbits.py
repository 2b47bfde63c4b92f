"""Equations of motions that are periodic up to a turn, and their branches off planar flapping.

Bodies without rotational symmetry (natural curvature, unequal bending stiffnesses) have motions
that are periodic without a turn, x(t + T) = x(t).

Where planar flapping loses or gains stability by a real disturbance out of its plane, a branch of
motions out of the plane begins. In the frame of half a beat, turned by pi, both motions obey
x(t + T) = R(angle) x(t), so that the new branch begins along the null vector of these equations.
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

# Largest variation of the energy over its mean at which a motion that turns back counts as steady.
_STEADY_VARIATION = 0.01


def periodic_family(state: Periodic, parameter: str, scale: float) -> Family[Periodic]:
    """Return the family of a motion along a parameter; a change by `scale` counts as 1."""
    shooting = periodic_shooting(state.model, parameter, len(state.unknowns))
    start = shooting.shoot(periodic_unknowns(state), value_of(state.model, parameter))
    assert isinstance(start, Shot)  # as when the state was solved for
    problem = OrbitProblem(shooting, Reference.of(start), LastShot(start))
    return _family(state.model, problem, parameter, scale)


def periodic_unknowns(state: Periodic) -> Array:
    """Return the unknowns of a state in the equations of its family: start, period[, angle]."""
    last = [state.period, state.angle] if state.model.axisymmetric else [state.period]
    return np.concatenate([state.start, last])


def follow_from_bifurcation(
    bifurcation: Bifurcation[Flapping],
    to: float,
    *,
    parameter: str = FORCE,
    progress: Progress | None = None,
) -> Branch[Periodic]:
    """Follow the motion out of the plane that begins at a bifurcation of planar flapping.

    The branch begins along the null vector of the singular equations (Keller 1968; Doedel, Keller &
    Kernevez 1991).

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

    Returns
    -------
    Branch
        Not complete unless it reached `to`.

    Raises
    ------
    InputError
        The bifurcation is not of this kind.

    Examples
    --------
    Following takes ten seconds:

    >>> import undula as un
    >>> beat = un.find(un.Filament(6, un.TipLoad(114.0)), "flapping")  # doctest: +SKIP
    >>> planar = un.follow(beat, "load.force", 115.0)  # doctest: +SKIP
    >>> branch = un.follow_from_bifurcation(planar.bifurcations[0], 114.5)  # doctest: +SKIP
    >>> branch.complete, branch.states[-1].stable  # doctest: +SKIP
    (True, False)
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
    assert isinstance(start, Shot)  # as when the planar motion was solved for
    problem = OrbitProblem(shooting, Reference.of(start), LastShot(start))
    scale = abs(to - bifurcation.value) or 1.0
    point = Point(u, bifurcation.value, _null_vector(problem, u, bifurcation.value), 0.0)
    family = _family(state.model, problem, parameter, scale)
    # The branch begins at a constant parameter: the first steps are short.
    steps = Steps(first=0.03, most=0.3, scale=scale)
    return follow_branch(
        family, u, bifurcation.value, to, steps, progress, enough=_has_become_steady, start=point
    )


def _has_become_steady(bifurcation: Bifurcation[Periodic]) -> bool:
    """Return whether a motion has become steady: the branch then repeats its mirror image."""
    energy = bifurcation.state.bending_energy
    return bifurcation.kind == "fold" and energy.max - energy.min <= _STEADY_VARIATION * energy.mean


def _in_space(state: Flapping) -> Array:
    """Return half a beat as a motion in space that has turned by pi."""
    half_period = flapping_unknowns(state)[-1]
    equations = state.model.equations
    x = equations.from_plane(state.unknowns[-1])[equations.differential]
    return np.concatenate([x, [half_period, np.pi]])


def _null_vector(problem: OrbitProblem, u: Array, p: float) -> Array:
    """Return the direction in which the equations are singular, of length 1 in their norm."""
    linear = problem.evaluate(u, p).linear
    assert isinstance(linear, DenseLinear)  # the type of all orbit problems
    direction = np.linalg.svd(linear.matrix)[2][-1]
    return np.asarray(direction / np.sqrt(problem.weights @ direction**2))


def periodic_shooting(model: Model, parameter: str, intervals: int) -> Shooting:
    """Return the shooting problem of a motion over a period, along a parameter.

    Parameters
    ----------
    model : Model
        In space.
    parameter : str
        Name of the parameter.
    intervals : int
        Equal time steps in a period.
    """
    equations = model.equations

    def generator(y: Array) -> Array:
        return equations.turning(np.ascontiguousarray(y))[0]

    turns = Rotation(equations.rotated, generator) if model.axisymmetric else None
    return Shooting(
        equations_at=lambda p: changed(model, parameter, p).equations,
        symmetry=OrbitSymmetry(rotation=turns),
        intervals=intervals,
        method=METHOD,
    )


def periodic_start(model: Model) -> None:  # noqa: ARG001
    """Refuse to begin at an onset.

    Raises
    ------
    InputError
        Always: branches of periodic motions begin at bifurcations of others.
    """
    raise InputError(
        "periodic motions begin where others lose stability, not at the onset; follow one from a"
        " value at which there is one"
    )


def periodic_judge(
    model: Model, parameter: str
) -> Callable[[OrbitProblem, Array, float], Periodic]:
    """Return the function from a problem, a solution of it and the parameter to the state.

    The function raises `UnresolvedError` where the flow is not resolved any more.
    """

    def judge(problem: OrbitProblem, u: Array, p: float) -> Periodic:
        orbit = orbit_at(problem, u, p)
        if orbit is None:
            raise UnresolvedError
        return periodic_state(changed(model, parameter, p), orbit)

    return judge


def _family(model: Model, problem: OrbitProblem, parameter: str, scale: float) -> Family[Periodic]:
    return Family(parameter, problem, periodic_judge(model, parameter), _bifurcation_kind, scale)


def periodic_state(model: Model, orbit: Orbit) -> Periodic:
    """Return the record of an orbit, with its residual and its exponents."""
    shot = orbit.shot
    spectrum = floquet_of(shot)
    return Periodic(
        model=model,
        period=shot.duration,
        angle=shot.angle,
        unknowns=shot.flow.stages[:, -1],
        residual=float(np.abs((shot.end - shot.y)[shot.moving]).max()),
        exponents=spectrum.exponents(shot.duration),
        trivial=tuple(float(error) for error in spectrum.trivial_errors),
    )


def _bifurcation_kind(state: Periodic, index: int) -> str:
    swing = abs(state.exponents[index].imag) * state.period
    if min(swing, abs(swing - np.pi)) > 1e-6:
        return "torus"
    return "period doubling" if swing > 1.0 else "branch point"
