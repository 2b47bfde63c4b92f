"""Planar flapping, solved for: half a beat in the plane, closed by the mirror, and then judged.

Half a period later a beat is its own mirror image, so that half of it, in the plane, is all that
has to be solved for (`undula.numerics.orbits.periodic_orbit`). Disturbances in the plane and out of
it do not mix: the former come with the solution, the latter from the equations in space, linearised
along it.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from undula.analysis.linear.onset import first_pair
from undula.analysis.linear.pencils import linearised
from undula.analysis.parameters import FORCE, changed, value_of
from undula.analysis.run_settings import Ending
from undula.analysis.runs.integrate import integrate
from undula.analysis.runs.run import Run
from undula.analysis.solvers.symmetry import require_turning
from undula.analysis.states.follow_branch import Family, UnresolvedError
from undula.analysis.states.records import Flapping, NotFound
from undula.arrays import Array, ComplexArray
from undula.models.initial_states import from_state, planar
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
    find_orbit,
    orbit_at,
    time_error,
)
from undula.numerics.orbits.shooting import Shooting, Shot
from undula.numerics.orbits.symmetry import OrbitSymmetry

# Steps of half a beat, of order 9: the relative error of the frequency is then some 1e-11 to 1e-8,
# which each answer states for itself.
INTERVALS, METHOD = 32, RADAU_9
_NOT_CONFIRMED = (
    "what was found is no beat that shorter steps confirm, as where a joint folds; follow the"
    " branch from a smaller force to see where it ends"
)
_TURNS_LOST = (
    "a motion was found whose joints jump by full turns, which is no beat; follow the branch from a"
    " smaller force, or give the beat found there as a guess"
)
# The run that a beat is taken from: a start large enough to be quick, and how many beats it may
# take, counted as if their time fell as the force grows beyond the onset.
_START, _BEATS = 0.3, 200.0


def find_flapping(model: Model, guess: Run | Flapping | None = None) -> Flapping | NotFound:
    """Solve for the planar beat of a model.

    Parameters
    ----------
    model : Model
        In space or confined.
    guess : Run or Flapping, optional
        A run that ends in a planar beat, or the beat of a similar model, with any number of links.
        Without one a short confined run gives the first guess.

    Returns
    -------
    Flapping or NotFound
        The latter says how far the search came, and what to try.

    Raises
    ------
    InputError
        The model has no turning symmetry.
    """
    require_turning(model, "flapping")
    flat = model.with_(confined=True)
    first = _start_and_half_period(flat, guess)
    if isinstance(first, NotFound):
        return first
    x, half_period = first
    shooting = _shooting(model, FORCE)
    search = find_orbit(shooting, np.append(x, half_period), model.load.force)
    if search.orbit is None:
        residual = search.solution.residual if search.solution else None
        return NotFound(f"no planar beat was found from the guess: {search.advice}", residual)
    if not _keeps_turns(flat, search.orbit.shot):
        return NotFound(_TURNS_LOST)
    error = time_error(search.orbit) / search.orbit.shot.duration
    if not np.isfinite(error):
        return NotFound(_NOT_CONFIRMED)
    found = _judged(model, search.orbit)
    return replace(found, time_error=found.frequency * error)


def flapping_family(state: Flapping, parameter: str, scale: float) -> Family[Flapping]:
    """Return the family of a planar beat along a parameter."""
    shooting = _shooting(state.model, parameter)
    start = shooting.shoot(flapping_unknowns(state), value_of(state.model, parameter))
    assert isinstance(start, Shot)  # the state was found so
    problem = OrbitProblem(shooting, Reference.of(start), LastShot(start))
    return Family(parameter, problem, flapping_judge(state.model, parameter), _named, scale)


def flapping_judge(
    model: Model, parameter: str
) -> Callable[[OrbitProblem, Array, float], Flapping]:
    """Return the function from a problem along a parameter and its solution to the state."""

    def judge(problem: OrbitProblem, u: Array, p: float) -> Flapping:
        orbit = orbit_at(problem, u, p)
        if orbit is None or not _keeps_turns(model.with_(confined=True), orbit.shot):
            raise UnresolvedError
        return _judged(changed(model, parameter, p), orbit)

    return judge


def flapping_start(model: Model) -> tuple[OrbitProblem, Point] | None:
    """Return the problem in the force and the Hopf point at which the branch begins.

    The tangent there is the critical mode, swinging: x = Re c(s) exp(i omega t).
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
    """Return the unknowns of a state in the equations of its family: a start, half the period."""
    start = state.planar.positions(state.unknowns[-1])
    return np.append(start, 0.5 * state.period)


