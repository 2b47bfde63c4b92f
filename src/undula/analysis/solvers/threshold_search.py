"""The search for a threshold: the branch of a state followed from its beginning up to a force.

A subcritical branch is followed from the onset through its fold, a supercritical one from a little
above the onset. Large forces are reached in pieces, each as long as all before it, so that the
first steps do not grow with the largest force.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from undula.analysis.linear.stability import onset
from undula.analysis.parameters import FORCE, changed
from undula.analysis.solvers.branches import follow
from undula.analysis.solvers.refind import refind_bifurcation
from undula.analysis.solvers.state_kinds import Solved, kind_by_name
from undula.analysis.solvers.symmetry import require_space, require_turning
from undula.analysis.solvers.upward_branch import START, branch_through_fold, first_bifurcation
from undula.analysis.states.branch import Bifurcation, Branch
from undula.analysis.states.follow_branch import Progress
from undula.analysis.states.not_found import NotFound, SearchStatus
from undula.models.model import Model

#: Force up to which thresholds are searched by default, in multiples of the onset.
FARTHEST = 20.0
# Scale of the force for states at rest, which have no onset: that of the tip load [B/L^2].
_ONSET_AT_REST = 38.0


@dataclass(frozen=True)
class Wanted:
    """The bifurcation that a threshold is.

    Attributes
    ----------
    kind : str
        Kind of the state.
    does : {"gains", "loses"}
        Change of the state's stability.
    """

    kind: str
    does: str

    def is_it(self, bifurcation: Bifurcation[Any]) -> bool:
        """Return whether a bifurcation is the threshold."""
        return bifurcation.gains if self.does == "gains" else bifurcation.loses


WANTED: Mapping[str, Wanted] = {
    "onset": Wanted("equilibrium", "loses"),
    "spinning-lost": Wanted("spinning", "loses"),
    "flapping-gained": Wanted("flapping", "gains"),
    "flapping-lost": Wanted("flapping", "loses"),
}


@dataclass(frozen=True, repr=False)
class Missed(NotFound):
    """No threshold up to a force; a farther search might find one.

    Attributes
    ----------
    searched_to : float or None
        Force at which the search ended [B/L^2]; None if the branch could not be followed farther.
    """

    searched_to: float | None = None


def search(
    model: Model,
    wanted: Wanted,
    near: Bifurcation[Any] | None,
    up_to: float | None,
    progress: Progress | None,
) -> Bifurcation[Any] | NotFound:
    """Return the bifurcation of a threshold: next to a known one, else the first on the branch.

    Parameters
    ----------
    model : Model
        Its own force does not matter.
    wanted : Wanted
        The threshold: kind of state and change of its stability.
    near : Bifurcation or None
        The same bifurcation of a similar model.
    up_to : float or None
        The largest force of interest [B/L^2].
    progress : callable or None
        Called with each force that was reached.

    Returns
    -------
    Bifurcation or NotFound

    Raises
    ------
    InputError
        The model cannot have the states of the threshold.
    """
    _require_states(model, wanted)
    if near is not None:
        refound = refind_bifurcation(near, model, FORCE, wanted.is_it, progress)
        if not isinstance(refound, NotFound) and (up_to is None or refound.value <= up_to):
            return refound
    ends = _ends(model, wanted.kind, up_to)
    if isinstance(ends, NotFound):
        return ends
    searched = _Searched(wanted.kind)
    for branch in _pieces(model, wanted, ends, progress):
        if isinstance(branch, NotFound):
            return branch
        searched = searched.beyond(branch, ends[1])
        reachable = [point for point in branch.bifurcations if point.value <= ends[1]]
        bifurcation = first_bifurcation(reachable, wanted.is_it)
        if bifurcation is not None:
            return bifurcation
    return searched.missed(wanted.does)


def _require_states(model: Model, wanted: Wanted) -> None:
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
    return START * straight_onset.force, up_to or FARTHEST * straight_onset.force


def _pieces(
    model: Model, wanted: Wanted, ends: tuple[float, float], progress: Progress | None
) -> Iterator[Branch[Any] | NotFound]:
    """Yield the branch of a kind of state in pieces, upwards from its beginning."""
    start, end = ends
    if wanted.kind != "equilibrium":
        folded = branch_through_fold(model, wanted.kind, start, progress)
        if folded is not None:
            yield folded
            if isinstance(folded, NotFound) or not folded.complete or end <= start:
                return
        elif end <= start:
            yield Missed(
                SearchStatus.ABSENT,
                f"{wanted.kind} begins at the onset, at force {start / START:.6g}, beyond which was"
                " not searched",
                searched_to=end,
            )
            return
    state: Solved | NotFound = kind_by_name(wanted.kind).find(changed(model, FORCE, start))
    first_end = (start or _ONSET_AT_REST) * FARTHEST
    for force in _doubling(start, min(first_end, end), end):
        if isinstance(state, NotFound):
            yield state
            return
        branch = follow(state, FORCE, force, progress=progress, enough=wanted.is_it)
        yield branch
        if isinstance(branch, NotFound) or not branch.complete:
            return
        state = branch.states[-1]


def _doubling(start: float, first: float, end: float) -> Iterator[float]:
    """Yield the ends of pieces, each as long as all before; the last one at the end."""
    force = first
    while force < end:
        yield force
        force += force - start
    yield end


@dataclass(frozen=True)
class _Searched:
    """Stability along the part of a branch that was searched and does not hold the threshold.

    Attributes
    ----------
    kind : str
    begins : float
        Least force.
    stable : bool
        True if the branch is stable where it begins.
    changed_at : float or None
        Force of the first gain or loss of stability.
    reached : float or None
        Greatest force; None before anything was searched.
    complete : bool
        False if the branch could not be followed to the end of its last piece.
    """

    kind: str
    begins: float = 0.0
    stable: bool = False
    changed_at: float | None = None
    reached: float | None = None
    complete: bool = True

    def beyond(self, branch: Branch[Any], end: float) -> "_Searched":
        """Return the record extended by a further piece of the branch, up to a force."""
        folds = [point.value for point in branch.bifurcations if point.kind == "fold"]
        changes = [
            point.value
            for point in branch.bifurcations
            if (point.gains or point.loses) and point.value <= end
        ]
        first = self.reached is None
        return _Searched(
            kind=self.kind,
            begins=min([float(branch.values[0]), *folds]) if first else self.begins,
            stable=branch.states[0].stable if first else self.stable,
            changed_at=next(iter(changes), None) if self.changed_at is None else self.changed_at,
            reached=min(end, max(float(branch.values.max()), self.reached or 0.0)),
            complete=branch.complete,
        )

    def missed(self, does: str) -> Missed:
        """Return the failure, with the stability of the branch in a sentence."""
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
