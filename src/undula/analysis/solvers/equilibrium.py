"""Search for bent shapes at rest: equilibria of a naturally curved filament under its load.

    f(x, z) = 0,    g(x, z) = 0

in the unknowns y = (x, z). Without natural curvature the straight filament is the only equilibrium.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Self

import numpy as np

from undula.analysis.parameters import FORCE, changed, neighbours
from undula.analysis.solvers.reach_value import reach_value
from undula.analysis.states.follow_branch import Family
from undula.analysis.states.not_found import NotFound, SearchStatus
from undula.analysis.states.records import Equilibrium
from undula.analysis.states.relative_equilibrium import rotating_spectrum
from undula.arrays import Array
from undula.errors import InputError
from undula.models.initial_states import from_state
from undula.models.model import Model
from undula.numerics.continuation.arclength import Point, Steps, solve_at, with_tangent
from undula.numerics.continuation.problem import Evaluation
from undula.numerics.linalg.bordered import BorderedBand

# Largest number of steps along a branch towards a force.
_MOST_STEPS = 400
# Change of the force that counts as 1 in steps from no load [B/L^2].
_FORCE_SCALE = 40.0


@dataclass(frozen=True)
class RestingShape:
    """Equations of an equilibrium: a `undula.numerics.continuation.problem.Problem`.

    Attributes
    ----------
    model : Model
    parameter : str
        Name of the parameter that the problem depends on, such as "load.force".
    """

    model: Model
    parameter: str

    @property
    def weights(self) -> Array:
        """Weights (n,) of a mean square of positions."""
        moving = self.model.equations.differential
        return np.asarray(moving / np.count_nonzero(moving))

    def with_reference(self, u: Array) -> Self:  # noqa: ARG002
        """Return the problem itself, which has no symmetry."""
        return self

    def evaluate(self, u: Array, p: float) -> Evaluation:
        """Return residual and derivatives at (u, p)."""
        at_rest = np.zeros(u.size)
        equations = changed(self.model, self.parameter, p).equations
        below, above, width = neighbours(self.model, self.parameter, p)
        less, more = (side.equations.residual(u, at_rest) for side in (below, above))
        no_border = np.zeros((u.size, 0)), np.zeros((0, u.size)), np.zeros((0, 0))
        linear = BorderedBand(equations.parts(u, at_rest, 0.0)[0], *no_border)
        return Evaluation(equations.residual(u, at_rest), linear, (more - less) / width)


def find_equilibrium(model: Model, guess: Equilibrium | None = None) -> Equilibrium | NotFound:
    """Solve for the shape in which a naturally curved filament rests.

    The shape without load is followed to the model's force by pseudo-arclength continuation.

    Parameters
    ----------
    model : Model
        With natural curvature, or unequal bending stiffnesses.
    guess : Equilibrium, optional
        The state of a similar model, with any number of links, from which Newton's method begins
        instead.

    Returns
    -------
    Equilibrium or NotFound
        The latter states how far the search got, and what to try.

    Raises
    ------
    InputError
        The model has no directors, so that it is straight at rest.

    Examples
    --------
    >>> import undula as un
    >>> curved = un.Filament(8, un.TipLoad(10.0), natural_curvature=(1.0, 0.0))
    >>> state = un.find(curved, "equilibrium")
    >>> state.stable, state.frequency
    (True, 0.0)
    """
    _require_directors(model)
    problem = RestingShape(model, FORCE)
    if guess is not None:
        y = model.unknowns(model.admissible(from_state(model, guess.nodes)))
        solved = solve_at(problem, y, model.load.force)
        if solved is None:
            return NotFound(
                SearchStatus.NOT_CONVERGED,
                "Newton's method finds no equilibrium from the guess",
                "leave it out",
            )
        return equilibrium_state(problem, solved[0], model.load.force)
    return _followed(problem)


def unloaded(model: Model) -> Array:
    """Return the unknowns (n,) of the shape without load, in which nothing is bent."""
    unforced = changed(model, FORCE, 0.0)
    return np.asarray(unforced.unknowns(unforced.rest()))


def equilibrium_state(problem: RestingShape, u: Array, p: float) -> Equilibrium:
    """Return the record of the solution u (n,) of a problem at a parameter."""
    model = changed(problem.model, problem.parameter, p)
    residual = model.equations.residual(u, np.zeros(u.size))
    return Equilibrium(model, u, float(np.abs(residual).max()), rotating_spectrum(model, u, 0.0))


def equilibrium_family(state: Equilibrium, parameter: str, scale: float) -> Family[Equilibrium]:
    """Return the family of an equilibrium along a parameter; a change by `scale` counts as 1."""
    problem = RestingShape(state.model, parameter)
    return Family(parameter, problem, equilibrium_state, _bifurcation_kind, scale)


def equilibrium_judge(
    model: Model,  # noqa: ARG001
    parameter: str,  # noqa: ARG001
) -> Callable[[RestingShape, Array, float], Equilibrium]:
    """Return the function from a problem, a solution of it and the parameter to the state."""
    return equilibrium_state


def equilibrium_unknowns(state: Equilibrium) -> Array:
    """Return the unknowns (n,) of a state in the equations of its family."""
    return state.unknowns


def equilibrium_start(model: Model) -> tuple[RestingShape, Point]:
    """Return the problem in the force and the unloaded shape at which the branch begins.

    Raises
    ------
    InputError
        The model has no directors, so that it is straight at rest.
    """
    _require_directors(model)
    problem, u = RestingShape(model, FORCE), unloaded(model)
    flat = Point(u, 0.0, np.zeros_like(u), _FORCE_SCALE)
    return problem, with_tangent(problem, flat, _FORCE_SCALE)


def _require_directors(model: Model) -> None:
    if model.axisymmetric:
        raise InputError(
            "a filament without natural curvature is straight at rest: ask for its spectrum or its"
            " critical force, or follow the straight state"
        )


def _followed(problem: RestingShape) -> Equilibrium | NotFound:
    """Return the equilibrium at the model's force, on the branch from the unloaded shape."""
    target = problem.model.load.force
    _, start = equilibrium_start(problem.model)
    if target == 0.0:
        return equilibrium_state(problem, start.u, 0.0)
    steps = Steps(first=0.05, most=0.5, scale=_FORCE_SCALE)
    ends = min(0.0, 1.5 * target), max(0.0, 1.5 * target)
    reached = reach_value(problem, start, steps, ends, target, _MOST_STEPS)
    if reached.u is not None:
        return equilibrium_state(problem, reached.u, target)
    return NotFound(
        SearchStatus.NOT_REACHED,
        f"the shape without load was followed to force {reached.p:.6g} without coming up to"
        f" {target:.6g}",
        "ask for a smaller force",
    )


def _bifurcation_kind(state: Equilibrium, index: int) -> str:
    return "Hopf" if state.exponents[index].imag != 0.0 else "branch point"
