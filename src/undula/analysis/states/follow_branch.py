"""Continuation of a branch: stability of all its states, bifurcations located and named."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any, Generic

import numpy as np

from undula.analysis.states.branch import Bifurcation, Bifurcations, Branch, S
from undula.analysis.states.state import State
from undula.arrays import Array
from undula.log import logger
from undula.numerics.continuation.arclength import Point, Steps, trace, with_tangent
from undula.numerics.continuation.locate import locate
from undula.numerics.continuation.problem import Problem

_LOG = logger(__name__)

# Error of the location of a bifurcation, relative to the scale of the parameter.
_LOCATION_ERROR = 1e-9
# Relative difference of an exponent from the conjugate of its partner, at most: round-off.
_CONJUGATE_ERROR = 1e-6
# Largest number of points of a branch.
_MOST_POINTS = 2000


@dataclass(frozen=True)
class Family(Generic[S]):
    """Equations of a kind of state along a parameter, and the records of their solutions.

    Attributes
    ----------
    parameter : str
        Name of the parameter.
    problem : Problem
        Equations of the states.
    judge : callable
        From a problem and its solution (u, p) to the state; raises `UnresolvedError` if that fails.
    name : callable
        From the state at a bifurcation and the index of the critical exponent to the kind of
        bifurcation.
    scale : float
        A change of the parameter that counts as 1.
    """

    parameter: str
    problem: Problem
    judge: Callable[[Any, Array, float], S]
    name: Callable[[S, int], str]
    scale: float


class UnresolvedError(ArithmeticError):
    """A solution whose state cannot be recorded, as its flow is no longer resolved."""


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
        Equations of the branch, and the records of its solutions.
    u, p : ndarray of shape (m,) and float
        A solution of its problem.
    to : float
        Value of the parameter at which to end. A branch that turns back ends where it began.
    steps : Steps
        Sizes of the steps in arclength.
    progress : callable, optional
        Called with each value that was reached.
    enough : callable, optional
        Called with each bifurcation; the branch ends behind one for which it returns True.
    start : Point, optional
        The same solution with the direction in which to begin, for a branch that begins at a
        constant parameter; without it the branch is followed towards `to`.
    least : float, optional
        Value of the parameter down to which the branch may turn back beyond its beginning.
    stop : callable, optional
        Called after each state; the branch ends where it returns True.

    Returns
    -------
    Branch
        Not complete unless it reached `to`.
    """
    upwards = np.sign(to - p) or 1.0
    problem = family.problem.with_reference(u)
    flat = Point(u, p, np.zeros_like(u), upwards * family.scale)
    point = start or with_tangent(problem, flat, family.scale)
    states, values = [family.judge(problem, u, p)], [p]
    bifurcations: list[Bifurcation[S]] = []
    ends = min(p, to, p if least is None else least), max(p, to)
    for reached in trace(problem, point, steps, ends):
        if progress:
            progress(reached.p)
        try:
            state = family.judge(problem, reached.u, reached.p)
            interval = _Interval(family, problem, point, reached, (states[-1], state))
            bifurcations += interval.logged_bifurcations()
        except UnresolvedError:
            break
        states.append(state)
        values.append(reached.p)
        if stop() or len(states) >= _MOST_POINTS or any(map(enough, bifurcations)):
            break
        point, problem = reached, problem.with_reference(reached.u)
    return Branch(
        family.parameter,
        np.array(values),
        tuple(states),
        Bifurcations(bifurcations),
        complete=values[-1] == to,
    )


def unstable(state: State) -> int:
    """Return the number of disturbances that grow."""
    return int(np.count_nonzero(state.exponents.real > 0.0))


@dataclass(frozen=True)
class _Interval(Generic[S]):
    """Two neighbours on a branch, with their states."""

    family: Family[S]
    problem: Problem
    before: Point
    after: Point
    states: tuple[S, S]

    def logged_bifurcations(self) -> list[Bifurcation[S]]:
        """Return the bifurcations in between, and log them and the state after them."""
        bifurcations, parameter = self.bifurcations(), self.family.parameter
        for bifurcation in bifurcations:
            _LOG.info("%s at %s = %.9g", bifurcation.kind, parameter, bifurcation.value)
        _LOG.debug("state at %s = %.9g", parameter, self.after.p)
        return bifurcations

    def bifurcations(self) -> list[Bifurcation[S]]:
        """Return the bifurcations in between, in the order of following."""
        counts = unstable(self.states[0]), unstable(self.states[1])
        crossings = sorted(self._located(*counts), key=lambda crossing: self._way_to(crossing[0]))
        count, bifurcations = counts[0], []
        for point, kind, index, multiplicity in crossings:
            after = count + multiplicity * int(np.sign(counts[1] - counts[0]))
            bifurcations.append(self._bifurcation(point, kind, index, (count, after)))
            count = after
        return bifurcations

    def _located(self, first: int, last: int) -> Iterator[tuple[Point, str, int | None, int]]:
        """Yield points, kinds, critical indices, and the number of exponents that change sign."""
        changing = list(range(min(first, last), max(first, last)))
        if self.before.tangent_p * self.after.tangent_p < 0.0:
            fold = self._zero_of(lambda point: point.tangent_p)
            if fold is not None:
                # Here one real exponent changes its sign with the parameter's direction.
                critical = int(np.argmin(np.abs(self._state(fold).exponents)))
                yield fold, "fold", None, changing.count(critical)
                changing = [index for index in changing if index != critical]
        while changing:
            index = changing[0]
            zero = self._zero_of(partial(self._rate, index))
            if zero is None:
                return
            state = self._state(zero)
            multiplicity = 2 if _is_pair(state, index) else 1
            yield zero, self.family.name(state, index), index, multiplicity
            changing = changing[multiplicity:]

    def _zero_of(self, test: Callable[[Point], float]) -> Point | None:
        scale = self.family.scale
        return locate(self.problem, self.before, self.after, test, scale, _LOCATION_ERROR)

    def _rate(self, index: int, point: Point) -> float:
        return float(self._state(point).exponents[index].real)

    def _state(self, point: Point) -> S:
        return self.family.judge(self.problem, point.u, point.p)

    def _way_to(self, point: Point) -> float:
        across = (self.problem.weights * self.before.tangent) @ (point.u - self.before.u)
        along = self.before.tangent_p * (point.p - self.before.p) / self.family.scale**2
        return float(across) + along

    def _bifurcation(
        self, point: Point, kind: str, index: int | None, counts: tuple[int, int]
    ) -> Bifurcation[S]:
        state = self._state(point)
        swing = 0.0
        if index is not None and _is_pair(state, index):
            swing = float(abs(state.exponents[index].imag))
        return Bifurcation(
            kind=kind,
            value=point.p,
            error=_LOCATION_ERROR * self.family.scale,
            state=state,
            frequency=state.frequency,
            second_frequency=swing / (2.0 * np.pi) if swing > 0.0 else None,
            unstable_before=counts[0],
            unstable_after=counts[1],
        )


def _is_pair(state: State, index: int) -> bool:
    """Return whether an exponent and the next one are complex conjugates.

    A negative multiplier has a complex exponent as well, but no partner.
    """
    exponent, following = state.exponents[index], state.exponents[index + 1 : index + 2]
    if exponent.imag == 0.0 or not following.size:
        return False
    return bool(np.abs(following - np.conj(exponent))[0] < _CONJUGATE_ERROR * abs(exponent))
