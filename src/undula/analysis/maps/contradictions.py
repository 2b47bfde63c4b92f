"""Points of a sweep whose verdict contradicts the solved states."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
import xarray as xr

from undula.analysis.maps.stability_boundaries import StabilityBoundaries
from undula.analysis.maps.stability_intervals import StabilityIntervals
from undula.analysis.parameters import FORCE
from undula.analysis.regimes.verdict import UNDECIDED
from undula.errors import InputError
from undula.schema.sweep_axes import TRY, axes_of, verdicts_of

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
        Its place on the axes, and its try.
    verdict : str
    sentence : str
        What contradicts what.
    near : bool
        Whether a border is so near that the run may have been too short to tell.
    """

    at: Mapping[str, float]
    verdict: str
    sentence: str
    near: bool


def contradictions(
    store: xr.Dataset, borders: StabilityBoundaries, *, near: float = 0.02
) -> tuple[Disagreement, ...]:
    """Return the points whose verdict contradicts the solved states.

    A run that ends straight, spinning or flapping in a plane has to be where that state is stable;
    one that moves in any other manner contradicts only a force below which nothing moves. What is
    undecided, and forces beyond those that a branch was followed to, contradict nothing.

    Parameters
    ----------
    store : xarray.Dataset
        A stored sweep over the force and, if the borders have one, their parameter.
    borders : Borders
    near : float
        Within this share of a border's force a contradiction is told as near: there rates are so
        small that a run of finite length may show a state that is about to be left.

    Raises
    ------
    InputError
        The store is over other axes.
    """
    _check(store, borders)
    found = []
    for at, verdict in _points(store):
        here = at[FORCE]
        column = borders.columns[_index(borders, at)]
        sentence, edges = _contradiction(verdict, here, column)
        if sentence is not None:
            close = any(abs(here - edge) <= near * edge for edge in edges)
            where = ", ".join(f"{name} = {value:g}" for name, value in at.items() if name != TRY)
            found.append(Disagreement(at, verdict, f"{verdict} at {where}: {sentence}", close))
    return tuple(found)


def _check(store: xr.Dataset, borders: StabilityBoundaries) -> None:
    axes = axes_of(store)
    if FORCE not in axes:
        raise InputError(f"borders are values of {FORCE}, which is no axis of the store; add it")
    if borders.parameter is not None and borders.parameter not in axes:
        raise InputError(
            f"the borders are over {borders.parameter}, which is no axis of the store; solve for"
            " borders over one of its axes"
        )


def _points(store: xr.Dataset) -> Iterator[tuple[dict[str, float], str]]:
    """Yield place and verdict of each run with an answer."""
    verdicts = verdicts_of(store)
    for index in np.argwhere(verdicts.values != ""):
        at = {
            str(name): float(store[name].values[k]) if name in store.coords else float(k)
            for name, k in zip(verdicts.dims, index, strict=True)
        }
        yield at, str(verdicts.values[tuple(index)])


def _index(borders: StabilityBoundaries, at: Mapping[str, float]) -> int:
    """Return which column of the borders a point belongs to."""
    if borders.parameter is None:
        return 0
    return int(np.argmin(np.abs(np.array(borders.values) - at[borders.parameter])))


def _contradiction(
    verdict: str, force: float, column: Mapping[str, StabilityIntervals]
) -> tuple[str | None, tuple[float, ...]]:
    """Return what contradicts a verdict, if anything does, and the forces of borders nearby."""
    kind = KINDS.get(verdict)
    if kind is not None:
        state = column[kind]
        if force > state.searched_to or state.is_stable_at(force):
            return None, ()
        return _told(state, force), state.edges
    begins = [state.begins for state in column.values() if state.kind != "straight"]
    if verdict == UNDECIDED or any(one is None or one <= force for one in begins):
        return None, ()
    edges = tuple(one for one in begins if one is not None)
    return f"spinning and flapping begin at force {min(edges):.6g}", edges


def _told(state: StabilityIntervals, force: float) -> str:
    name = _NAMES[state.kind]
    if state.begins is not None and force < state.begins:
        return f"{name} begins at force {state.begins:.6g}"
    if not state.stable:
        return f"{name} is stable at no force up to {state.searched_to:.6g}"
    stretches = " and ".join(
        f"from {low:.6g} on" if high == np.inf else f"from force {low:.6g} to {high:.6g}"
        for low, high in state.stable
    )
    return f"{name} is stable {stretches} only"
