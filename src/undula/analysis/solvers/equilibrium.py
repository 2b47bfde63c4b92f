"""Bent shapes at rest: equilibria of a filament that is curved by nature, under its load.

    f(x, z) = 0,    g(x, z) = 0

in the unknowns y = (x, z). Without natural curvature the straight filament is the only one.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Self

import numpy as np

from undula.analysis.parameters import FORCE, changed, neighbours
from undula.analysis.states.follow_branch import Family
from undula.analysis.states.records import FixedShape, NotFound
from undula.analysis.states.relative_equilibrium import rotating_spectrum
from undula.arrays import Array, ComplexArray
from undula.errors import InputError
from undula.models.initial_states import from_state
from undula.models.model import Model
from undula.numerics.continuation.arclength import (
    Point,
    Steps,
    follow,
    located,
    solved_at,
    with_tangent,
)
from undula.numerics.continuation.problem import Evaluation
from undula.numerics.linalg.bordered import BorderedBand

# A branch that has not come to the force after so many steps will hardly do so.
_MOST_STEPS = 400
# Force by which the first step from no load is measured [B/L^2].
_FIRST_SCALE = 40.0
# The target is approached to this share of its size before it is solved for.
_NEAR = 1e-3


@dataclass(frozen=True)
class Equilibrium(FixedShape):
    """A shape at rest.

    Attributes
    ----------
    model : Model
    unknowns : ndarray of shape (n,)
        Positions and multipliers.
    residual : float
        Largest force that is not in balance [B/L^2].
    exponents : ndarray of shape (k,)
        Growth rates and angular frequencies of disturbances [1/T], by falling real part.
    error : float or None
        None: a shape at rest has no frequency to be wrong.
    """

    model: Model
    unknowns: Array
    residual: float
    exponents: ComplexArray
    error: float | None = None

    @property
    def frequency(self) -> float:
        """Cycles per T: none."""
        return 0.0

    @property
    def power_balance_error(self) -> float:
        """Nothing moves: 0."""
        return 0.0

    def __str__(self) -> str:
        """Tell it in one line."""
        word = "stable" if self.stable else "unstable"
        return (
            f"at rest under force {self.force:.6g}: {word}, leading rate {self.leading_rate:.4g}"
            f" /T, tip {self.tip_radius:.4g} L off the axis"
        )


@dataclass(frozen=True)
class RestingShape:
    """Equations of an equilibrium: a `undula.numerics.continuation.problem.Problem`."""

    model: Model
    parameter: str

    @property
    def weights(self) -> Array:
        """A mean square of positions."""
        moves = self.model.equations.differential
        return np.asarray(moves / np.count_nonzero(moves))

    def referred_to(self, u: Array) -> Self:  # noqa: ARG002
        """Return the problem itself, which has no symmetry."""
        return self

    def evaluate(self, u: Array, p: float) -> Evaluation:
        """Return residual and derivatives at (u, p)."""
        still = np.zeros(u.size)
        equations = changed(self.model, self.parameter, p).equations
        below, above, width = neighbours(self.model, self.parameter, p)
        less, more = (side.equations.residual(u, still) for side in (below, above))
        no_border = np.zeros((u.size, 0)), np.zeros((0, u.size)), np.zeros((0, 0))
        linear = BorderedBand(equations.parts(u, still, 0.0)[0], *no_border)
        return Evaluation(equations.residual(u, still), linear, (more - less) / width)


def find_equilibrium(model: Model, guess: Equilibrium | None = None) -> Equilibrium | NotFound:
    """Solve for the shape in which a naturally curved filament rests.

    Parameters
    ----------
    model : Model
    guess : Equilibrium, optional
        The state of a similar model, with any number of links. Without one the shape without any
        load is followed to the model's force.

    Returns
    -------
    Equilibrium or NotFound

    Raises
    ------
    InputError
        The model has no directors, so that it is straight at rest.
    """
    _require_directors(model)
    problem = RestingShape(model, FORCE)
    if guess is not None:
        y = model.unknowns(model.admissible(from_state(model, guess.nodes)))
        solved = solved_at(problem, y, model.load.force)
        if solved is None:
            return NotFound("Newton's method finds no equilibrium from the guess; leave it out")
        return equilibrium_state(problem, solved[0], model.load.force)
    return _followed(problem)


def unloaded(model: Model) -> Array:
    """Return the unknowns (n,) of the shape without load, in which nothing is bent."""
    free = changed(model, FORCE, 0.0)
    return np.asarray(free.unknowns(free.rest()))


def equilibrium_state(problem: RestingShape, u: Array, p: float) -> Equilibrium:
    """Return the state that solves a problem, judged."""
    model = changed(problem.model, problem.parameter, p)
    left = model.equations.residual(u, np.zeros(u.size))
    return Equilibrium(model, u, float(np.abs(left).max()), rotating_spectrum(model, u, 0.0))


def equilibrium_family(state: Equilibrium, parameter: str, scale: float) -> Family[Equilibrium]:
    """Return the family of an equilibrium along a parameter."""
    return Family(parameter, RestingShape(state.model, parameter), equilibrium_state, _named, scale)


def equilibrium_judge(
    model: Model,  # noqa: ARG001
    parameter: str,  # noqa: ARG001
) -> Callable[[RestingShape, Array, float], Equilibrium]:
    """Return the function from a problem along a parameter and its solution to the state."""
    return equilibrium_state


def equilibrium_unknowns(state: Equilibrium) -> Array:
    """Return the unknowns of a state in the equations of its family."""
    return state.unknowns


def equilibrium_start(model: Model) -> tuple[RestingShape, Point]:
    """Return the problem in the force and the unloaded shape at which the branch begins."""
    _require_directors(model)
    problem, u = RestingShape(model, FORCE), unloaded(model)
    flat = Point(u, 0.0, np.zeros_like(u), _FIRST_SCALE)
    return problem, with_tangent(problem, flat, _FIRST_SCALE)


def _require_directors(model: Model) -> None:
    if model.axisymmetric:
        raise InputError(
            "a filament without natural curvature is straight at rest: ask for its spectrum or its"
            " critical force, or follow the straight state"
        )


def _followed(problem: RestingShape) -> Equilibrium | NotFound:
    """Return the equilibrium at the model's force, on the branch from the unloaded shape."""
    target = problem.model.load.force
    _, last = equilibrium_start(problem.model)
    if target == 0.0:
        return equilibrium_state(problem, last.u, 0.0)
    steps = Steps(first=0.05, most=0.5, scale=_FIRST_SCALE)
    ends = min(0.0, 1.5 * target), max(0.0, 1.5 * target)
    for count, point in enumerate(follow(problem, last, steps, ends)):
        if last.p < target <= point.p:
            near = located(problem, last, point, lambda at: at.p - target, _FIRST_SCALE, _NEAR)
            solved = near and solved_at(problem, near.u, target)
            if solved:
                return equilibrium_state(problem, solved[0], target)
        last = point
        if count > _MOST_STEPS:
            break
    return NotFound(
        f"the shape without load was followed to force {last.p:.6g} without coming up to"
        f" {target:.6g}; ask for a smaller force"
    )


def _named(state: Equilibrium, index: int) -> str:
    return "Hopf" if state.exponents[index].imag != 0.0 else "branch point"
