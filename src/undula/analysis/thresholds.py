"""Forces at which a state gains or loses stability, without a single run.

- `onset`: the straight state is lost (a Hopf point), of a curved filament the bent state at rest;
- `spinning-lost`: the spinning branch, followed up from its beginning, loses stability;
- `flapping-gained`, `flapping-lost`: planar flapping becomes stable against all disturbances,
  those out of its plane included, and ceases to be.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from undula.analysis.along import model_along
from undula.analysis.branch_records import Bifurcation
from undula.analysis.branches import Progress
from undula.analysis.convergence import converge
from undula.analysis.equilibrium import Equilibrium
from undula.analysis.kinds import follow, kind_of
from undula.analysis.nearby import found_again, quantities_of
from undula.analysis.parameters import FORCE, changed
from undula.analysis.stability import critical_force
from undula.analysis.states import NotFound
from undula.errors import InputError
from undula.models.model import Model

#: Forces up to which thresholds are looked for, in multiples of that of the onset.
FARTHEST = 12.0
# Branches of states begin a little above the onset, where their amplitude is no longer small.
_BEGINNING = 1.02
# Up to this force the loss of an equilibrium is looked for [B/L^2]: as far as of the tip load's.
_FARTHEST_AT_REST = FARTHEST * 38.0


@dataclass(frozen=True)
class Threshold:
    """A force at which stability changes.

    Attributes
    ----------
    kind : str
    value, error : float or None
        The force [B/L^2], None if there is none, and its estimated error; without convergence
        the error is that of locating it on the links as they are.
    frequency : float or None
        Of the state there [cycles per T].
    second_frequency : float or None
        Of the disturbance that turns [cycles per T].
    bifurcation : str or None
        The kind of bifurcation.
    reason : str or None
        Why there is no value.
    at : Bifurcation or None
        The bifurcation itself, on the finest links.
    """

    kind: str
    value: float | None
    error: float | None = None
    frequency: float | None = None
    second_frequency: float | None = None
    bifurcation: str | None = None
    reason: str | None = None
    at: Bifurcation[Any] | None = None

    def __str__(self) -> str:
        """Tell it in one line."""
        if self.value is None:
            return f"no {self.kind}: {self.reason}"
        return (
            f"{self.kind} at force {self.value:.10g} +- {self.error:.1g}, {self.bifurcation},"
            f" {self.frequency:.8g} cycles per T"
        )


@dataclass(frozen=True)
class _Search:
    """Which bifurcation of which kind of state a threshold is, and what the state does there."""

    kind: str
    does: str
    is_it: Callable[[Bifurcation[Any]], bool]


_SEARCHES: Mapping[str, _Search] = {
    "onset": _Search("equilibrium", "lose stability", lambda one: one.loses),
    "spinning-lost": _Search("spinning", "lose stability", lambda one: one.loses),
    "flapping-gained": _Search("flapping", "become stable", lambda one: one.gains),
    "flapping-lost": _Search("flapping", "lose stability", lambda one: one.loses),
}
THRESHOLDS: tuple[str, ...] = tuple(_SEARCHES)


def threshold(
    model: Model,
    kind: str,
    *,
    converged: bool = False,
    near: Threshold | None = None,
    progress: Callable[[int, float], None] | None = None,
) -> Threshold:
    """Return the force at which a state gains or loses stability.

    Parameters
    ----------
    model : Model
        Its own force does not matter.
    kind : {"onset", "spinning-lost", "flapping-gained", "flapping-lost"}
    converged : bool
        Whether to extrapolate to many links.
    near : Threshold, optional
        The same threshold of a similar model, to begin at.
    progress : callable, optional
        Called with the number of links and each force that was reached.

    Raises
    ------
    InputError
        The kind is none of these, or the model has no limit of many links.
    """
    _check_kind(kind)
    if kind == "onset" and model.axisymmetric:
        return _onset(model)
    guess = near.at if near else None

    def search(finer: Model, known: Bifurcation[Any] | None) -> Bifurcation[Any] | NotFound:
        return _search(
            finer, kind, known or guess, partial(progress, finer.links) if progress else None
        )

    if not converged:
        found = search(model, None)
        if isinstance(found, NotFound):
            return Threshold(kind, None, reason=found.reason)
        return _threshold(kind, found, _numbers(found), found.error)
    limit = converge(model, search, _numbers)
    if isinstance(limit, NotFound):
        return Threshold(kind, None, reason=limit.reason)
    return _threshold(kind, limit.finest, limit.values, limit.errors["value"])


def threshold_curve(
    model: Model,
    kind: str,
    parameter: str,
    values: Sequence[float],
    *,
    converged: bool = False,
    progress: Callable[[int, int], None] | None = None,
    stop: Callable[[], bool] = lambda: False,
) -> tuple[Threshold, ...]:
    """Return a threshold at each value of a second parameter, each begun at the one before.

    Parameters
    ----------
    model, kind, converged
        As in `threshold`.
    parameter : str
        Name of the parameter, such as "model.drag_ratio"; the force is none.
    values : sequence of float
    progress : callable, optional
        Called with the number of values done and of all.
    stop : callable, optional
        Tells whether to end with the values done so far.
    """
    if parameter == FORCE:
        raise InputError(f"thresholds are values of {FORCE}; take another parameter for a curve")
    _check_kind(kind)
    shared = model_along(model, _SEARCHES[kind].kind, parameter, values)
    models = [changed(shared, parameter, value) for value in values]
    found: list[Threshold] = []
    for done, each in enumerate(models, start=1):
        near = found[-1] if found and found[-1].value is not None else None
        found.append(threshold(each, kind, converged=converged, near=near))
        if progress:
            progress(done, len(models))
        if stop():
            break
    return tuple(found)


def _check_kind(kind: str) -> None:
    if kind not in THRESHOLDS:
        raise InputError(f"threshold {kind!r} is not known; take {', '.join(THRESHOLDS)}")


def _onset(model: Model) -> Threshold:
    onset = critical_force(model, later=0)
    if onset.hopf is None:
        return Threshold("onset", None, reason=str(onset))
    hopf = onset.hopf
    return Threshold("onset", hopf.force, hopf.error, hopf.frequency, bifurcation="Hopf")


def _numbers(found: Bifurcation[Any]) -> dict[str, float]:
    # A real exponent is one whose second frequency is 0.
    return {"second_frequency": 0.0} | quantities_of(found)


def _threshold(
    kind: str, at: Bifurcation[Any], numbers: Mapping[str, float], error: float
) -> Threshold:
    frequency, second = numbers["frequency"], numbers["second_frequency"] or None
    if isinstance(at.state, Equilibrium):
        frequency, second = second or 0.0, None  # what rests begins to swing
    return Threshold(kind, numbers["value"], error, frequency, second, at.kind, at=at)


def _search(
    model: Model, kind: str, near: Bifurcation[Any] | None, progress: Progress | None
) -> Bifurcation[Any] | NotFound:
    search = _SEARCHES[kind]
    if near is not None:
        found = found_again(near, model, FORCE, search.is_it, progress)
        if not isinstance(found, NotFound):
            return found
    ends = _ends(model, search.kind)
    if isinstance(ends, NotFound):
        return ends
    start, end = ends
    begun = kind_of(search.kind).find(changed(model, FORCE, start))
    if isinstance(begun, NotFound):
        return begun
    branch = follow(begun, FORCE, end, progress=progress, enough=search.is_it)
    for bifurcation in branch.bifurcations:
        if search.is_it(bifurcation):
            return bifurcation
    return NotFound(
        f"{search.kind} is {'stable' if begun.stable else 'unstable'} at force {start:.6g} and does"
        f" not {search.does} up to {branch.values.max():.6g}"
        + ("" if branch.complete else ", beyond which it was not followed")
    )


def _ends(model: Model, kind: str) -> tuple[float, float] | NotFound:
    """Return the forces between which a kind of state is followed."""
    if kind == "equilibrium":
        return 0.0, _FARTHEST_AT_REST
    onset = critical_force(model, method="discrete", later=0)
    if onset.force is None:
        return NotFound(str(onset))
    return _BEGINNING * onset.force, FARTHEST * onset.force
