"""Branches of states along a parameter: stability all along, and bifurcations located and named."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any, Generic

import numpy as np

from undula.analysis.states.branch import Bifurcation, Branch, S, State
from undula.arrays import Array
from undula.numerics.continuation.arclength import Point, Steps, follow, located, with_tangent
from undula.numerics.continuation.problem import Problem

# Bifurcations are located to this share of the scale of the parameter.
_LOCATED = 1e-9
# Partners agree to round-off of the exponents.
_TOGETHER = 1e-6
# Points of a branch, at most.
_MOST_POINTS = 2000


@dataclass(frozen=True)
class Family(Generic[S]):
    """A kind of state that can be followed.

    Attributes
    ----------
    parameter : str
        Name of the parameter.
    problem : Problem
        Its equations.
    judge : callable
        From a problem and its solution (u, p) to the state; raises `UnresolvedError` if that fails.
    name : callable
        From the state at a bifurcation and the index of the critical exponent to the kind.
    scale : float
        A change of the parameter that counts as 1.
    """

    parameter: str
    problem: Problem
    judge: Callable[[Any, Array, float], S]
    name: Callable[[S, int], str]
    scale: float


class UnresolvedError(ArithmeticError):
    """A solution that can no longer be turned into a state: its flow is not resolved any more."""


#: Called with the value of the parameter that was reached.
Progress = Callable[[float], None]


def follow_branch(
    family: Family[S],
    u: Array,
    p: float,
    to: float,
    steps: Steps,
    progress: Progress | None = None,
    enough: Callable[[Bifurcation[S]], bool] = lambda _: False,
    start: Point | None = None,
    least: float | None = None,
    stop: Callable[[], bool] = lambda: False,
) -> Branch[S]:
    """Follow a branch from a solution towards a value of the parameter.

    Parameters
    ----------
    family : Family
    u, p : ndarray of shape (m,) and float
        A solution of its problem.
    to : float
        Value of the parameter at which to end. A branch that turns back ends where it began.
    steps : Steps
    progress : callable, optional
        Called with each value that was reached.
    enough : callable, optional
        Tells of a bifurcation whether the branch may end behind it.
    start : Point, optional
        The same solution with the direction in which to begin, for a branch that is born sideways;
        without it the branch is followed towards `to`.
    least : float, optional
        How far the branch may go back beyond where it began.
    stop : callable, optional
        Tells whether to end with what there is.
    """
    upwards = np.sign(to - p) or 1.0
    problem = family.problem.referred_to(u)
    flat = Point(u, p, np.zeros_like(u), upwards * family.scale)
    point = start or with_tangent(problem, flat, family.scale)
    states, values = [family.judge(problem, u, p)], [p]
    found: list[Bifurcation[S]] = []
    ends = min(p, to, p if least is None else least), max(p, to)
    for reached in follow(problem, point, steps, ends):
        if progress:
            progress(reached.p)
        try:
            state = family.judge(problem, reached.u, reached.p)
            between = _Interval(family, problem, point, reached, (states[-1], state))
            found += between.bifurcations()
        except UnresolvedError:
            break
        states.append(state)
        values.append(reached.p)
        if (
            stop()
            or len(states) >= _MOST_POINTS
            or any(enough(bifurcation) for bifurcation in found)
        ):
            break
        point, problem = reached, problem.referred_to(reached.u)
    complete = values[-1] == to
    return Branch(family.parameter, np.array(values), tuple(states), tuple(found), complete)


def unstable(state: State) -> int:
    """Return how many disturbances grow."""
    return int(np.count_nonzero(state.exponents.real > 0.0))


@dataclass(frozen=True)
class _Interval(Generic[S]):
    """Two neighbours on a branch, with their states."""

    family: Family[S]
    problem: Problem
    before: Point
    after: Point
    states: tuple[S, S]

    def bifurcations(self) -> list[Bifurcation[S]]:
        """Return the bifurcations in between, in the order of following."""
        counts = unstable(self.states[0]), unstable(self.states[1])
        found = sorted(self._located(*counts), key=lambda one: self._way_to(one[0]))
        count, result = counts[0], []
        for at, kind, index, several in found:
            after = count + several * int(np.sign(counts[1] - counts[0]))
            result.append(self._bifurcation(at, kind, index, (count, after)))
            count = after
        return result

    def _located(self, first: int, last: int) -> Iterator[tuple[Point, str, int | None, int]]:
        """Yield points, kinds, critical indices, and how many exponents change their sign."""
        changing = list(range(min(first, last), max(first, last)))
        if self.before.tangent_p * self.after.tangent_p < 0.0:
            at = self._zero_of(lambda point: point.tangent_p)
            if at is not None:
                # Here one real exponent changes its sign with the parameter's direction.
                own = int(np.argmin(np.abs(self._state(at).exponents)))
                yield at, "fold", None, changing.count(own)
                changing = [index for index in changing if index != own]
        while changing:
            index = changing[0]
            at = self._zero_of(partial(self._rate, index))
            if at is None:
                return
            state = self._state(at)
            several = 2 if _is_pair(state, index) else 1
            yield at, self.family.name(state, index), index, several
            changing = changing[several:]

    def _zero_of(self, test: Callable[[Point], float]) -> Point | None:
        scale = self.family.scale
        return located(self.problem, self.before, self.after, test, scale, _LOCATED)

    def _rate(self, index: int, point: Point) -> float:
        return float(self._state(point).exponents[index].real)

    def _state(self, point: Point) -> S:
        return self.family.judge(self.problem, point.u, point.p)

    def _way_to(self, point: Point) -> float:
        across = (self.problem.weights * self.before.tangent) @ (point.u - self.before.u)
        along = self.before.tangent_p * (point.p - self.before.p) / self.family.scale**2
        return float(across) + along

    def _bifurcation(
        self, at: Point, kind: str, index: int | None, counts: tuple[int, int]
    ) -> Bifurcation[S]:
        state = self._state(at)
        swing = 0.0
        if index is not None and _is_pair(state, index):
            swing = float(abs(state.exponents[index].imag))
        return Bifurcation(
            kind=kind,
            value=at.p,
            error=_LOCATED * self.family.scale,
            state=state,
            frequency=state.frequency,
            second_frequency=swing / (2.0 * np.pi) if swing > 0.0 else None,
            unstable_before=counts[0],
            unstable_after=counts[1],
        )


def _is_pair(state: State, index: int) -> bool:
    """Tell whether an exponent and the next one are complex conjugates.

    A negative multiplier has a complex exponent as well, but no partner.
    """
    one, other = state.exponents[index], state.exponents[index + 1 : index + 2]
    apart = np.abs(other - np.conj(one))
    return bool(one.imag != 0.0 and other.size and apart[0] < _TOGETHER * abs(one))