def _shooting(model: Model, parameter: str) -> Shooting:
    flat = model.with_(confined=True)
    return (_Continuous if flat.unwrapped else Shooting)(
        equations_at=lambda p: changed(flat, parameter, p).equations,
        closure=OrbitSymmetry(flat.equations.mirrored),
        intervals=INTERVALS,
        method=METHOD,
    )


def _start_and_half_period(
    flat: Model, guess: Run | Flapping | None
) -> tuple[Array, float] | NotFound:
    if isinstance(guess, Flapping):
        energies = guess.planar.observe(guess.unknowns).bending_energy
        return _positions(flat, _beginning(flat, guess.nodes, energies)), 0.5 * guess.period
    run = guess or integrate(flat, planar(flat, _START), until="settled", limit=_longest(flat))
    if guess is None and run.ending is Ending.INTERRUPTED:
        raise KeyboardInterrupt  # which a run takes as its end, with what there is
    if run.frequency is None or run.frequency.value == 0.0 or run.verdict.name == "windmilling":
        whose = "given" if guess else "confined"
        return NotFound(f"the {whose} run does not beat ({run.verdict.name}): {_onset_text(flat)}")
    half = 0.5 / abs(run.frequency.value)
    last = run.motion.late(run.motion.time[-1] - 2.0 * half)
    return _positions(flat, _beginning(flat, last.nodes, last.energetics.bending_energy)), half


def _longest(flat: Model) -> float:
    """Return how long a beat may take to settle [T]: beats are the shorter the larger the force."""
    pair = first_pair(linearised(flat, "discrete"))
    if pair is None:
        return _BEATS
    return _BEATS * 2.0 * np.pi / pair.omega * pair.p / max(pair.p, flat.load.force)


def _onset_text(flat: Model) -> str:
    pair = first_pair(linearised(flat, "discrete"))
    if pair is None:
        return "the straight state stays stable, so that no beat begins at it"
    if flat.load.force > pair.p:
        return (
            "it settles to no beat; follow the branch from a smaller force, or give the beat found"
            " there as a guess"
        )
    return f"planar flapping begins at force {pair.p:.6g}, and this one is {flat.load.force:.6g}"


class _Continuous(Shooting):
    """Shots that find the full turns of joints on their way from the start, where there are none.

    Those of another motion, close as it may be, need not be theirs at the same instants.
    """

    def shoot(self, u: Array, p: float, guess: Array | None = None) -> Shot | Outcome:  # noqa: ARG002
        """Return the shot of u, begun from nothing but its start."""
        return super().shoot(u, p)


def _keeps_turns(flat: Model, shot: Shot) -> bool:
    """Tell whether half a beat accounts for the full turns of joints that wind up.

    They are known from one interval to the next as long as an angle changes by less than half of
    one; so it has to from the mirrored end to the first interval.
    """
    ends = shot.flow.stages[:, -1]
    angles = flat.joint_angles(np.concatenate([flat.equations.mirrored(ends[-1:]), ends]))
    return not flat.unwrapped or float(np.abs(np.diff(angles, axis=0)).max()) < np.pi


def _beginning(flat: Model, nodes: Array, energies: Array) -> Array:
    """Return the shape of a beat (m, N + 1, 3) to begin at.

    Joints that wind up are found again from positions where they are wound up least.
    """
    return np.asarray(nodes[np.argmin(energies) if flat.unwrapped else -1])


def _positions(flat: Model, nodes: Array) -> Array:
    return flat.admissible(from_state(flat, nodes))


def _judged(model: Model, orbit: Orbit) -> Flapping:
    """Return the beat that an orbit of half its period is, with its disturbances."""
    shot, half = orbit.shot, orbit.shot.duration
    velocity = shot.basis.T @ shot.velocity
    in_plane, shift = _exponents(shot.monodromy, velocity, 1.0, half)
    trivial, out_of_plane = [shift], np.zeros(0, dtype=np.complex128)
    if model.dimension == 3:
        # A small turn about the axis moves the nodes across the plane by their deflection, which
        # half a beat later is reversed.
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
    judged = floquet(monodromy, direction[:, None], np.array([expected]))
    return judged.exponents(half), float(judged.known_errors[0])


def _named(state: Flapping, index: int) -> str:
    swing = abs(state.exponents[index].imag) * 0.5 * state.period
    # Half-period multipliers +-1 are real; what they break is a symmetry.
    return "symmetry breaking" if min(swing, abs(swing - np.pi)) < 1e-6 else "torus"
