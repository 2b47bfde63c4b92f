"""Derivatives of the quantities of a solved state by a parameter, along its branch.

A state solves r(u; p) = 0. By the implicit-function theorem its branch has the direction

    du/dp = -(dr/du)^-1 dr/dp,

one linear solve with the matrix of Newton's method. Quantities are differentiated along it by a
central difference. The curvature of the branch, which the direction leaves out, is even in the step
and cancels.

At a fold of the branch along the force F the matrix is singular. The fold stays one if its force
follows the other parameter, so that

    (dr/du) du/dp + (dr/dF) dF/dp = -dr/dp,    <t, du/dp> = 0

with the null vector t, a system that is regular there.
"""

from collections.abc import Callable, Mapping

import numpy as np

from undula.analysis.parameters import FORCE, changed, value_of
from undula.analysis.solvers.quantities import quantities_of
from undula.analysis.solvers.state_kinds import Solved, kind_of_state
from undula.arrays import Array
from undula.errors import InputError
from undula.models.model import Model
from undula.numerics.continuation.problem import Linear

#: Step of a difference, relative to the parameter or to 1 where that is more: its square, and the
#: round-off of exponents over it, are both some 1e-9.
RELATIVE_STEP = 3e-5

#: From a state to its numbers by name.
Quantities = Callable[[Solved], Mapping[str, float]]


def state_slopes(
    state: Solved, parameter: str, quantities: Quantities = quantities_of
) -> dict[str, float]:
    """Return the derivative of each quantity of a state by a parameter.

    Parameters
    ----------
    state : Spinning, Flapping, Equilibrium or Periodic
        A state that is no fold of its branch along the parameter.
    parameter : str
        Name of a number, or of a value of a table.
    quantities : callable
        From a state to its quantities by name.

    Returns
    -------
    dict of str to float
        Derivatives by name, in the units of the quantity and of the parameter.

    Raises
    ------
    InputError
        The parameter is not one of the model.
    LinAlgError
        The state is a fold.
    """
    kind, value = kind_of_state(state), value_of(state.model, parameter)
    step = RELATIVE_STEP * max(1.0, abs(value))
    family = kind.family(state, parameter, step)
    u = kind.unknowns(state)
    evaluation = family.problem.evaluate(u, value)
    direction = -_solution(evaluation.linear, evaluation.by_parameter)
    rows = []
    places = _places(state.model, parameter, value, step)
    for place in places:
        moved = u + place * step * direction
        rows.append(quantities(family.judge(family.problem, moved, value + place * step)))
    weights = _weights(np.array(places)) / step
    return {name: float(weights @ np.array([row[name] for row in rows])) for name in rows[0]}


def fold_slope(state: Solved, parameter: str) -> float:
    """Return the derivative of the force of a fold by another parameter.

    Parameters
    ----------
    state : Spinning, Flapping, Equilibrium or Periodic
        The state at a fold of its branch along the force.
    parameter : str
        Name of a number or of a value of a table, not the force.

    Returns
    -------
    float
        In B/L^2 per unit of the parameter.

    Raises
    ------
    InputError
        The parameter is not one of the model.
    """
    kind, u = kind_of_state(state), kind_of_state(state).unknowns(state)
    by_force = kind.family(state, FORCE, 1.0).problem.evaluate(u, state.force)
    value = value_of(state.model, parameter)
    right = kind.family(state, parameter, 1.0).problem.evaluate(u, value).by_parameter
    # Any row that is not orthogonal to the null vector gives that vector, up to its length.
    row = np.cos(np.arange(u.size))
    none = np.zeros(u.size)
    null, _ = by_force.linear.solve(by_force.by_parameter, row, 0.0, none, 1.0)
    return by_force.linear.solve(by_force.by_parameter, null, 0.0, -right, 0.0)[1]


def _places(model: Model, parameter: str, value: float, step: float) -> tuple[float, ...]:
    """Return the places of a difference, in steps: on one side at an end of the range."""
    for places in ((-1.0, 1.0), (0.0, 1.0, 2.0), (0.0, -1.0, -2.0)):
        try:
            for place in places:
                changed(model, parameter, value + place * step)
        except InputError:
            continue
        return places
    raise InputError(f"{parameter} = {value:g} has no neighbours in its range to compare with")


def _weights(places: Array) -> Array:
    """Return the weights of values at places (k,) in the derivative at 0 of their polynomial."""
    powers = np.vander(places, increasing=True).T
    unit = np.zeros(places.size)
    unit[1] = 1.0
    return np.asarray(np.linalg.solve(powers, unit))


def _solution(linear: Linear, right: Array) -> Array:
    """Return the solution of the linearised problem without a border."""
    none = np.zeros(right.size)
    return linear.solve(none, none, 1.0, right, 0.0)[0]
