"""Forces at which a state gains or loses stability, without a run in time.

- `onset`: the straight state is lost (a Hopf point), of a curved filament the bent state at rest;
- `spinning-lost`: the spinning branch, followed up from its beginning, loses stability;
- `flapping-gained`, `flapping-lost`: planar flapping becomes stable against all disturbances,
  those out of its plane included, and ceases to be.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from undula.analysis.linear.results import Method, Onset
from undula.analysis.linear.stability import method_for_all, onset
from undula.analysis.one_thread import on_one_thread
from undula.analysis.parameters import FORCE, changed
from undula.analysis.solvers.refind import alike, quantities_of, refind_bifurcation
from undula.analysis.solvers.threshold_record import Threshold, ThresholdCurve, without_value
from undula.analysis.solvers.threshold_search import WANTED, search
from undula.analysis.states.along_parameter import model_along
from undula.analysis.states.branch import Bifurcation
from undula.analysis.states.extrapolation import converge, error_of_links
from undula.analysis.states.not_found import NotFound, SearchStatus
from undula.analysis.states.records import Equilibrium
from undula.errors import InputError, is_number
from undula.models.model import Model

THRESHOLDS: tuple[str, ...] = tuple(WANTED)


def single_threshold(
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
        "onset": the straight state, or the equilibrium of a curved filament, loses stability. The
        others: spinning or planar flapping loses or gains it.
    converged : bool
        True for the limit of many links, by extrapolation.
    near : Threshold, optional
        The same threshold of a similar model, next to which it is searched for first.
    up_to : float, optional
        The force at which the search ends [B/L^2], above 0; by default 20 times that of the onset.
    method : {"spectral", "modes", "discrete"}, optional
        Discretisation for the onset of a straight state, as in `onset`.
    progress : callable, optional
        Called with the number of links and each force that was reached.

    Returns
    -------
    Threshold
        Without a value, but with a reason, if the search ends without it.

    Raises
    ------
    InputError
        The kind is not one of these, the model cannot have such a state or has no limit of many
        links, or `up_to` is out of range.
    """
    _check_kind(kind)
    if up_to is not None and not (is_number(up_to) and up_to > 0.0):
        raise InputError(f"up_to = {up_to!r} has to be a force above 0")
    if kind == "onset" and model.axisymmetric:
        solved = _onset(model, method, up_to, converged=converged)
    else:
        solved = _bifurcation(model, kind, near, up_to, progress, converged=converged)
    return replace(solved, model=model)


@on_one_thread
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
) -> ThresholdCurve:
    """Return a threshold at each value of a second parameter, each searched next to the last.

    All onsets are computed by one method: on the links at every value if the method of the
    continuum does not apply at each, unless all are taken to the limit of many links.

    Parameters
    ----------
    model, kind, converged, up_to
        As in `threshold`.
    parameter : str
        Name of the parameter, such as "model.drag_ratio"; not the force.
    values : sequence of float
        At least one.
    progress : callable, optional
        Called with the number of values done and of all.
    stop : callable, optional
        Called after each value; the curve ends where it returns True.

    Returns
    -------
    ThresholdCurve
        A sequence of thresholds, one for each value, fewer if stopped.

    Raises
    ------
    InputError
        The parameter is the force or is not known, a value is out of its range, or as in
        `threshold`.

    Examples
    --------
    >>> import undula as un
    >>> model = un.Filament(40, un.TipLoad(75.0))
    >>> onsets = un.threshold(model, "onset", along=("model.drag_ratio", [1.5, 2.0]))
    >>> [round(onset.value, 4) for onset in onsets]
    [37.6954, 37.6954]
    """
    if parameter == FORCE:
        raise InputError(f"thresholds are values of {FORCE}; take another parameter for a curve")
    _check_kind(kind)
    shared = model_along(model, WANTED[kind].kind, parameter, values)
    models = [changed(shared, parameter, value) for value in values]
    method = None if converged else method_for_all(models)
    curve: list[Threshold] = []
    for done, here in enumerate(models, start=1):
        near = curve[-1] if curve and curve[-1].value is not None else None
        curve.append(
            single_threshold(here, kind, converged=converged, near=near, up_to=up_to, method=method)
        )
        if progress:
            progress(done, len(models))
        if stop():
            break
    done_values = np.array([float(value) for value in values[: len(curve)]])
    return ThresholdCurve(kind, parameter, done_values, tuple(curve))


def threshold_on_links(
    model: Model, kind: str, *, near: Threshold | None = None, method: Method | None = None
) -> Threshold:
    """Return a threshold without the error of its links; arguments are those of `threshold`.

    An onset of the straight state is that of the continuum if the model has one, with its error.
    """
    if kind == "onset" and model.axisymmetric:
        return _onset(model, method, None, converged=False)
    return _bifurcation_on_links(model, kind, near, None, None)


def _bifurcation_on_links(
    model: Model,
    kind: str,
    near: Threshold | None,
    up_to: float | None,
    progress: Callable[[int, float], None] | None,
) -> Threshold:
    reached = partial(progress, model.links) if progress else None
    point = search(model, WANTED[kind], near.at if near else None, up_to, reached)
    if isinstance(point, NotFound):
        return without_value(kind, point)
    return _threshold(kind, point, _numbers(point), None, (model.links,), point.error)


def _bifurcation(
    model: Model,
    kind: str,
    near: Threshold | None,
    up_to: float | None,
    progress: Callable[[int, float], None] | None,
    *,
    converged: bool,
) -> Threshold:
    """Return a threshold that is a bifurcation of a branch of bent states."""
    if not converged:
        single = _bifurcation_on_links(model, kind, near, up_to, progress)
        by_links = _error_of_links(single.at, model) if single.at else None
        error = None if by_links is None else by_links + (single.solver_error or 0.0)
        return replace(single, error=error)
    guess = near.at if near else None

    def solve(finer: Model, coarser: Bifurcation[Any] | None) -> Bifurcation[Any] | NotFound:
        reached = partial(progress, finer.links) if progress else None
        return search(finer, WANTED[kind], coarser or guess, up_to, reached)

    limit = converge(model, solve, _numbers)
    if isinstance(limit, NotFound):
        return without_value(kind, limit)
    error = limit.errors["value"] + limit.finest.error
    return _threshold(kind, limit.finest, limit.values, error, limit.links, limit.finest.error)


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
            return without_value("onset", limit)
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
    assert onset.hopf is not None  # as `_crossing_of` returns it
    return {"value": onset.hopf.force, "frequency": onset.hopf.frequency}


def _error_of_links(point: Bifurcation[Any], model: Model) -> float | None:
    def again(other: Model) -> float | None:
        same = refind_bifurcation(point, other, FORCE, lambda candidate: alike(candidate, point))
        return None if isinstance(same, NotFound) else same.value

    return error_of_links(model, point.value, again)


def _numbers(point: Bifurcation[Any]) -> dict[str, float]:
    # A real exponent has a second frequency of 0.
    return {"second_frequency": 0.0} | quantities_of(point)


def _threshold(
    kind: str,
    point: Bifurcation[Any],
    numbers: Mapping[str, float],
    error: float | None,
    links: tuple[int, ...],
    solver_error: float,
) -> Threshold:
    frequency, second = numbers["frequency"], numbers["second_frequency"] or None
    if isinstance(point.state, Equilibrium):
        frequency, second = second or 0.0, None  # a state at rest begins to swing
    return Threshold(
        kind,
        numbers["value"],
        error,
        frequency,
        second,
        point.kind,
        at=point,
        links=links,
        solver_error=solver_error,
    )
