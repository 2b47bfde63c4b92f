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

from undula.analysis.linear.results import Method, Onset
from undula.analysis.linear.stability import method_for_all, onset
from undula.analysis.parameters import FORCE, changed
from undula.analysis.solvers.refind import alike, quantities_of, refind_bifurcation
from undula.analysis.solvers.threshold_search import WANTED, Missed, search
from undula.analysis.states.along_parameter import model_along
from undula.analysis.states.branch import Bifurcation
from undula.analysis.states.extrapolation import converge, error_of_links
from undula.analysis.states.not_found import NotFound, SearchStatus
from undula.analysis.states.records import Equilibrium
from undula.errors import InputError, is_number
from undula.models.model import Model

THRESHOLDS: tuple[str, ...] = tuple(WANTED)


@dataclass(frozen=True)
class Threshold:
    """A force at which stability changes.

    Attributes
    ----------
    kind : str
    value : float or None
        The force [B/L^2]: of the body if `links` are several or none, else on these links. None if
        there is none.
    error : float or None
        Its estimated error against the body that the numbers stand for, of links and solver
        together; None if that could not be told.
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
    links : tuple of int
        The numbers of links that it was solved for with; none for the method of the continuum.
    solver_error : float or None
        How exactly it was solved for on these links.
    searched_to : float or None
        The force at which the search ended without it, where a farther one might find it.
    """

    kind: str
    value: float | None
    error: float | None = None
    frequency: float | None = None
    second_frequency: float | None = None
    bifurcation: str | None = None
    reason: str | None = None
    at: Bifurcation[Any] | None = None
    links: tuple[int, ...] = ()
    solver_error: float | None = None
    searched_to: float | None = None

    def __str__(self) -> str:
        """Tell it in one line."""
        if self.value is None:
            farther = "" if self.searched_to is None else "; a larger up_to looks farther"
            return f"no {self.kind}: {self.reason}{farther}"
        apart = "" if self.error is None else f" +- {self.error:.1g}"
        links = ""
        if len(self.links) == 1 and self.error != self.solver_error:
            links = f" ({self.links[0]} links, solved to {self.solver_error:.1g})"
        return (
            f"{self.kind} at force {self.value:.10g}{apart}{links}, {self.bifurcation},"
            f" {self.frequency:.8g} cycles per T"
        )


