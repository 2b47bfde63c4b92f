"""Spinning states, solved for: from the Hopf point on, from a run, or from a nearby state."""

from collections.abc import Callable

import numpy as np

from undula.analysis.linear.onset import first_pair
from undula.analysis.linear.pencils import linearised
from undula.analysis.parameters import FORCE, changed
from undula.analysis.runs.run import Run
from undula.analysis.solvers.symmetry import require_space, require_turning
from undula.analysis.states.follow_branch import Family
from undula.analysis.states.records import NotFound, Spinning
from undula.analysis.states.relative_equilibrium import TurningShape, turning_state
from undula.arrays import Array, Nodes
from undula.models.initial_states import from_state
from undula.models.model import Model
from undula.numerics.continuation.arclength import Point, Steps, follow, located, solved_at

# A branch that has not come to the force after so many steps will hardly do so.
_MOST_STEPS = 400
# With more links than this the branch is followed with so many, and only its end refined.
_FEW_LINKS = 20
# The target is approached to this share of its size before it is solved for.
_NEAR = 1e-3


def find_spinning(model: Model, guess: Run | Spinning | None = None) -> Spinning | NotFound:
    """Solve for the spinning state of a model.

    Parameters
    ----------
    model : Model
    guess : Run or Spinning, optional
        A run that ends in spinning, or the state of a similar model, with any number of links.
        Without one the branch is followed from the Hopf point of the straight state.

    Returns
    -------
    Spinning or NotFound
        The latter says how far the search came, and what to try.

    Raises
    ------
    InputError
        The model is confined to a plane, or has no turning symmetry.
    """
    require_space(model)
    require_turning(model, "spinning")
    if guess is not None:
        return _solved_from(model, *_shape_and_rate(guess))
    coarse = model.with_links(_FEW_LINKS) if model.links > _FEW_LINKS else None
    if coarse is not None:
        near = _followed(coarse)
        if not isinstance(near, NotFound):
            found = _solved_from(model, *_shape_and_rate(near))
            if not isinstance(found, NotFound):
                return found
    return _followed(model)


def spinning_start(model: Model) -> tuple[TurningShape, Point] | None:
    """Return the problem in the force and the Hopf point at which its branch begins.

    The tangent there is the critical mode, turning: x + i y = c(s) exp(i omega t).
    """
    pair = first_pair(linearised(model, "discrete"))
    if pair is None:
        return None
    at = changed(model, FORCE, pair.p)
    straight = at.straight_unknowns()
    mode = pair.vector / pair.vector[-1] * abs(pair.vector[-1])
    tangent = np.zeros(straight.size + 1)
    tangent[:-1][at.equations.differential] = at.displaced(mode.real, mode.imag)
    problem = TurningShape(model, FORCE, tangent[:-1].copy(), pair.omega)
    tangent /= np.sqrt(problem.weights @ tangent**2)
    return problem, Point(np.append(straight, pair.omega), pair.p, tangent, 0.0)


def spinning_state(problem: TurningShape, u: Array, p: float) -> Spinning:
    """Return the state that solves a problem, judged."""
    return turning_state(changed(problem.model, problem.parameter, p), u[:-1], float(u[-1]))


def _shape_and_rate(guess: Run | Spinning) -> tuple[Nodes, float]:
    if isinstance(guess, Spinning):
        return guess.nodes, guess.rate
    turning = guess.rotation_frequency
    rate = 2.0 * np.pi * turning.value if turning else 0.0
    return guess.last_shape, rate


def _solved_from(model: Model, nodes: Nodes, rate: float) -> Spinning | NotFound:
    y = model.unknowns(model.admissible(from_state(model, nodes)))
    problem = TurningShape(model, FORCE, y, max(1.0, abs(rate)))
    solved = solved_at(problem, np.append(y, rate), model.load.force)
    if solved is None:
        residual = float(
            np.abs(problem.evaluate(np.append(y, rate), model.load.force).residual).max()
        )
        return NotFound(
            f"Newton's method finds no spinning state from the guess (residual {residual:.2g});"
            " let the run settle longer, or start without a guess",
            residual,
        )
    return spinning_state(problem, solved[0], model.load.force)


def _followed(model: Model) -> Spinning | NotFound:
    """Return the state at the model's force where its branch, from the Hopf point on, goes up."""
    began = spinning_start(model)
    if began is None:
        return NotFound("the straight state stays stable, so that no spinning state begins at it")
    problem, start = began
    target, last = model.load.force, start
    steps = Steps(first=0.03, most=1.0, scale=start.p)
    ends = 0.0, max(target, 1.5 * start.p)
    for count, point in enumerate(follow(problem, start, steps, ends)):
        if last.p < target <= point.p:
            near = located(problem, last, point, lambda at: at.p - target, start.p, _NEAR)
            solved = near and solved_at(problem, near.u, target)
            if solved:
                return spinning_state(problem, solved[0], target)
        last, problem = point, problem.referred_to(point.u)
        if count > _MOST_STEPS:
            break
    return NotFound(
        f"the spinning branch begins at force {start.p:.6g} and was followed to {last.p:.6g}"
        f" without coming up to {target:.6g}; ask for a larger force, or give a run that spins as a"
        " guess"
    )


def spinning_family(state: Spinning, parameter: str, scale: float) -> Family[Spinning]:
    """Return the family of a spinning state along a parameter."""
    problem = TurningShape(state.model, parameter, state.unknowns, abs(state.rate))
    return Family(parameter, problem, spinning_state, _named, scale)


def _named(state: Spinning, index: int) -> str:
    return "torus" if state.exponents[index].imag != 0.0 else "symmetry breaking"


def spinning_judge(
    model: Model,  # noqa: ARG001
    parameter: str,  # noqa: ARG001
) -> Callable[[TurningShape, Array, float], Spinning]:
    """Return the function from a problem along a parameter and its solution to the state."""
    return spinning_state


def spinning_unknowns(state: Spinning) -> Array:
    """Return the unknowns of a state in the equations of its family."""
    return np.append(state.unknowns, state.rate)
