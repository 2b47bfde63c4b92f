"""Solutions of a branch at a value of its parameter: followed, bracketed and solved for.

A branch is followed in steps by its arclength. A step that passes the value upwards brackets it;
the branch is located there to a small share of the scale, where Newton's method at the value itself
converges.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from undula.arrays import Array
from undula.numerics.continuation.arclength import Point, Steps, solve_at, trace
from undula.numerics.continuation.locate import locate

# Share of the scale of the parameter to which the value is approached before it is solved for.
_NEAR = 1e-3


@dataclass(frozen=True)
class BranchStep:
    """A step along a branch.

    Attributes
    ----------
    problem : Problem
        The equations, referred to the point before.
    before, after : Point
        Neighbours on the branch.
    """

    problem: Any
    before: Point
    after: Point

    def passes(self, value: float) -> bool:
        """Return whether the parameter rises through a value, or to it."""
        return self.before.p < value <= self.after.p

    def solution_at(self, value: float, scale: float) -> Array | None:
        """Return the solution at a value that the step passes.

        Parameters
        ----------
        value : float
            Value of the parameter, within the step.
        scale : float
            Change of the parameter that counts as 1.

        Returns
        -------
        ndarray of shape (m,) or None
            None if Newton's method finds no solution at the value.
        """

        def distance(point: Point) -> float:
            return point.p - value

        near = locate(self.problem, self.before, self.after, distance, scale, _NEAR)
        solved = near and solve_at(self.problem, near.u, value)
        return solved[0] if solved else None


@dataclass(frozen=True)
class Reached:
    """The end of a branch that was followed to a value of its parameter.

    Attributes
    ----------
    p : float
        The parameter at the last point.
    problem : Problem
        The equations, referred to the point before the value.
    u : ndarray of shape (m,) or None
        The solution at the value; None if the branch did not rise to it.
    """

    p: float
    problem: Any
    u: Array | None


def steps_along(
    problem: Any, start: Point, steps: Steps, ends: tuple[float, float]
) -> Iterator[BranchStep]:
    """Yield the steps of a branch from a point on; arguments are those of `arclength.trace`."""
    before = start
    for after in trace(problem, start, steps, ends):
        yield BranchStep(problem, before, after)
        before, problem = after, problem.with_reference(after.u)


def reach_value(
    problem: Any,
    start: Point,
    steps: Steps,
    ends: tuple[float, float],
    value: float,
    most_steps: int,
) -> Reached:
    """Follow a branch until it rises to a value of its parameter, and solve for it there.

    Parameters
    ----------
    problem : Problem
        Equations of the branch.
    start : Point
        A solution; its tangent gives the direction.
    steps : Steps
        Sizes of the steps in arclength.
    ends : (float, float)
        Least and largest parameter that the branch may take.
    value : float
        The value, within `ends`. Where a solution is not found, the branch is followed on.
    most_steps : int
        Number of steps after which the search ends.

    Returns
    -------
    Reached
    """
    p = start.p
    for count, step in enumerate(steps_along(problem, start, steps, ends)):
        if step.passes(value):
            u = step.solution_at(value, steps.scale)
            if u is not None:
                return Reached(step.after.p, step.problem, u)
        p = step.after.p
        if count > most_steps:
            break
    return Reached(p, problem, None)
