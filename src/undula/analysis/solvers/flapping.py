"""Search for planar flapping: half a beat in the plane, closed by the mirror symmetry.

Half a period later a beat is its own mirror image, so that solving for half of it in the plane
suffices (`undula.numerics.orbits.periodic_orbit`). Disturbances in the plane and out of it are
independent: the solution contains the former, and the equations in space, linearised along it, give
the latter.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from undula.analysis.linear.onset import first_pair
from undula.analysis.linear.pencils import linearised
from undula.analysis.parameters import FORCE, changed, value_of
from undula.analysis.runs.run import Run
from undula.analysis.solvers.flapping_guesses import start_and_half_period
from undula.analysis.solvers.symmetry import require_turning
from undula.analysis.states.follow_branch import Family, UnresolvedError
from undula.analysis.states.not_found import NotFound, SearchStatus
from undula.analysis.states.records import Flapping
from undula.arrays import Array, ComplexArray
from undula.models.model import Model
from undula.numerics.continuation.arclength import Point
from undula.numerics.orbits.collocation import Outcome
from undula.numerics.orbits.floquet import floquet
from undula.numerics.orbits.flow import RADAU_9, linearised_flow
from undula.numerics.orbits.periodic_orbit import (
    LastShot,
    Orbit,
    OrbitProblem,
    Reference,
    Search,
    find_orbit,
    orbit_at,
    time_error,
)
from undula.numerics.orbits.shooting import Shooting, Shot
from undula.numerics.orbits.symmetry import OrbitSymmetry

# Steps of half a beat, of order 9: the relative error of the frequency is then some 1e-11 to 1e-8,
# and each answer states its own.
INTERVALS, METHOD = 32, RADAU_9
_NOT_CONFIRMED = NotFound(
    SearchStatus.NOT_CONFIRMED,
    "what was found is no beat that shorter steps confirm, as where a joint folds",
    "follow the branch from a smaller force to see where it ends",
)
_TURNS_LOST = NotFound(
    SearchStatus.NOT_CONFIRMED,
    "a motion was found whose joints jump by full turns, which is no beat",
    "follow the branch from a smaller force, or give the beat found there as a guess",
)


def find_flapping(model: Model, guess: Run | Flapping | None = None) -> Flapping | NotFound:
    """Solve for the planar beat of a model.

    Single shooting over half a beat solves for shape and period together (Keller 1968).

    Parameters
    ----------
    model : Model
        In space or confined; axisymmetric.
    guess : Run or Flapping, optional
        A run that ends in a planar beat, or the beat of a similar model, with any number of links.
        Without one a short confined run gives the first guess.

    Returns
    -------
    Flapping or NotFound
        The latter states how far the search got, and what to try.

    Raises
    ------
    InputError
        The model has no rotational symmetry.

    Examples
    --------
    >>> import undula as un
    >>> beat = un.find(un.Filament(4, un.TipLoad(75.0), confined=True), "flapping")
    >>> beat.stable, round(beat.period * beat.frequency, 9)
    (True, 1.0)
    """
    require_turning(model, "flapping")
    flat = model.with_(confined=True)
    beginning = start_and_half_period(flat, guess)
    if isinstance(beginning, NotFound):
        return beginning
    x, half_period = beginning
    shooting = _shooting(model, FORCE)
    search = find_orbit(shooting, np.append(x, half_period), model.load.force)
    if search.orbit is None:
        return no_orbit(search, "no planar beat was found from the guess")
    if not _keeps_turns(flat, search.orbit.shot):
        return _TURNS_LOST
    relative_error = time_error(search.orbit) / search.orbit.shot.duration
    if not np.isfinite(relative_error):
        return _NOT_CONFIRMED
    beat = _recorded(model, search.orbit)
    return replace(beat, time_error=beat.frequency * relative_error)


def no_orbit(search: Search, finding: str) -> NotFound:
    """Return the outcome of a search that found no orbit, with the words of Newton's method."""
    happened, _, advice = search.advice.partition("; ")
    residual = search.solution.residual if search.solution else None
    return NotFound(SearchStatus.NOT_CONVERGED, f"{finding}: {happened}", advice or None, residual)


def flapping_family(state: Flapping, parameter: str, scale: float) -> Family[Flapping]:
    """Return the family of a planar beat along a parameter; a change by `scale` counts as 1."""
    shooting = _shooting(state.model, parameter)
    start = shooting.shoot(flapping_unknowns(state), value_of(state.model, parameter))
    assert isinstance(start, Shot)  # as when the state was solved for
    problem = OrbitProblem(shooting, Reference.of(start), LastShot(start))
    return Family(
        parameter, problem, flapping_judge(state.model, parameter), _bifurcation_kind, scale
    )


def flapping_judge(
    model: Model, parameter: str
) -> Callable[[OrbitProblem, Array, float], Flapping]:
    """Return the function from a problem, a solution of it and the parameter to the state.

    The function raises `UnresolvedError` where the flow is not resolved any more.
    """

    def judge(problem: OrbitProblem, u: Array, p: float) -> Flapping:
        orbit = orbit_at(problem, u, p)
        if orbit is None or not _keeps_turns(model.with_(confined=True), orbit.shot):
            raise UnresolvedError
        return _recorded(changed(model, parameter, p), orbit)

    return judge


