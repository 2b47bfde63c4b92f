"""The branch of a kind of state, followed upwards from the force at which it begins.

A supercritical branch begins at the onset and is followed from a little above it. A subcritical one
is followed from the onset down through its fold first.
"""

from collections.abc import Callable, Iterable
from typing import Any

from undula.analysis.solvers.branches import follow_from_onset
from undula.analysis.solvers.criticality import is_subcritical
from undula.analysis.states.branch import Bifurcation, Branch
from undula.analysis.states.follow_branch import Progress
from undula.analysis.states.not_found import NotFound
from undula.models.model import Model

#: Force from which a branch is followed upwards, in multiples of the onset: the amplitude is no
#: longer small there.
START = 1.02


def branch_through_fold(
    model: Model, kind: str, end: float, progress: Progress | None = None
) -> Branch[Any] | NotFound | None:
    """Return the part of a subcritical branch from the onset to a force beyond it.

    Parameters
    ----------
    model : Model
        Its own force does not matter.
    kind : {"spinning", "flapping"}
        Kind of the states.
    end : float
        The force at which to end [B/L^2], beyond the onset.
    progress : callable, optional
        Called with each force that was reached.

    Returns
    -------
    Branch, NotFound or None
        None if the branch is supercritical, so that it begins at the onset.
    """
    if not is_subcritical(model, kind):
        return None
    return follow_from_onset(model, kind, end, progress=progress)


def first_bifurcation(
    bifurcations: Iterable[Bifurcation[Any]], wanted: Callable[[Bifurcation[Any]], bool]
) -> Bifurcation[Any] | None:
    """Return the first bifurcation that is wanted, in the order of following; None if none is."""
    return next(filter(wanted, bifurcations), None)
