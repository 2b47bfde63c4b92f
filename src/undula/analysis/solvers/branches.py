"""Branches of a kind of state along a parameter: from a state on, or from the onset on."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from undula.analysis.arguments import require_state
from undula.analysis.one_thread import on_one_thread
from undula.analysis.parameters import FORCE, value_of
from undula.analysis.solvers.state_kinds import Solved, kind_by_name, kind_of_state
from undula.analysis.states.along_parameter import model_along, with_unknowns_of
from undula.analysis.states.branch import Bifurcation, Branch
from undula.analysis.states.follow_branch import Family, Progress, follow_branch
from undula.analysis.states.not_found import NotFound, SearchStatus
from undula.errors import InputError
from undula.models.model import Model
from undula.numerics.continuation.arclength import Point, Steps, advance

#: Length of the interval that is followed, in scales (changes of the parameter that count as 1).
SCALES = 8.0
# Arclength between a Hopf point and the first point of a branch.
_FIRST_ARCLENGTH = 0.03
#: Outcome of a search for states that begin at a Hopf point where there is no such point.
STAYS_STABLE = NotFound(
    SearchStatus.NO_ONSET, "the straight state stays stable, so that no branch begins at it"
)


@on_one_thread
def follow(
    state: Solved,
    parameter: str,
    to: float,
    *,
    progress: Progress | None = None,
    enough: Callable[[Bifurcation[Any]], bool] = lambda _: False,
    stop: Callable[[], bool] = lambda: False,
) -> Branch[Any] | NotFound:
    """Follow a state along a parameter, with its stability and its bifurcations.

    Branches are followed by pseudo-arclength continuation (Keller 1977), through folds.

    Parameters
    ----------
    state : Spinning, Flapping, Equilibrium or Periodic
        A solved state of the branch, with its model.
    parameter : str
        Name of the parameter, such as "load.force" or "model.drag_ratio".
    to : float
        Value of the parameter at which to end. A branch that turns back ends where it began, or
        where no step succeeds; then it is not complete.
    progress : callable, optional
        Called with each value that was reached.
    enough : callable, optional
        Called with each bifurcation; the branch ends behind one for which it returns True.
    stop : callable, optional
        Called after each state; the branch ends where it returns True, and is not complete.

    Returns
    -------
    Branch or NotFound
        The latter if the parameter breaks the rotational symmetry of the body and no such state is
        found once its equations contain the directors.

    Raises
    ------
    InputError
        The parameter does not exist or is a whole number, `to` is the present value or out of
        range, or bodies on the way have no such states.

    Examples
    --------
    >>> import undula as un
    >>> state = un.find(un.Filament(8, un.TipLoad(75.0)), "spinning")
    >>> branch = un.follow(state, "load.force", 80.0)
    >>> branch.complete, all(state.stable for state in branch.states)
    (True, True)
    """
    require_state(state, "follow")
    solver, start = kind_of_state(state), value_of(state.model, parameter)
    model = model_along(state.model, state.kind, parameter, (start, to))
    if to == start:
        raise InputError(f"{parameter} is {start} already; give another value to follow to")
    first: Solved | NotFound = state
    if model is not state.model:
        first = with_unknowns_of(model, state, parameter, solver.find)
    if isinstance(first, NotFound):
        return first
    scale = abs(to - start) / SCALES
    family = solver.family(first, parameter, scale)
    return follow_branch(
        family, solver.unknowns(first), start, to, Steps(scale=scale), progress, enough, stop=stop
    )


@on_one_thread
def follow_from_onset(
    model: Model,
    kind: str,
    to: float,
    *,
    progress: Progress | None = None,
    stop: Callable[[], bool] = lambda: False,
) -> Branch[Any] | NotFound:
    """Follow the branch of a kind of state from the Hopf point of the straight state.

    The first point lies at a small amplitude next to the Hopf point. A subcritical branch leads to
    smaller forces first and turns in a fold.

    Parameters
    ----------
    model : Model
        Its own force does not matter.
    kind : {"spinning", "flapping"}
        Kind of the states.
    to : float
        The force at which to end [B/L^2], beyond the Hopf force.
    progress : callable, optional
        Called with each force that was reached.
    stop : callable, optional
        Called after each state; the branch ends where it returns True, and is not complete.

    Returns
    -------
    Branch or NotFound
        The latter if the straight state is stable at all forces, or Newton's method finds no first
        point.

    Raises
    ------
    InputError
        The kind does not exist, or `to` is not beyond the Hopf force.

    Examples
    --------
    >>> import undula as un
    >>> branch = un.follow_from_onset(un.Filament(8, un.TipLoad(75.0)), "spinning", 60.0)
    >>> branch.complete, bool(branch.values[0] < 40.0)
    (True, True)
    """
    solver = kind_by_name(kind)
    beginning = solver.start(model)
    if beginning is None:
        return STAYS_STABLE
    if to <= beginning[1].p:
        raise InputError(f"the branch begins at force {beginning[1].p:.6g}; give an end beyond it")
    begun = first_beyond(beginning, model, kind, to, _FIRST_ARCLENGTH)
    if isinstance(begun, NotFound):
        return begun
    family, first = begun
    steps = Steps(first=_FIRST_ARCLENGTH, scale=family.scale)
    branch = follow_branch(
        family, first.u, first.p, to, steps, progress, start=first, least=0.0, stop=stop
    )
    return replace(branch, onset=beginning[1].p)


def first_beyond(
    beginning: tuple[Any, Point], model: Model, kind: str, to: float, arclength: float
) -> tuple[Family[Any], Point] | NotFound:
    """Return the first point of a branch next to its Hopf point, and the family it belongs to.

    Parameters
    ----------
    beginning : tuple of Problem and Point
        The problem in the force and the Hopf point, as `Kind.start` returns them.
    model : Model
        Its own force does not matter.
    kind : {"spinning", "flapping"}
        Kind of the states.
    to : float
        The force up to which the branch is to be followed, beyond the Hopf force.
    arclength : float
        Arclength between the Hopf point and the first point.

    Returns
    -------
    tuple of Family and Point, or NotFound
        The latter if Newton's method finds no such point.
    """
    solver, (problem, hopf) = kind_by_name(kind), beginning
    scale = (to - hopf.p) / SCALES
    first = advance(problem, hopf, arclength, scale)
    if first is None:
        return NotFound(
            SearchStatus.NOT_CONVERGED,
            f"Newton's method finds no {kind} next to the Hopf point {hopf.p:.6g}",
        )
    problem = problem.with_reference(first.u)
    state = solver.judge(model, FORCE)(problem, first.u, first.p)
    return solver.family(state, FORCE, scale), first
