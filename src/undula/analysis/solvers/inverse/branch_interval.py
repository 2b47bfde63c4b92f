"""An interval of a branch of states, on which a quantity is compared with its target."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Self

import numpy as np

from undula.analysis.solvers.inverse.targets import Target
from undula.analysis.states.follow_branch import Family, UnresolvedError
from undula.numerics.continuation.arclength import Point, advance
from undula.numerics.continuation.locate import locate

#: Tolerance of the arclength of a solution: round-off.
ARCLENGTH_TOLERANCE = 1e-12
# Arclength on both sides of a solution over which the slope of the quantity is a difference.
_DIFFERENCE = 1e-4


@dataclass(frozen=True)
class Equations:
    """Equations of a branch next to a point, and the target on it.

    Attributes
    ----------
    family : Family
        Records of the solutions.
    problem : Problem
        The equations, referred to the point.
    target : Target
        The target of the quantity.
    """

    family: Family[Any]
    problem: Any
    target: Target

    def sample(self, point: Point) -> "BranchSample":
        """Return a point of the branch with its state and its quantity."""
        try:
            state = self.family.judge(self.problem, point.u, point.p)
        except UnresolvedError:
            return BranchSample(point, None, np.nan, np.nan)
        quantity = float(self.target.of(state))
        return BranchSample(point, state, quantity, quantity - self.target.value)

    def advanced(self, start: Point, length: float) -> "BranchSample | None":
        """Return the point of the branch at an arclength from a point; None if it is not found."""
        point = advance(self.problem, start, length, self.family.scale)
        return None if point is None else self.sample(point)

    def slope_at(self, point: Point) -> float:
        """Return the derivative of the quantity by the parameter along the branch at a point.

        It is infinite at a fold, and NaN where a neighbour on the branch is not found.
        """
        below, above = (self.advanced(point, side * _DIFFERENCE) for side in (-1.0, 1.0))
        if below is None or above is None:
            return np.nan
        with np.errstate(divide="ignore", invalid="ignore"):
            change = np.float64(above.quantity - below.quantity)
            return float(change / (above.point.p - below.point.p))


@dataclass(frozen=True, eq=False)
class BranchSample:
    """A point of a branch with its state.

    Attributes
    ----------
    point : Point
        The point.
    state : State or None
        The state; None where the flow is not resolved.
    quantity, miss : float
        The quantity, and its difference from the target; NaN without a state.
    """

    point: Point
    state: Any
    quantity: float
    miss: float


@dataclass(frozen=True, eq=False)
class BranchInterval:
    """An interval of a branch between neighbouring points.

    Attributes
    ----------
    equations : Equations
        The equations, referred to the point before.
    before, after : BranchSample
        Ends of the interval.
    """

    equations: Equations
    before: BranchSample
    after: BranchSample

    @cached_property
    def length(self) -> float:
        """Distance of the ends along the tangent at the first."""
        problem, scale = self.equations.problem, self.equations.family.scale
        first, last = self.before.point, self.after.point
        across = (problem.weights * first.tangent) @ (last.u - first.u)
        return float(across + first.tangent_p * (last.p - first.p) / scale**2)

    def at(self, position: float) -> BranchSample | None:
        """Return the point at a position between 0 and the length; None if it is not found."""
        return self.equations.advanced(self.before.point, position)

    def zero(self) -> BranchSample | None:
        """Return the point at which the quantity passes the target; None if it is not found."""
        return self._located(lambda point: self.equations.sample(point).miss)

    def split(self, point: BranchSample) -> tuple[Self, Self]:
        """Return the parts before and after a point of the interval."""
        return replace(self, after=point), replace(self, before=point)

    def within(self, low: float, high: float) -> list[Self]:
        """Return the parts of the interval in which the parameter lies in a range."""
        parts = [part for half in self._cut_at(low) for part in half._cut_at(high)]
        return [part for part in parts if low <= part._middle <= high]

    def _cut_at(self, value: float) -> tuple[Self, ...]:
        """Return the parts on both sides of a value of the parameter, or the whole interval."""
        first, last = self.before.point.p, self.after.point.p
        cut = None
        if (first - value) * (last - value) < 0.0:
            cut = self._located(lambda point: point.p - value)
        return (self,) if cut is None else self.split(cut)

    @property
    def _middle(self) -> float:
        return 0.5 * (self.before.point.p + self.after.point.p)

    def _located(self, test: Callable[[Point], float]) -> BranchSample | None:
        point = locate(
            self.equations.problem,
            self.before.point,
            self.after.point,
            test,
            self.equations.family.scale,
            ARCLENGTH_TOLERANCE,
        )
        return None if point is None else self.equations.sample(point)
