"""States of a followed branch at chosen values of its parameter.

Between two neighbouring states of the branch that enclose a value, Newton's method at the value
begins on the chord between them. Where it fails or leads elsewhere, the branch is followed from the
first of the two to the value.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np

from undula.analysis.solvers.branches import follow
from undula.analysis.solvers.state_kinds import Solved, kind_of_state
from undula.analysis.states.branch import Branch
from undula.analysis.states.follow_branch import UnresolvedError
from undula.analysis.states.not_found import NotFound
from undula.numerics.continuation.arclength import solve_at


def states_at_values(
    branch: Branch[Any],
    values: Sequence[float],
    *,
    progress: Callable[[float], None] | None = None,
) -> Branch[Any]:
    """Return a branch with the states at chosen values in place of its own.

    Parameters
    ----------
    branch : Branch
        Of solved states, each with its model.
    values : sequence of float
        Values of the parameter, in any order, in its unit.
    progress : callable, optional
        Called with each value that was solved for.

    Returns
    -------
    Branch
        In the order of following; several states at a value that the branch passes more than once,
        and none at a value that it does not reach. Bifurcations are those of the branch.

    Examples
    --------
    >>> import undula as un
    >>> state = un.find(un.Filament(8, un.TipLoad(60.0)), "spinning")
    >>> branch = un.follow(state, "load.force", 80.0)
    >>> states_at_values(branch, [65.0, 70.0]).values.tolist()
    [65.0, 70.0]
    """
    solved: list[tuple[float, Any]] = []
    ends = zip(branch.values.tolist(), branch.states, strict=True)
    for before, after in pairwise(ends):
        for value in _between(before[0], after[0], values):
            state = before[1] if value == before[0] else _solved(branch, before, after, value)
            if state is not None:
                solved.append((value, state))
            if progress:
                progress(value)
    if float(branch.values[-1]) in values:
        solved.append((float(branch.values[-1]), branch.states[-1]))
    places, states = zip(*solved, strict=True) if solved else ((), ())
    return replace(branch, values=np.array(places, dtype=float), states=tuple(states))


def _between(start: float, end: float, values: Sequence[float]) -> Iterator[float]:
    """Yield the values from `start` on and before `end`, in the direction from one to the other."""
    low, high = min(start, end), max(start, end)
    inside = [value for value in values if low <= value <= high and value != end]
    yield from sorted(inside, reverse=end < start)


def _solved(
    branch: Branch[Any], before: tuple[float, Solved], after: tuple[float, Solved], value: float
) -> Any | None:
    """Return the state at a value between two neighbours; None if it is not found."""
    (start, first), (end, last) = before, after
    kind = kind_of_state(first)
    family = kind.family(first, branch.parameter, abs(end - start))
    near, far = kind.unknowns(first), kind.unknowns(last)
    problem = family.problem.with_reference(near)
    guess = near + (value - start) / (end - start) * (far - near)
    solution = solve_at(problem, guess, value)
    length = problem.weights @ (far - near) ** 2
    # On a branch without a fold in between, a state is about as near to its neighbours as they are
    # to each other.
    if solution is not None and problem.weights @ (solution[0] - near) ** 2 <= 2.0 * length:
        try:
            return family.judge(problem, solution[0], value)
        except UnresolvedError:
            return None
    reached = follow(first, branch.parameter, value)
    if isinstance(reached, NotFound) or not reached.complete:
        return None
    return reached.states[-1]