def flapping_start(model: Model) -> tuple[OrbitProblem, Point] | None:
    """Return the problem in the force and the Hopf point at which the branch begins.

    The tangent at the Hopf point is the critical mode, swinging: x = Re c(s) exp(i omega t).

    Returns
    -------
    tuple of OrbitProblem and Point, or None
        None if the straight state is stable at all forces.
    """
    flat = model.with_(confined=True)
    pair = first_pair(linearised(flat, "discrete"))
    if pair is None:
        return None
    straight = changed(flat, FORCE, pair.p).straight()
    mode = pair.vector / pair.vector[-1]
    velocity = flat.displaced(-pair.omega * mode.imag)
    tangent = np.append(flat.displaced(mode.real), 0.0)
    half = np.pi / pair.omega
    reference = Reference(straight, velocity, np.zeros(straight.size), half)
    problem = OrbitProblem(_shooting(model, FORCE), reference)
    tangent /= np.sqrt(problem.weights @ tangent**2)
    return problem, Point(np.append(straight, half), pair.p, tangent, 0.0)


def flapping_unknowns(state: Flapping) -> Array:
    """Return the unknowns of a beat in the equations of its family: a start, half the period."""
    start = state.planar.positions(state.unknowns[-1])
    return np.append(start, 0.5 * state.period)


def _shooting(model: Model, parameter: str) -> Shooting:
    flat = model.with_(confined=True)
    return (_Continuous if flat.unwrapped else Shooting)(
        equations_at=lambda p: changed(flat, parameter, p).equations,
        symmetry=OrbitSymmetry(flat.equations.mirrored),
        intervals=INTERVALS,
        method=METHOD,
    )


class _Continuous(Shooting):
    """Shots that count full turns of joints from the start of the motion, which has none.

    Another motion, however close, may have other full turns at the same instants.
    """

    def shoot(self, u: Array, p: float, guess: Array | None = None) -> Shot | Outcome:  # noqa: ARG002
        """Return the shot of u, begun from its start alone."""
        return super().shoot(u, p)


def _keeps_turns(flat: Model, shot: Shot) -> bool:
    """Return whether half a beat accounts for the full turns of unwrapped joints.

    An angle is known up to full turns while it changes by less than half a turn per interval. The
    same has to hold from the mirrored end to the first interval.
    """
    ends = shot.flow.stages[:, -1]
    angles = flat.joint_angles(np.concatenate([flat.equations.mirrored(ends[-1:]), ends]))
    return not flat.unwrapped or float(np.abs(np.diff(angles, axis=0)).max()) < np.pi


def _recorded(model: Model, orbit: Orbit) -> Flapping:
    """Return the record of a beat from an orbit of half its period, with its disturbances."""
    shot, half = orbit.shot, orbit.shot.duration
    velocity = shot.basis.T @ shot.velocity
    in_plane, shift = _exponents(shot.monodromy, velocity, 1.0, half)
    trivial, out_of_plane = [shift], np.zeros(0, dtype=np.complex128)
    if model.dimension == 3:
        # A small turn about the axis moves the nodes across the plane by their deflection. Half a
        # beat later the deflection is reversed.
        deflection = model.equations.turning(model.equations.from_plane(shot.y))[0]
        across = deflection[model.equations.across]
        out_of_plane, turn = _exponents(_across(model, orbit), across, -1.0, half)
        trivial.append(turn)
    ends = shot.flow.stages[:, -1]
    return Flapping(
        model=model,
        period=2.0 * half,
        time=np.arange(1, 2 * len(ends) + 1) * half / len(ends),
        unknowns=np.concatenate([ends, model.with_(confined=True).equations.mirrored(ends)]),
        residual=float(np.abs((shot.end - shot.y)[shot.moving]).max()),
        in_plane=in_plane,
        out_of_plane=out_of_plane,
        trivial=tuple(trivial),
        time_error=np.nan,
    )


def _across(model: Model, orbit: Orbit) -> Array:
    """Return the map (k, k) of displacements out of the plane over half a beat."""
    shot, equations = orbit.shot, model.equations
    rows = np.flatnonzero(equations.across)
    columns = np.zeros((equations.across.size, rows.size))
    columns[rows, np.arange(rows.size)] = 1.0
    stages, start = equations.from_plane(shot.flow.stages), equations.from_plane(shot.y)
    method = orbit.problem.shooting.method
    change = linearised_flow(equations, start, stages, shot.duration, columns, (), method)
    assert change is not None  # the stages solve equations that are regular in the plane
    return change.by_start[rows]


def _exponents(
    monodromy: Array, direction: Array, expected: float, half: float
) -> tuple[ComplexArray, float]:
    """Return the exponents of a half-period map, and the error of its known multiplier."""
    spectrum = floquet(monodromy, direction[:, None], np.array([expected]))
    return spectrum.exponents(half), float(spectrum.trivial_errors[0])


def _bifurcation_kind(state: Flapping, index: int) -> str:
    swing = abs(state.exponents[index].imag) * 0.5 * state.period
    # Half-period multipliers of +1 and -1 are real: such a disturbance breaks a symmetry.
    return "symmetry breaking" if min(swing, abs(swing - np.pi)) < 1e-6 else "torus"
