"""Search for spinning states: from the Hopf point, from a run, or from a nearby state."""

from collections.abc import Callable

import numpy as np

from undula.analysis.linear.onset import first_pair
from undula.analysis.linear.pencils import linearised
from undula.analysis.parameters import FORCE, changed
from undula.analysis.runs.run import Run
from undula.analysis.solvers.reach_value import reach_value
from undula.analysis.solvers.symmetry import require_space, require_turning
from undula.analysis.states.follow_branch import Family
from undula.analysis.states.not_found import NotFound, SearchStatus
from undula.analysis.states.records import Spinning
from undula.analysis.states.relative_equilibrium import (
    StraightShapeError,
    TurningShape,
    turning_state,
)
from undula.arrays import Array, Nodes
from undula.errors import InputError
from undula.models.initial_states import from_state
from undula.models.model import Model
from undula.numerics.continuation.arclength import Point, Steps, solve_at

# Largest number of steps along a branch towards a force.
_MOST_STEPS = 400
# Links with which a branch is followed if the model has more; its end alone is then refined.
_FEW_LINKS = 20


def find_spinning(model: Model, guess: Run | Spinning | None = None) -> Spinning | NotFound:
    """Solve for the spinning state of a model.

    A fixed shape that turns about the axis at a constant rate is a relative equilibrium; Newton's
    method solves for shape and rate together.

    Parameters
    ----------
    model : Model
        In space, and axisymmetric.
    guess : Run or Spinning, optional
        A run that ends in spinning, or the state of a similar model, with any number of links.
        Without one the branch is followed from the Hopf point of the straight state.

    Returns
    -------
    Spinning or NotFound
        The latter states how far the search got, and what to try.

    Raises
    ------
    InputError
        The model is confined to a plane or has no rotational symmetry, or the guess is straight.

    Examples
    --------
    >>> import undula as un
    >>> state = un.find(un.Filament(8, un.TipLoad(75.0)), "spinning")
    >>> state.stable, round(state.frequency)
    (True, 87)
    """
    require_space(model)
    require_turning(model, "spinning")
    if guess is not None:
        return _solved_from(model, *_shape_and_rate(guess))
    coarse = model.with_links(_FEW_LINKS) if model.links > _FEW_LINKS else None
    if coarse is not None:
        near = _followed(coarse)
        if not isinstance(near, NotFound):
            state = _solved_from(model, *_shape_and_rate(near))
            if not isinstance(state, NotFound):
                return state
    return _followed(model)


def spinning_start(model: Model) -> tuple[TurningShape, Point] | None:
    """Return the problem in the force and the Hopf point at which its branch begins.

    The tangent at the Hopf point is the critical mode, turning: x + i y = c(s) exp(i omega t).

    Returns
    -------
    tuple of TurningShape and Point, or None
        None if the straight state is stable at all forces.
    """
    pair = first_pair(linearised(model, "discrete"))
    if pair is None:
        return None
    critical = changed(model, FORCE, pair.p)
    straight = critical.straight_unknowns()
    mode = pair.vector / pair.vector[-1] * abs(pair.vector[-1])
    tangent = np.zeros(straight.size + 1)
    moving = critical.equations.differential
    tangent[:-1][moving] = critical.displaced(mode.real, mode.imag)
    problem = TurningShape(model, FORCE, tangent[:-1].copy(), pair.omega)
    tangent /= np.sqrt(problem.weights @ tangent**2)
    return problem, Point(np.append(straight, pair.omega), pair.p, tangent, 0.0)


def spinning_state(problem: TurningShape, u: Array, p: float) -> Spinning:
    """Return the record of the solution u (n + 1,) of a problem at a parameter."""
    return turning_state(changed(problem.model, problem.parameter, p), u[:-1], float(u[-1]))


def _shape_and_rate(guess: Run | Spinning) -> tuple[Nodes, float]:
    if isinstance(guess, Spinning):
        return guess.nodes, guess.rate
    frequency = guess.rotation_frequency
    rate = 2.0 * np.pi * frequency.value if frequency else 0.0
    return guess.last_shape, rate


def _solved_from(model: Model, nodes: Nodes, rate: float) -> Spinning | NotFound:
    y = model.unknowns(model.admissible(from_state(model, nodes)))
    problem = TurningShape(model, FORCE, y, max(1.0, abs(rate)))
    u, force = np.append(y, rate), model.load.force
    solved = solve_at(problem, u, force)
    if solved is None:
        residual = _residual(problem, u, force)
        return NotFound(
            SearchStatus.NOT_CONVERGED,
            f"Newton's method finds no spinning state from the guess (residual {residual:.2g})",
            "let the run settle longer, or start without a guess",
            residual,
        )
    return spinning_state(problem, solved[0], force)


def _residual(problem: TurningShape, guess: Array, force: float) -> float:
    """Return the largest entry of the residual of a guess.

    Raises
    ------
    InputError
        The guess is straight.
    """
    try:
        return float(np.abs(problem.evaluate(guess, force).residual).max())
    except StraightShapeError as error:
        raise InputError(
            "a straight shape turns at any rate, so that no spinning state is near it;"
            " begin with one that is bent"
        ) from error


def _followed(model: Model) -> Spinning | NotFound:
    """Return the state at the model's force where its branch first rises through it."""
    beginning = spinning_start(model)
    if beginning is None:
        return NotFound(
            SearchStatus.NO_ONSET,
            "the straight state stays stable, so that no spinning state begins at it",
        )
    problem, start = beginning
    target = model.load.force
    steps = Steps(first=0.03, most=1.0, scale=start.p)
    ends = 0.0, max(target, 1.5 * start.p)
    reached = reach_value(problem, start, steps, ends, target, _MOST_STEPS)
    if reached.u is not None:
        return spinning_state(reached.problem, reached.u, target)
    return NotFound(
        SearchStatus.NOT_REACHED,
        f"the spinning branch begins at force {start.p:.6g} and was followed to {reached.p:.6g}"
        f" without coming up to {target:.6g}",
        "ask for a larger force, or give a run that spins as a guess",
    )


def spinning_family(state: Spinning, parameter: str, scale: float) -> Family[Spinning]:
    """Return the family of a spinning state along a parameter; a change by `scale` counts as 1."""
    problem = TurningShape(state.model, parameter, state.unknowns, abs(state.rate))
    return Family(parameter, problem, spinning_state, _bifurcation_kind, scale)


def _bifurcation_kind(state: Spinning, index: int) -> str:
    return "torus" if state.exponents[index].imag != 0.0 else "symmetry breaking"


def spinning_judge(
    model: Model,  # noqa: ARG001
    parameter: str,  # noqa: ARG001
) -> Callable[[TurningShape, Array, float], Spinning]:
    """Return the function from a problem, a solution of it and the parameter to the state."""
    return spinning_state


def spinning_unknowns(state: Spinning) -> Array:
    """Return the unknowns (n + 1,) of a state in the equations of its family."""
    return np.append(state.unknowns, state.rate)