def threshold(
    model: Model,
    kind: str,
    *,
    converged: bool = False,
    near: Threshold | None = None,
    up_to: float | None = None,
    method: Method | None = None,
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
    up_to : float, optional
        The force at which the search ends [B/L^2], above 0; by default 20 times that of the onset.
    method : {"spectral", "modes", "discrete"}, optional
        How the onset of a straight state is computed, as in `onset`.
    progress : callable, optional
        Called with the number of links and each force that was reached.

    Raises
    ------
    InputError
        The kind is none of these, the model cannot have such a state or has no limit of many links,
        or `up_to` is out of range.
    """
    _check_kind(kind)
    if up_to is not None and not (is_number(up_to) and up_to > 0.0):
        raise InputError(f"up_to = {up_to!r} has to be a force above 0")
    if kind == "onset" and model.axisymmetric:
        return _onset(model, method, up_to, converged=converged)
    guess = near.at if near else None

    def look(finer: Model, known: Bifurcation[Any] | None) -> Bifurcation[Any] | NotFound:
        told = partial(progress, finer.links) if progress else None
        return search(finer, WANTED[kind], known or guess, up_to, told)

    if not converged:
        found = look(model, None)
        if isinstance(found, NotFound):
            return _none(kind, found)
        by_links = _error_of_links(found, model)
        error = None if by_links is None else by_links + found.error
        return _threshold(kind, found, _numbers(found), error, (model.links,), found.error)
    limit = converge(model, look, _numbers)
    if isinstance(limit, NotFound):
        return _none(kind, limit)
    at, error = limit.finest, limit.errors["value"] + limit.finest.error
    return _threshold(kind, at, limit.values, error, limit.links, at.error)


def threshold_curve(
    model: Model,
    kind: str,
    parameter: str,
    values: Sequence[float],
    *,
    converged: bool = False,
    up_to: float | None = None,
    progress: Callable[[int, int], None] | None = None,
    stop: Callable[[], bool] = lambda: False,
) -> tuple[Threshold, ...]:
    """Return a threshold at each value of a second parameter, each begun at the one before.

    All are of one kind: an onset is computed by the links at every value if the method of the
    continuum does not hold at each, unless all are taken to the limit of many links.

    Parameters
    ----------
    model, kind, converged, up_to
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
    shared = model_along(model, WANTED[kind].kind, parameter, values)
    models = [changed(shared, parameter, value) for value in values]
    method = None if converged else method_for_all(models)
    found: list[Threshold] = []
    for done, each in enumerate(models, start=1):
        near = found[-1] if found and found[-1].value is not None else None
        found.append(
            threshold(each, kind, converged=converged, near=near, up_to=up_to, method=method)
        )
        if progress:
            progress(done, len(models))
        if stop():
            break
    return tuple(found)


def _check_kind(kind: str) -> None:
    if kind not in THRESHOLDS:
        raise InputError(f"threshold {kind!r} is not known; take {', '.join(THRESHOLDS)}")


def _onset(
    model: Model, method: Method | None, up_to: float | None, *, converged: bool
) -> Threshold:
    """Return the onset of a straight state."""
    links: tuple[int, ...] = (model.links,)
    if converged and model.continuum_load is None and model.with_links(2 * model.links) is not None:
        limit = converge(model, lambda finer, _: _crossing_of(finer), _of_crossing)
        if isinstance(limit, NotFound):
            return _none("onset", limit)
        straight_onset, links = limit.finest, limit.links
        force, frequency = limit.values["value"], limit.values["frequency"]
        error = limit.errors["value"]
    else:
        straight_onset = onset(model, method=method, later=0)
        if straight_onset.hopf is None:
            return Threshold("onset", None, reason=str(straight_onset))
        force, frequency, error = (
            straight_onset.hopf.force,
            straight_onset.hopf.frequency,
            straight_onset.hopf.error,
        )
    if up_to is not None and force > up_to:
        reason = f"the straight state is stable up to force {up_to:.6g}"
        return Threshold("onset", None, reason=reason, searched_to=up_to)
    assert straight_onset.hopf is not None
    return Threshold(
        "onset",
        force,
        error,
        frequency,
        bifurcation="Hopf",
        links=links if straight_onset.method == "discrete" else (),
        solver_error=straight_onset.hopf.round_off
        if straight_onset.method == "discrete"
        else error,
    )


def _crossing_of(model: Model) -> Onset | NotFound:
    straight_onset = onset(model, method="discrete", later=0)
    if straight_onset.hopf is None:
        return NotFound(SearchStatus.NO_ONSET, str(straight_onset))
    return straight_onset


def _of_crossing(onset: Onset) -> dict[str, float]:
    assert onset.hopf is not None  # others are none
    return {"value": onset.hopf.force, "frequency": onset.hopf.frequency}


def _none(kind: str, found: NotFound) -> Threshold:
    searched_to = found.searched_to if isinstance(found, Missed) else None
    return Threshold(kind, None, reason=found.reason, searched_to=searched_to)


def _error_of_links(found: Bifurcation[Any], model: Model) -> float | None:
    def again(other: Model) -> float | None:
        same = refind_bifurcation(found, other, FORCE, lambda one: alike(one, found))
        return None if isinstance(same, NotFound) else same.value

    return error_of_links(model, found.value, again)


def _numbers(found: Bifurcation[Any]) -> dict[str, float]:
    # A real exponent is one whose second frequency is 0.
    return {"second_frequency": 0.0} | quantities_of(found)


def _threshold(
    kind: str,
    at: Bifurcation[Any],
    numbers: Mapping[str, float],
    error: float | None,
    links: tuple[int, ...],
    solver_error: float,
) -> Threshold:
    frequency, second = numbers["frequency"], numbers["second_frequency"] or None
    if isinstance(at.state, Equilibrium):
        frequency, second = second or 0.0, None  # what rests begins to swing
    return Threshold(
        kind,
        numbers["value"],
        error,
        frequency,
        second,
        at.kind,
        at=at,
        links=links,
        solver_error=solver_error,
    )
