"""States of a kind at given forces, taken from its branch, which is followed once.

The branch is followed from the Hopf point by its arclength, without judging its points or locating
its bifurcations. A state is solved for only where the branch rises through one of the forces.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from undula.analysis.parameters import FORCE
from undula.analysis.solvers.reach_value import BranchStep, steps_along
from undula.analysis.solvers.state_kinds import kind_by_name
from undula.analysis.states.follow_branch import UnresolvedError
from undula.analysis.states.not_found import NotFound, SearchStatus
from undula.arrays import Array
from undula.models.model import Model
from undula.numerics.continuation.arclength import Point, Steps, advance, solve_at
from undula.numerics.continuation.problem import Problem

# Arclength between a Hopf point and the first point of a branch.
_FIRST_STEP = 0.03
# Number of steps after which a branch that has not reached the last force is given up.
_MOST_STEPS = 1000
# The distance to the last force is at most this number of units of length; a unit is at most the
# Hopf force.
_UNITS = 8.0
# A subcritical branch has risen through the onset again below this multiple of the Hopf force.
_ABOVE_ONSET = 1.5


def states_along(
    model: Model,
    kind: str,
    forces: Sequence[float],
    progress: Callable[[float], None] | None = None,
) -> dict[float, Any]:
    """Return the states of a kind at forces through which its branch rises.

    Where the branch folds and rises through a force more than once, a stable state is preferred to
    an unstable one.

    Parameters
    ----------
    model : Model
        Its own force does not matter.
    kind : {"spinning", "flapping"}
        Kind of the states.
    forces : sequence of float
        In the model's unit of force, in any order.
    progress : callable, optional
        Called with each force that was reached.

    Returns
    -------
    dict
        For each force a state; or `NotFound`, if the branch was not followed to a force beyond the
        onset; or no entry, where the branch begins beyond the force.

    Raises
    ------
    InputError
        There is no such kind.
    """
    chosen = kind_by_name(kind)
    start = chosen.start(model)
    if start is None or not forces:
        return {}
    problem, hopf = start
    last = max(forces)
    scale = min(hopf.p, abs(last - hopf.p) / _UNITS) or hopf.p
    crossings = _Crossings(forces, scale, chosen.judge(model, FORCE))
    reached = hopf.p
    try:
        for step in _steps(problem, hopf, last, scale):
            crossings.add(step)
            reached = step.after.p
            if progress:
                progress(reached)
    except UnresolvedError:
        pass  # the states found so far are valid
    followed = f"the branch of {kind} from force {hopf.p:.6g} on was followed to {reached:.6g}"
    missing = NotFound(SearchStatus.NOT_REACHED, followed)
    return {force: missing for force in forces if force > hopf.p} | crossings.preferred()


def _steps(problem: Problem, hopf: Point, last: float, scale: float) -> Iterator[BranchStep]:
    """Yield the steps of a branch until it has risen to the last force."""
    first = advance(problem, hopf, _FIRST_STEP, scale)
    if first is None or (first.p > hopf.p and last <= hopf.p):
        return
    yield BranchStep(problem, hopf, first)
    steps, ends = Steps(first=_FIRST_STEP, scale=scale), (0.0, max(last, _ABOVE_ONSET * hopf.p))
    for count, step in enumerate(steps_along(problem.with_reference(first.u), first, steps, ends)):
        yield step
        if step.before.p < step.after.p >= last or count > _MOST_STEPS:
            return


@dataclass(frozen=True)
class _Crossings:
    """States at the forces through which steps of a branch rise."""

    forces: Sequence[float]
    scale: float
    judge: Callable[[Any, Array, float], Any]
    states: dict[float, list[Any]] = field(default_factory=dict)

    def add(self, step: BranchStep) -> None:
        """Solve for the states at the forces that a step passes."""
        for force in self.forces:
            if step.passes(force):
                u = self._solution(step, force)
                if u is not None:
                    self.states.setdefault(force, []).append(self.judge(step.problem, u, force))

    def preferred(self) -> dict[float, Any]:
        """Return for each force a stable state, if the branch has one, else the first."""
        return {
            force: next((state for state in states if state.stable), states[0])
            for force, states in self.states.items()
        }

    def _solution(self, step: BranchStep, force: float) -> Array | None:
        """Return the solution at a force that a step passes, if there is one."""
        before, after = step.before, step.after
        if force == after.p:
            return after.u
        share = (force - before.p) / (after.p - before.p)
        # Many forces may lie in one step: a solve from the chord saves locating the branch at each.
        solved = solve_at(step.problem, before.u + share * (after.u - before.u), force)
        if solved is not None and _lies_between(step, solved[0]):
            return solved[0]
        return step.solution_at(force, self.scale)


def _lies_between(step: BranchStep, u: Array) -> bool:
    """Return whether a solution is about as near to both ends of a step as they are to each other.

    If not, Newton's method has led to another state.
    """
    weights, ends = step.problem.weights, (step.before, step.after)
    length = weights @ (step.after.u - step.before.u) ** 2
    # Steps turn by a right angle at most, so that no point between is farther than this.
    return all(weights @ (u - point.u) ** 2 <= 2.0 * length for point in ends)
