"""Where along the force a state is stable: of one model, from its branches.

The straight state loses stability at its Hopf point; spinning and flapping are followed from there
on, with all their bifurcations.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from undula.analysis.linear.results import Onset
from undula.analysis.maps.states_at_forces import states_along
from undula.analysis.parameters import FORCE
from undula.analysis.solvers.branches import follow, follow_from_onset
from undula.analysis.solvers.criticality import is_subcritical
from undula.analysis.states.branch import Bifurcation, Branch
from undula.analysis.states.follow_branch import Progress, unstable
from undula.analysis.states.not_found import NotFound
from undula.models.model import Model

# Branches are judged from a little above the onset on, where their amplitude is no longer small.
_BEGINNING = 1.02
# Where so many disturbances of a state grow, it is not followed on: it would have to lose all of
# them again, and meets many more bifurcations, each located, before it does.
_MOST_GROWING = 6


@dataclass(frozen=True)
class Change:
    """A force at which a state gains or loses stability, or a branch turns back.

    Attributes
    ----------
    force, error : float
        The force, and how exactly it was located on the links as they are.
    frequency : float
        Of the state there [cycles per T].
    """

    force: float
    error: float
    frequency: float


@dataclass(frozen=True)
class StabilityIntervals:
    """Where along the force a kind of state is stable.

    Attributes
    ----------
    kind : {"straight", "spinning", "flapping"}
    begins : float or None
        The least force at which there is such a state; None if there is none.
    stable : tuple of (float, float)
        Ends of the stretches of force on which it is stable, rising; the last may be infinite.
    known_to : float
        Up to this force its stability is known; 0 if nothing is.
    fold, gained, lost : Change or None
        Where its branch turns back, if it is born downwards; where it first becomes stable, and
        where it first ceases to be.
    reason : str or None
        Why there is no such state, or no more is known.
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
        """Tell whether the state is stable at a force."""
        return any(low <= force <= high for low, high in self.stable)

    @property
    def edges(self) -> tuple[float, ...]:
        """All forces at which it begins, or gains or loses stability."""
        ends = [end for stretch in self.stable for end in stretch if 0.0 < end < np.inf]
        return tuple(sorted({*ends, *([] if self.begins is None else [self.begins])}))


def nothing_known(kind: str, reason: str) -> StabilityIntervals:
    """Return that nothing is known of a kind of state, and why."""
    return StabilityIntervals(kind, None, (), 0.0, reason=reason)


def straight_stretches(onset: Onset) -> StabilityIntervals:
    """Return where the straight state of the links as they are is stable."""
    crossings = [*([onset.hopf] if onset.hopf else []), *onset.later]
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


def moving_stretches(
    model: Model, kind: str, onset: float, up_to: float, progress: Progress | None = None
) -> StabilityIntervals:
    """Return where a state that moves is stable.

    Parameters
    ----------
    model : Model
        Its own force does not matter.
    kind : {"spinning", "flapping"}
    onset : float
        The force at which the straight state of the links as they are is lost.
    up_to : float
        The largest force of interest.
    progress : callable, optional
        Called with each force that was reached.
    """
    start = _BEGINNING * onset
    begun = states_along(model, kind, [start]).get(start)
    if begun is None or isinstance(begun, NotFound):
        return nothing_known(kind, begun.reason if begun else f"no {kind} at force {start:.6g}")
    born = _born_downwards(model, kind, start)
    folds = [one for one in born.bifurcations if one.kind == "fold"] if born else []
    fold = min(folds, key=lambda one: one.value, default=None)
    branch = None
    if up_to > start:
        followed = follow(begun, FORCE, up_to, progress=progress, enough=_hopeless)
        if isinstance(followed, NotFound):
            return nothing_known(kind, followed.reason)
        branch = followed
    changes = _changes(born) + _changes(branch)
    begins = fold.value if fold else onset
    searched_to = start if branch is None else float(branch.values.max())
    complete = branch is None or branch.complete
    return StabilityIntervals(
        kind,
        begins,
        # A branch that is born downwards is unstable until it turns.
        _stretches(changes, begun.stable and not fold, begins),
        searched_to,
        _told(fold),
        _first(changes, "gains"),
        _first(changes, "loses"),
        None if complete else _left(branch, searched_to),
    )


def _hopeless(bifurcation: Bifurcation[Any]) -> bool:
    return bifurcation.unstable_after >= _MOST_GROWING


def _left(branch: Branch[Any] | None, searched_to: float) -> str:
    growing = unstable(branch.states[-1]) if branch else 0
    why = f", where {growing} disturbances grow" if growing >= _MOST_GROWING else ""
    return f"the branch was not followed beyond force {searched_to:.6g}{why}"


def _born_downwards(model: Model, kind: str, end: float) -> Branch[Any] | None:
    """Return a branch from the Hopf point on, if it goes down there and comes up to the end."""
    if not is_subcritical(model, kind):
        return None
    branch = follow_from_onset(model, kind, end)
    return None if isinstance(branch, NotFound) or not branch.complete else branch


def _changes(branch: Branch[Any] | None) -> list[Bifurcation[Any]]:
    found = branch.bifurcations if branch else ()
    return [one for one in found if one.gains or one.loses]


def _stretches(
    changes: list[Bifurcation[Any]], stable: bool, begins: float
) -> tuple[tuple[float, float], ...]:
    ends = [begins] if stable else []
    ends += [one.value for one in changes]
    if len(ends) % 2:
        ends.append(np.inf)
    return tuple(zip(ends[::2], ends[1::2], strict=True))


def _first(changes: list[Bifurcation[Any]], way: str) -> Change | None:
    return _told(next((one for one in changes if getattr(one, way)), None))


def _told(found: Bifurcation[Any] | None) -> Change | None:
    return None if found is None else Change(found.value, found.error, found.frequency)
