"""States of a kind at given forces, read off its branch, which is followed once.

The branch is followed from the Hopf point on by its arclength, and neither judged nor searched for
bifurcations on the way: only where it comes up to one of the forces is a state solved for.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from undula.analysis.parameters import FORCE
from undula.analysis.solvers.state_kinds import kind_by_name
from undula.analysis.states.follow_branch import UnresolvedError
from undula.analysis.states.not_found import NotFound, SearchStatus
from undula.arrays import Array
from undula.models.model import Model
from undula.numerics.continuation.arclength import Point, Steps, advance, follow, located, solved_at
from undula.numerics.continuation.problem import Problem

# Arclength between a Hopf point and the first point of a branch.
_AWAY = 0.03
# A branch that has not come to the last force after so many steps will hardly do so.
_MOST_STEPS = 1000
# The way to the last force counts as so many units of length, and the Hopf force as one at least.
_PARTS = 8.0
# A branch that is born downwards has come up again below this multiple of the Hopf force.
_UPWARDS = 1.5
# Where Newton's method does not get from a step to a force in it, that force is approached to this
# share of the scale first.
_NEAR = 1e-3


def states_along(
    model: Model,
    kind: str,
    forces: Sequence[float],
    progress: Callable[[float], None] | None = None,
) -> dict[float, Any]:
    """Return the states of a kind at forces, where its branch comes up to them.

    A branch that folds is read off where it goes upwards; where it does so more than once at a
    force, a stable state is preferred to an unstable one.

    Parameters
    ----------
    model : Model
        Its own force does not matter.
    kind : {"spinning", "flapping"}
    forces : sequence of float
        In the model's unit of force, in any order.
    progress : callable, optional
        Called with each force that was reached.

    Returns
    -------
    dict
        For each force a state; or `NotFound`, if the branch ought to reach it and was not followed
        so far; or no entry, where the branch begins beyond it.

    Raises
    ------
    InputError
        There is no such kind.
    """
    chosen = kind_by_name(kind)
    began = chosen.start(model)
    if began is None or not forces:
        return {}
    problem, hopf = began
    last = max(forces)
    scale = min(hopf.p, abs(last - hopf.p) / _PARTS) or hopf.p
    reading = _Reading(forces, scale, chosen.judge(model, FORCE))
    reached = hopf.p
    try:
        for along, before, after in _steps(problem, hopf, last, scale):
            reading.note(along, before, after)
            reached = after.p
            if progress:
                progress(reached)
    except UnresolvedError:
        pass  # what was read off so far holds
    followed = f"the branch of {kind} from force {hopf.p:.6g} on was followed to {reached:.6g}"
    missing = NotFound(SearchStatus.NOT_REACHED, followed)
    return {force: missing for force in forces if force > hopf.p} | reading.preferred()


def _steps(
    problem: Problem, hopf: Point, last: float, scale: float
) -> Iterator[tuple[Problem, Point, Point]]:
    """Yield the steps of a branch until it has come up to the last force, with their problems."""
    first = advance(problem, hopf, _AWAY, scale)
    if first is None or (first.p > hopf.p and last <= hopf.p):
        return
    yield problem, hopf, first
    point, problem = first, problem.referred_to(first.u)
    steps, ends = Steps(first=_AWAY, scale=scale), (0.0, max(last, _UPWARDS * hopf.p))
    for count, reached in enumerate(follow(problem, point, steps, ends)):
        yield problem, point, reached
        if point.p < reached.p >= last or count > _MOST_STEPS:
            return
        point, problem = reached, problem.referred_to(reached.u)


@dataclass(frozen=True)
class _Reading:
    """States that steps of a branch pass on their way upwards, by force."""

    forces: Sequence[float]
    scale: float
    judge: Callable[[Any, Array, float], Any]
    states: dict[float, list[Any]] = field(default_factory=dict)

    def note(self, problem: Problem, before: Point, after: Point) -> None:
        """Solve for the states at the forces that a step passes."""
        for force in self.forces:
            if before.p < force <= after.p:
                u = self._solution(problem, before, after, force)
                if u is not None:
                    self.states.setdefault(force, []).append(self.judge(problem, u, force))

    def preferred(self) -> dict[float, Any]:
        """Return one state for each force, a stable one if there is one."""
        return {
            force: next((state for state in states if state.stable), states[0])
            for force, states in self.states.items()
        }

    def _solution(
        self, problem: Problem, before: Point, after: Point, force: float
    ) -> Array | None:
        """Return the solution at a force between two neighbours on a branch, if it is found."""
        if force == after.p:
            return after.u
        share = (force - before.p) / (after.p - before.p)
        solved = solved_at(problem, before.u + share * (after.u - before.u), force)
        if solved is None or not _lies_between(problem, before, after, solved[0]):
            near = located(problem, before, after, lambda at: at.p - force, self.scale, _NEAR)
            solved = solved_at(problem, near.u, force) if near else None
        return solved[0] if solved else None


def _lies_between(problem: Problem, before: Point, after: Point, u: Array) -> bool:
    """Tell whether a solution is about as near to two points as they are to one another.

    If not, Newton's method has led to another state.
    """
    apart = problem.weights @ (after.u - before.u) ** 2
    # Steps turn by a right angle at most, so that no point between is farther than this.
    return all(problem.weights @ (u - point.u) ** 2 <= 2.0 * apart for point in (before, after))
