"""Intervals of force on which a state of one model is stable, from its branches.

The straight state loses stability at its Hopf point; spinning and flapping are followed from there
on, with all their bifurcations.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from undula.analysis.linear.results import Onset
from undula.analysis.maps.states_at_forces import states_along
from undula.analysis.parameters import FORCE
from undula.analysis.solvers.branches import follow
from undula.analysis.solvers.upward_branch import START, branch_through_fold, first_bifurcation
from undula.analysis.states.branch import Bifurcation, Branch
from undula.analysis.states.follow_branch import Progress, unstable
from undula.analysis.states.not_found import NotFound
from undula.models.model import Model

# Number of growing disturbances at which following ends: the branch would pass many more
# bifurcations, each of them located, before it could be stable again.
_MOST_GROWING = 6


@dataclass(frozen=True)
class Change:
    """A force at which a state gains or loses stability, or a branch turns back.

    Attributes
    ----------
    force, error : float
        The force, and the error of its location on the links as they are [B/L^2].
    frequency : float
        Of the state there [cycles per T].
    """

    force: float
    error: float
    frequency: float


@dataclass(frozen=True)
class StabilityIntervals:
    """Intervals of force on which a kind of state is stable.

    Attributes
    ----------
    kind : {"straight", "spinning", "flapping"}
    begins : float or None
        The least force at which there is such a state [B/L^2]; None if it does not exist.
    stable : tuple of (float, float)
        Ends of the intervals of force on which it is stable, rising; the last may be infinite.
    searched_to : float
        Its stability is known up to this force; 0 if it is not known at any.
    fold, gained, lost : Change or None
        The fold of a subcritical branch; the first gain of stability, and the first loss.
    reason : str or None
        Why there is no such state, or why the search ended.
    """

    kind: str
    begins: float | None
    stable: tuple[tuple[float, float], ...]
    searched_to: float
    fold: Change | None = None
    gained: Change | None = None
    lost: Change | None = None
    reason: str | None = None

    def is_stable_at(self, force: float) -> bool:
        """Return whether the state is stable at a force."""
        return any(low <= force <= high for low, high in self.stable)

    @property
    def edges(self) -> tuple[float, ...]:
        """All forces at which the state begins, or gains or loses stability."""
        ends = [end for interval in self.stable for end in interval if 0.0 < end < np.inf]
        return tuple(sorted({*ends, *([] if self.begins is None else [self.begins])}))


def unknown_intervals(kind: str, reason: str) -> StabilityIntervals:
    """Return the record of a kind of state whose stability is not known, with the reason."""
    return StabilityIntervals(kind, None, (), 0.0, reason=reason)


def straight_intervals(onset: Onset) -> StabilityIntervals:
    """Return the intervals on which the straight state of the links as they are is stable."""
    crossings = [*([onset.hopf] if onset.hopf else []), *onset.later]
    # An interval ends where the first pair begins to grow, and begins where the last one ceases to.
    ends, growing = [0.0], 0
    for crossing in crossings:
        before, growing = growing, growing + (1 if crossing.growth_slope > 0.0 else -1)
        if 0 in (before, growing):
            ends.append(crossing.force)
    if growing == 0:
        ends.append(np.inf)
    first = onset.hopf
    lost = None if first is None else Change(first.force, first.round_off, first.frequency)
    searched_to = np.inf if first else onset.searched_to
    reason = None if first else str(onset)
    stable = tuple(zip(ends[::2], ends[1::2], strict=True))
    return StabilityIntervals("straight", 0.0, stable, searched_to, lost=lost, reason=reason)


def moving_intervals(
    model: Model, kind: str, onset: float, up_to: float, progress: Progress | None = None
) -> StabilityIntervals:
    """Return the intervals on which a moving state is stable.

    Parameters
    ----------
    model : Model
        Its own force does not matter.
    kind : {"spinning", "flapping"}
        Kind of the state.
    onset : float
        The force at which the straight state of the links as they are is lost [B/L^2].
    up_to : float
        The largest force of interest [B/L^2].
    progress : callable, optional
        Called with each force that was reached.

    Returns
    -------
    StabilityIntervals
    """
    start = START * onset
    # A state on the branch from the Hopf point, which takes neither a run nor a guess.
    state = states_along(model, kind, [start]).get(start)
    if state is None or isinstance(state, NotFound):
        return unknown_intervals(kind, state.reason if state else f"no {kind} at force {start:.6g}")
    folded = _subcritical_part(model, kind, start)
    folds = [point for point in folded.bifurcations if point.kind == "fold"] if folded else []
    fold = min(folds, key=lambda point: point.value, default=None)
    branch = None
    if up_to > start:
        followed = follow(state, FORCE, up_to, progress=progress, enough=_grows_too_much)
        if isinstance(followed, NotFound):
            return unknown_intervals(kind, followed.reason)
        branch = followed
    changes = _changes(folded) + _changes(branch)
    begins = fold.value if fold else onset
    searched_to = start if branch is None else float(branch.values.max())
    complete = branch is None or branch.complete
    return StabilityIntervals(
        kind,
        begins,
        # A subcritical branch is unstable until its fold.
        _intervals(changes, begins, stable=state.stable and not fold),
        searched_to,
        _change(fold),
        _change(first_bifurcation(changes, lambda point: point.gains)),
        _change(first_bifurcation(changes, lambda point: point.loses)),
        None if complete else _why_left(branch, searched_to),
    )


def _subcritical_part(model: Model, kind: str, end: float) -> Branch[Any] | None:
    """Return the branch through its fold up to a force; None if it has none or is incomplete."""
    folded = branch_through_fold(model, kind, end)
    if folded is None or isinstance(folded, NotFound) or not folded.complete:
        return None
    return folded


def _grows_too_much(bifurcation: Bifurcation[Any]) -> bool:
    return bifurcation.unstable_after >= _MOST_GROWING


def _why_left(branch: Branch[Any] | None, searched_to: float) -> str:
    growing = unstable(branch.states[-1]) if branch else 0
    why = f", where {growing} disturbances grow" if growing >= _MOST_GROWING else ""
    return f"the branch was not followed beyond force {searched_to:.6g}{why}"


def _changes(branch: Branch[Any] | None) -> list[Bifurcation[Any]]:
    bifurcations = branch.bifurcations if branch else ()
    return [point for point in bifurcations if point.gains or point.loses]


def _intervals(
    changes: Sequence[Bifurcation[Any]], begins: float, *, stable: bool
) -> tuple[tuple[float, float], ...]:
    """Return the stable intervals between changes of stability; `stable` is that at `begins`."""
    ends = [begins] if stable else []
    ends += [point.value for point in changes]
    if len(ends) % 2:
        ends.append(np.inf)
    return tuple(zip(ends[::2], ends[1::2], strict=True))


def _change(point: Bifurcation[Any] | None) -> Change | None:
    return None if point is None else Change(point.value, point.error, point.frequency)
