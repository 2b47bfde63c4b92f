"""The branch of a kind of state over a range of a parameter, in intervals.

Along the force, spinning and flapping are followed from the Hopf point of the straight state, with
the part below it if that point is subcritical. Otherwise a state is solved for in the range and
followed to both ends of it.
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from itertools import islice
from typing import Any

import numpy as np

from undula.analysis.parameters import FORCE, changed, value_of
from undula.analysis.solvers.branches import (
    SCALES,
    STAYS_STABLE,
    first_beyond,
)
from undula.analysis.solvers.inverse.branch_interval import BranchInterval, BranchSample, Equations
from undula.analysis.solvers.inverse.searched import Searched
from undula.analysis.solvers.inverse.targets import Target
from undula.analysis.solvers.reach_value import steps_along
from undula.analysis.solvers.state_kinds import Solved, kind_by_name, kind_of_state
from undula.analysis.solvers.upward_branch import START
from undula.analysis.states.follow_branch import Family, Progress
from undula.analysis.states.not_found import NotFound
from undula.models.model import Model
from undula.numerics.continuation.arclength import Point, Steps, with_tangent

# Arclength between the Hopf point and the first point: targets closer to the onset are not met.
_FIRST_ARCLENGTH = 0.003
# Largest number of points of a branch in each direction.
_MOST_POINTS = 500


@dataclass(frozen=True)
class Question:
    """A target on the states of a model along a parameter.

    Attributes
    ----------
    model : Model
        With the same unknowns over the whole range.
    target : Target
        The target.
    parameter : str
        Name of the parameter.
    between : (float, float)
        Range of the parameter.
    progress : callable or None
        Called with each value of the parameter that was reached.
    stop : callable
        Returns True if the search is to end.
    """

    model: Model
    target: Target
    parameter: str
    between: tuple[float, float]
    progress: Progress | None
    stop: Callable[[], bool]


@dataclass(frozen=True)
class Beginning:
    """A point at which to begin a branch, and how far to follow it.

    Attributes
    ----------
    family : Family
        Equations of the branch, and the records of its solutions.
    point : Point
        The point; its tangent gives the direction.
    ends : (float, float)
        Least and largest value of the parameter.
    first : float
        Arclength of the first step.
    """

    family: Family[Any]
    point: Point
    ends: tuple[float, float]
    first: float = Steps.first


@dataclass(frozen=True)
class Run:
    """A connected part of a branch within the range.

    Attributes
    ----------
    intervals : tuple of BranchInterval
        Neighbouring intervals, at least one.
    """

    intervals: tuple[BranchInterval, ...]

    @property
    def samples(self) -> tuple[BranchSample, ...]:
        """Points between the intervals and at the ends."""
        return (self.intervals[0].before, *(interval.after for interval in self.intervals))


@dataclass(frozen=True)
class SearchedBranch:
    """The parts of a branch in a range.

    Attributes
    ----------
    runs : tuple of Run
        Connected parts.
    not_searched : str or None
        The part of the range that could not be searched, and why, in words.
    """

    runs: tuple[Run, ...]
    not_searched: str | None

    @property
    def samples(self) -> tuple[BranchSample, ...]:
        """All points."""
        return tuple(sample for run in self.runs for sample in run.samples)

    @property
    def searched(self) -> Searched:
        """Values of the parameter and of the quantity."""
        return Searched(
            tuple(sample.point.p for sample in self.samples),
            tuple(sample.quantity for sample in self.samples),
            self.not_searched,
        )


def search_branch(question: Question) -> SearchedBranch:
    """Return the branch of the question's states within its range; empty without a state."""
    beginnings = _beginnings(question)
    if isinstance(beginnings, NotFound):
        return SearchedBranch((), beginnings.reason)
    runs: list[Run] = []
    values: list[float] = []
    not_searched: str | None = None
    for beginning in beginnings:
        values.append(beginning.point.p)
        intervals: list[BranchInterval] = []
        for interval in followed(beginning, question):
            intervals.append(interval)
            values.append(interval.after.point.p)
        runs += _runs_within(intervals, *question.between)
        if not question.stop() and values[-1] not in beginning.ends:
            not_searched = f"it could not be followed beyond {question.parameter} {values[-1]:.6g}"
    if not runs and not_searched is None:
        not_searched = (
            f"{question.target.kind} begins at {question.parameter} {min(values):.6g}; give a range"
            " that reaches beyond it"
        )
    return SearchedBranch(tuple(runs), not_searched)


def _runs_within(intervals: Iterable[BranchInterval], low: float, high: float) -> list[Run]:
    """Return the connected parts of a branch on which the parameter lies in a range."""
    runs: list[list[BranchInterval]] = []
    for interval in intervals:
        for part in interval.within(low, high):
            if runs and part.before is runs[-1][-1].after:
                runs[-1].append(part)
            else:
                runs.append([part])
    return [Run(tuple(run)) for run in runs]


def _beginnings(question: Question) -> list[Beginning] | NotFound:
    if question.parameter == FORCE and question.target.kind in ("spinning", "flapping"):
        return _at_onset(question)
    low, high = question.between
    scale = (high - low) / SCALES
    state = _state_in_range(question)
    if isinstance(state, NotFound):
        return state
    solver = kind_of_state(state)
    family = solver.family(state, question.parameter, scale)
    value, u = value_of(state.model, question.parameter), solver.unknowns(state)
    problem = family.problem.with_reference(u)
    directions = [side for side, end in ((-1.0, low), (1.0, high)) if value != end]
    return [
        Beginning(
            family,
            with_tangent(problem, Point(u, value, np.zeros_like(u), side * scale), scale),
            question.between,
        )
        for side in directions
    ]


def _at_onset(question: Question) -> list[Beginning] | NotFound:
    """Return the point next to the Hopf point at which spinning or flapping begins."""
    model, kind = question.model, question.target.kind
    hopf = kind_by_name(kind).start(model)
    if hopf is None:
        return STAYS_STABLE
    end = max(question.between[1], START * hopf[1].p)
    begun = first_beyond(hopf, model, kind, end, _FIRST_ARCLENGTH)
    if isinstance(begun, NotFound):
        return begun
    return [Beginning(*begun, ends=(0.0, end), first=_FIRST_ARCLENGTH)]


def _state_in_range(question: Question) -> Solved | NotFound:
    """Return a state at the model's own value, if it lies in the range, or at an end."""
    low, high = question.between
    own = value_of(question.model, question.parameter)
    values = dict.fromkeys(([own] if low <= own <= high else []) + [low, high])
    find = kind_by_name(question.target.kind).find
    failures: list[NotFound] = []
    for value in values:
        state = find(changed(question.model, question.parameter, value))
        if not isinstance(state, NotFound):
            return state  # type: ignore[no-any-return]
        failures.append(state)
    return failures[0]


def followed(beginning: Beginning, question: Question) -> Iterator[BranchInterval]:
    """Yield the intervals of a branch from its beginning on."""
    family, start = beginning.family, beginning.point
    steps = Steps(first=beginning.first, scale=family.scale)
    problem = family.problem.with_reference(start.u)
    before = Equations(family, problem, question.target).sample(start)
    steps_taken = steps_along(problem, start, steps, beginning.ends)
    for step in islice(steps_taken, _MOST_POINTS):
        equations = Equations(family, step.problem, question.target)
        after = equations.sample(step.after)
        if question.progress:
            question.progress(step.after.p)
        if after.state is None:
            return
        yield BranchInterval(equations, before, after)
        if question.stop():
            return
        before = after
