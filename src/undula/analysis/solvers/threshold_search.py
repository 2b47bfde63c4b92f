"""The search for a threshold: the branch of a state followed from its beginning up to a force.

A branch that is born downwards is followed from the onset through its fold, where it begins; others
from a little above the onset. What lies further up is followed in stretches, each of them twice as
long as all before, so that the steps do not grow with the way that is asked for.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from undula.analysis.linear.stability import onset
from undula.analysis.parameters import FORCE, changed
from undula.analysis.solvers.branches import follow, follow_from_onset
from undula.analysis.solvers.criticality import is_subcritical
from undula.analysis.solvers.refind import refind_bifurcation
from undula.analysis.solvers.state_kinds import Solved, kind_by_name
from undula.analysis.solvers.symmetry import require_space, require_turning
from undula.analysis.states.branch import Bifurcation, Branch
from undula.analysis.states.follow_branch import Progress
from undula.analysis.states.not_found import NotFound, SearchStatus
from undula.models.model import Model

#: Forces up to which thresholds are looked for by default, in multiples of that of the onset.
FARTHEST = 20.0
# Branches of states begin a little above the onset, where their amplitude is no longer small.
_BEGINNING = 1.02
# The force of the onset of the tip load, about, which stands for that of what rests [B/L^2].
_ONSET_AT_REST = 38.0


@dataclass(frozen=True)
class Wanted:
    """Which bifurcation of which kind of state a threshold is, and what the state does there."""

    kind: str
    does: str

    def is_it(self, one: Bifurcation[Any]) -> bool:
        """Tell whether a bifurcation is the threshold."""
        return one.gains if self.does == "gains" else one.loses


WANTED: Mapping[str, Wanted] = {
    "onset": Wanted("equilibrium", "loses"),
    "spinning-lost": Wanted("spinning", "loses"),
    "flapping-gained": Wanted("flapping", "gains"),
    "flapping-lost": Wanted("flapping", "loses"),
}


@dataclass(frozen=True)
class Missed(NotFound):
    """No threshold up to a force; a farther search might find one.

    Attributes
    ----------
    searched_to : float or None
        Where the search ended [B/L^2]; None where it could not have gone on.
    """

    searched_to: float | None = None


def search(
    model: Model,
    wanted: Wanted,
    near: Bifurcation[Any] | None,
    up_to: float | None,
    progress: Progress | None,
) -> Bifurcation[Any] | NotFound:
    """Return the first bifurcation that is a threshold, looked for near a known one first.

    Parameters
    ----------
    model : Model
        Its own force does not matter.
    wanted : Wanted
    near : Bifurcation or None
        The same of a similar model.
    up_to : float or None
        The largest force of interest [B/L^2].
    progress : callable or None
        Called with each force that was reached.
    """
    check(model, wanted)
    if near is not None:
        found = refind_bifurcation(near, model, FORCE, wanted.is_it, progress)
        if not isinstance(found, NotFound) and (up_to is None or found.value <= up_to):
            return found
    ends = _ends(model, wanted.kind, up_to)
    if isinstance(ends, NotFound):
        return ends
    seen = _Seen(wanted.kind)
    for branch in _branches(model, wanted, ends, progress):
        if isinstance(branch, NotFound):
            return branch
        seen = seen.beyond(branch, ends[1])
        for bifurcation in branch.bifurcations:
            if wanted.is_it(bifurcation) and bifurcation.value <= ends[1]:
                return bifurcation
    return seen.missed(wanted.does)


def check(model: Model, wanted: Wanted) -> None:
    """Refuse a model that cannot have the states of a threshold."""
    if wanted.kind != "equilibrium":
        require_turning(model, wanted.kind)
    if wanted.kind == "spinning":
        require_space(model)


def _ends(model: Model, kind: str, up_to: float | None) -> tuple[float, float] | NotFound:
    """Return the forces between which a kind of state is followed."""
    if kind == "equilibrium":
        return 0.0, up_to or FARTHEST * _ONSET_AT_REST
    straight_onset = onset(model, method="discrete", later=0)
    if straight_onset.force is None:
        return NotFound(SearchStatus.NO_ONSET, str(straight_onset))
    return _BEGINNING * straight_onset.force, up_to or FARTHEST * straight_onset.force


def _branches(
    model: Model, wanted: Wanted, ends: tuple[float, float], progress: Progress | None
) -> Iterator[Branch[Any] | NotFound]:
    """Yield the branch of a kind of state in pieces, upwards from where it begins."""
    start, end = ends
    if wanted.kind != "equilibrium" and is_subcritical(model, wanted.kind):
        born = follow_from_onset(model, wanted.kind, start, progress=progress)
        if isinstance(born, NotFound):
            yield born
            return
        yield born
        if not born.complete or end <= start:
            return
    elif end <= start:
        onset = start / _BEGINNING
        yield Missed(
            SearchStatus.ABSENT,
            f"{wanted.kind} begins at the onset, at force {onset:.6g}, beyond which was not"
            " searched",
            searched_to=end,
        )
        return
    state: Solved | NotFound = kind_by_name(wanted.kind).find(changed(model, FORCE, start))
    first = (start or _ONSET_AT_REST) * FARTHEST
    for place in _stretches(start, min(first, end), end):
        if isinstance(state, NotFound):
            yield state
            return
        branch = follow(state, FORCE, place, progress=progress, enough=wanted.is_it)
        yield branch
        if isinstance(branch, NotFound) or not branch.complete:
            return
        state = branch.states[-1]


def _stretches(start: float, first: float, end: float) -> Iterator[float]:
    """Yield where stretches of a way end, each as long as all before; the last one at its end."""
    place = first
    while place < end:
        yield place
        place += place - start
    yield end


@dataclass(frozen=True)
class _Seen:
    """What was seen of a branch without the threshold on it."""

    kind: str
    begins: float = 0.0
    stable: bool = False
    changed_at: float | None = None
    reached: float | None = None
    complete: bool = True

    def beyond(self, branch: Branch[Any], end: float) -> "_Seen":
        """Return this with what a further piece of the branch shows up to a force."""
        folds = [one.value for one in branch.bifurcations if one.kind == "fold"]
        changes = [
            one.value
            for one in branch.bifurcations
            if (one.gains or one.loses) and one.value <= end
        ]
        first = self.reached is None
        return _Seen(
            kind=self.kind,
            begins=min([float(branch.values[0]), *folds]) if first else self.begins,
            stable=branch.states[0].stable if first else self.stable,
            changed_at=next(iter(changes), None) if self.changed_at is None else self.changed_at,
            reached=min(end, max(float(branch.values.max()), self.reached or 0.0)),
            complete=branch.complete,
        )

    def missed(self, does: str) -> Missed:
        """Return that there is no threshold, in a sentence for what was seen instead."""
        finding = self._sentence(does)
        if self.complete:
            return Missed(SearchStatus.ABSENT, finding, searched_to=self.reached)
        finding += ", beyond which its branch could not be followed"
        return Missed(SearchStatus.NOT_REACHED, finding)

    def _sentence(self, does: str) -> str:
        here, there = f"force {self.begins:.6g}", f"up to force {self.reached:.6g}"
        if does == "gains" and self.stable:
            return (
                f"{self.kind} is stable from its beginning at {here} on, so that it gains nothing"
            )
        if self.stable:
            return f"{self.kind} is stable from {here} {there}"
        if self.changed_at is not None:
            return f"{self.kind} becomes stable at force {self.changed_at:.6g} and stays so {there}"
        lost = ", so that there is no stability to lose" if does == "loses" else ""
        return f"{self.kind} is unstable from {here} {there}{lost}"
