"""Solutions on a branch of states: located to round-off, each with its error."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from undula.analysis.parameters import changed
from undula.analysis.solvers.inverse.branch_interval import (
    ARCLENGTH_TOLERANCE,
    BranchInterval,
    BranchSample,
)
from undula.analysis.solvers.inverse.branch_search import (
    Beginning,
    Question,
    SearchedBranch,
    followed,
)
from undula.analysis.solvers.inverse.crossings import crossings
from undula.analysis.solvers.inverse.solutions import Solution
from undula.analysis.solvers.inverse.targets import solver_error_of
from undula.analysis.solvers.state_kinds import kind_of_state
from undula.analysis.states.extrapolation import error_of_links
from undula.analysis.states.not_found import NotFound
from undula.models.model import Model
from undula.numerics.continuation.arclength import Point, with_tangent

# Difference from the target that counts as none, relative to the target, or for a target of 0 to
# the largest modulus of the quantity on the branch.
_ROUND_OFF = 1e-10
# Relative difference from the target, as above, of a state that is solved for at the value alone.
_SAME_STATE = 1e-7
# Difference of two values that are one solution, relative to the range.
_SAME_VALUE = 1e-10
# Number of steps along the branch of other links within which the target is passed.
_STEPS_ON_OTHER_LINKS = 12


def branch_solutions(question: Question, branch: SearchedBranch) -> tuple[Solution, ...]:
    """Return the solutions on the branch of a question, by rising value.

    Parameters
    ----------
    question : Question
        The target, and the range of the parameter.
    branch : SearchedBranch
        The branch in that range.

    Returns
    -------
    tuple of Solution
        Fewer if the search is stopped.
    """
    size = _size(question, branch)
    low, high = question.between
    solutions: list[Solution] = []
    for interval, sample in _crossings(branch, _ROUND_OFF * size):
        value = sample.point.p
        # Two parts of a branch that begin at one point share it.
        if all(abs(value - other.value) > _SAME_VALUE * (high - low) for other in solutions):
            solutions.append(_solution(question, interval, sample, size))
        if question.progress:
            question.progress(value)
        if question.stop():
            break
    return tuple(sorted(solutions, key=lambda solution: solution.value))


def _size(question: Question, branch: SearchedBranch) -> float:
    """Return the magnitude of the quantity, against which round-off is measured."""
    quantities = [abs(sample.quantity) for sample in branch.samples]
    return abs(question.target.value) or max(quantities, default=1.0)


def _crossings(branch: SearchedBranch, tolerance: float) -> Iterator[tuple[BranchInterval, Any]]:
    for run in branch.runs:
        yield from crossings(run.intervals, tolerance)


def _solution(
    question: Question, interval: BranchInterval, sample: BranchSample, size: float
) -> Solution:
    """Return the record of a point at which the quantity has its target."""
    target, value = question.target, sample.point.p
    state = _solved_alone(question, sample, _SAME_STATE * size)
    slope = interval.equations.slope_at(sample.point)
    of_quantity = abs(target.of(state) - target.value) + solver_error_of(state, target)
    scale = interval.equations.family.scale
    solver_error = ARCLENGTH_TOLERANCE * scale + of_quantity / abs(slope)

    def again(other: Model) -> float | None:
        return _value_on(other, question, interval)

    by_links = error_of_links(state.model, value, again)
    return Solution(
        parameter=question.parameter,
        value=value,
        error=None if by_links is None else by_links + solver_error,
        solver_error=solver_error,
        quantity=target.quantity,
        target=target.value,
        slope=slope,
        links=state.model.links,
        state=state,
    )


def _solved_alone(question: Question, sample: BranchSample, tolerance: float) -> Any:
    """Return the state solved for at the value alone; the branch's own if that is another.

    At a fold the equations at a fixed value are singular.
    """
    model = sample.state.model
    state = kind_of_state(sample.state).find(model, sample.state)
    if isinstance(state, NotFound) or abs(question.target.of(state) - sample.quantity) > tolerance:
        return sample.state
    return state


def _value_on(other: Model, question: Question, interval: BranchInterval) -> float | None:
    """Return the same solution on other links; None if it is not found."""
    before, scale = interval.before, interval.equations.family.scale
    parameter, value = question.parameter, before.point.p
    solver = kind_of_state(before.state)
    state = solver.find(changed(other, parameter, value), before.state)
    if isinstance(state, NotFound):
        return None
    family, u = solver.family(state, parameter, scale), solver.unknowns(state)
    problem = family.problem.with_reference(u)
    # The target may lie on the other side of the same point for other links.
    passed = np.sign(question.target.of(state) - question.target.value) != np.sign(before.miss)
    side = np.sign(before.point.tangent_p) * (-1.0 if passed else 1.0)
    point = with_tangent(problem, Point(u, value, np.zeros_like(u), side * scale), scale)
    beginning = Beginning(family, point, (-np.inf, np.inf), first=min(0.1, interval.length))
    alone = replace(question, progress=None, stop=lambda: False)
    for number, part in enumerate(followed(beginning, alone)):
        if part.before.miss * part.after.miss <= 0.0:
            zero = part.zero()
            return None if zero is None else zero.point.p
        if number >= _STEPS_ON_OTHER_LINKS:
            break
    return None
