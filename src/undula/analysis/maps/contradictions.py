"""Points of a sweep whose verdicts contradict the solved states."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
import xarray as xr

from undula.analysis.maps.stability_boundaries import StabilityBoundaries
from undula.analysis.maps.stability_intervals import StabilityIntervals
from undula.analysis.parameters import FORCE
from undula.analysis.regimes.verdict import UNDECIDED
from undula.errors import InputError
from undula.schema.sweep_axes import REPLICATE, axes_of, verdicts_of

#: Kinds of solved states by the verdict that a run of them gets.
KINDS: Mapping[str, str] = {
    "straight": "straight",
    "spinning": "spinning",
    "planar flapping": "flapping",
}
_NAMES: Mapping[str, str] = {
    "straight": "the straight state",
    "spinning": "spinning",
    "flapping": "planar flapping",
}


@dataclass(frozen=True)
class Disagreement:
    """A point whose verdict contradicts the solved states.

    Attributes
    ----------
    at : mapping of str to float
        Its place on the axes, and the number of its replicate.
    verdict : str
        Verdict of the run.
    sentence : str
        The verdict and the stability that it contradicts.
    near : bool
        True if a boundary is so near that the run may have been too short to leave the state.
    """

    at: Mapping[str, float]
    verdict: str
    sentence: str
    near: bool


def contradictions(
    store: xr.Dataset, boundaries: StabilityBoundaries, *, near: float = 0.02
) -> tuple[Disagreement, ...]:
    """Return the points of a sweep whose verdicts contradict the solved states.

    A run that ends straight, spinning or flapping in a plane has to be where that state is stable;
    any other motion contradicts only a force below which nothing moves. Undecided runs, and forces
    beyond those that a branch was followed to, contradict nothing.

    Parameters
    ----------
    store : xarray.Dataset
        A stored sweep over the force and, if the boundaries have one, their parameter.
    boundaries : StabilityBoundaries
        Those of the same model, as from `stability_boundaries`.
    near : float
        Share of a boundary's force within which a contradiction is marked as near: growth rates are
        so small there that a run of finite length may show a state that it is about to leave.

    Returns
    -------
    tuple of Disagreement

    Raises
    ------
    InputError
        The store is over other axes.

    Examples
    --------
    A table of two forces stands for a sweep of `load_sweep`:

    >>> import undula as un
    >>> import xarray as xr
    >>> axes = ("load.force", "try")
    >>> words = [["straight"], ["spinning"]]
    >>> variables = {"status": (axes, [[1], [1]]), "verdict": (axes, words)}
    >>> store = xr.Dataset(variables, {"load.force": [10.0, 20.0]})
    >>> model = un.Filament(8, un.TipLoad(75.0))
    >>> boundaries = un.stability_boundaries(model, None, (), 30.0)
    >>> [point.sentence for point in un.contradictions(store, boundaries)]
    ['spinning at load.force = 20: spinning begins at force 35.193']
    """
    _check(store, boundaries)
    result = []
    for place, verdict in _points(store):
        force = place[FORCE]
        column = boundaries.columns[_index(boundaries, place)]
        sentence, edges = _contradiction(verdict, force, column)
        if sentence is not None:
            close = any(abs(force - edge) <= near * edge for edge in edges)
            where = ", ".join(
                f"{name} = {value:g}" for name, value in place.items() if name != REPLICATE
            )
            result.append(Disagreement(place, verdict, f"{verdict} at {where}: {sentence}", close))
    return tuple(result)


def _check(store: xr.Dataset, boundaries: StabilityBoundaries) -> None:
    """Refuse a store without the axes of the boundaries."""
    axes = axes_of(store)
    if FORCE not in axes:
        raise InputError(f"borders are values of {FORCE}, which is no axis of the store; add it")
    if boundaries.parameter is not None and boundaries.parameter not in axes:
        raise InputError(
            f"the borders are over {boundaries.parameter}, which is no axis of the store; solve for"
            " borders over one of its axes"
        )


def _points(store: xr.Dataset) -> Iterator[tuple[dict[str, float], str]]:
    """Yield place and verdict of each run with an answer."""
    verdicts = verdicts_of(store)
    for index in np.argwhere(verdicts.values != ""):
        place = {
            str(name): float(store[name].values[k]) if name in store.coords else float(k)
            for name, k in zip(verdicts.dims, index, strict=True)
        }
        yield place, str(verdicts.values[tuple(index)])


def _index(boundaries: StabilityBoundaries, place: Mapping[str, float]) -> int:
    """Return the index of the column that a point belongs to."""
    if boundaries.parameter is None:
        return 0
    return int(np.argmin(np.abs(np.array(boundaries.values) - place[boundaries.parameter])))


def _contradiction(
    verdict: str, force: float, column: Mapping[str, StabilityIntervals]
) -> tuple[str | None, tuple[float, ...]]:
    """Return the contradiction in a sentence, None if the verdict is right, and its boundaries."""
    kind = KINDS.get(verdict)
    if kind is not None:
        state = column[kind]
        if force > state.searched_to or state.is_stable_at(force):
            return None, ()
        return _sentence(state, force), state.edges
    # Other motions occur only where spinning or flapping exists; if it is unknown where one of them
    # begins, nothing is contradicted.
    begins = [state.begins for state in column.values() if state.kind != "straight"]
    if verdict == UNDECIDED or any(begin is None or begin <= force for begin in begins):
        return None, ()
    edges = tuple(begin for begin in begins if begin is not None)
    return f"spinning and flapping begin at force {min(edges):.6g}", edges


def _sentence(state: StabilityIntervals, force: float) -> str:
    """Return why a state cannot be seen at a force."""
    name = _NAMES[state.kind]
    if state.begins is not None and force < state.begins:
        return f"{name} begins at force {state.begins:.6g}"
    if not state.stable:
        return f"{name} is stable at no force up to {state.searched_to:.6g}"
    intervals = " and ".join(
        f"from {low:.6g} on" if high == np.inf else f"from force {low:.6g} to {high:.6g}"
        for low, high in state.stable
    )
    return f"{name} is stable {intervals} only"
