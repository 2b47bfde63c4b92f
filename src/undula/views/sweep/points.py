"""A stored sweep as the points of a diagram: which axis goes where, and what stands at a point."""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from undula.errors import InputError
from undula.schema.sweep_axes import DONE, FAILED, TRY, axes_of, varied, verdicts_of
from undula.views.common import style

FORCE = "load.force"
#: Verdicts that have no frequency of their own.
AT_REST = ("straight",)
#: A place on the axes of a sweep, and what is to be said of it.
Note = tuple[Mapping[str, float], str]


@dataclass(frozen=True)
class Dot:
    """A verdict at a point of a diagram.

    Attributes
    ----------
    x, y : float
        Place on the axes; y is 0 where there is one axis only.
    verdict : str
        "" without an answer.
    failed : bool
        Whether the point failed, rather than not being done yet.
    frequency : float
        The median over the tries with this verdict, NaN if there is none.
    tries, of : int
        How many tries have this verdict, of how many.
    place, places : int
        Which of the verdicts of its point it is, counted from 0, and how many there are.
    index : mapping of str to int
        Indices into the store of the first such try.
    """

    x: float
    y: float
    verdict: str
    failed: bool
    frequency: float
    tries: int
    of: int
    place: int
    places: int
    index: Mapping[str, int]


def diagram_axes(store: xr.Dataset) -> tuple[str, str | None]:
    """Return the names of the axes to the right and upwards of a stored sweep.

    Raises
    ------
    InputError
        It is none, or varies more than two axes.
    """
    return laid_out(varied(store) or axes_of(store)[:1])


def laid_out(names: Sequence[str]) -> tuple[str, str | None]:
    """Return which of one axis or two goes to the right and which upwards: the force if it can.

    Raises
    ------
    InputError
        There are more, or none.
    """
    if len(names) > 2:
        raise InputError(
            f"the store varies {', '.join(names)}; choose values of all but two of them"
        )
    if not names:
        raise InputError("the store has no axis; give one of a sweep over one axis or two")
    if len(names) == 1:
        return names[0], None
    return (names[1], names[0]) if names[0] == FORCE else (names[0], names[1])


def dots_of(store: xr.Dataset) -> list[Dot]:
    """Return what stands at the points of a store that varies one axis or two."""
    x, y = diagram_axes(store)
    verdicts = verdicts_of(store)
    frequencies = _numbers(store, "frequency", verdicts)
    status = store["status"].transpose(*verdicts.dims).values
    found: list[Dot] = []
    for index in np.ndindex(verdicts.shape[:-1]):
        at = {str(name): k for name, k in zip(verdicts.dims[:-1], index, strict=True)}
        place = float(store[x].values[at[x]]), 0.0 if y is None else float(store[y].values[at[y]])
        words, rates, states = verdicts.values[index], frequencies[index], status[index]
        found += _dots_at(place, at, (words, rates, states))
    return found


def colour_span(dots: Sequence[Dot]) -> tuple[float, float] | None:
    """Return the least and the greatest frequency of dots, None if none has any."""
    rates = np.array([dot.frequency for dot in dots if dot.verdict not in AT_REST])
    known = rates[np.isfinite(rates) & (rates > 0.0)]
    return (float(known.min()), float(known.max())) if known.size else None


def note_at(dot: Dot, names: tuple[str, str | None], notes: Sequence[Note]) -> str | None:
    """Return what is said of a verdict at the place of a dot, None if nothing is."""
    x, y = names
    for at, sentence in notes:
        here = at[x] == dot.x and (y is None or at[y] == dot.y)
        if here and dot.verdict and sentence.startswith(dot.verdict):
            return sentence
    return None


def heading(store: xr.Dataset) -> str:
    """Tell model and load, and the axes of a store that have one value."""
    load = [str(store.attrs["load"])] if "load" in store.attrs else []
    told = [
        f"{style.parameter_label(name)} = {float(store[name].values[0]):g}"
        for name in axes_of(store)
        if store.sizes[name] == 1 and name in store.coords
    ]
    return ", ".join([*load, *told])


def units_of(store: xr.Dataset) -> style.UnitNames:
    """Return the names of a store's units; without any they are those of a filament."""
    given = store.attrs.get("units", "{}")
    return dict(style.FILAMENT) | (json.loads(given) if isinstance(given, str) else dict(given))


def axis_label(name: str, units: style.UnitNames) -> str:
    """Name an axis with its unit."""
    return style.force_label(units) if name == FORCE else style.parameter_label(name)


def kept_shapes(store: xr.Dataset, index: Mapping[str, int]) -> Any:
    """Return the shapes (k, N + 1, 3) that a try has kept, None if it has none."""
    shapes = np.asarray(store["shapes"].isel(dict(index)).transpose("shape", "node", "axis").values)
    kept = np.all(np.isfinite(shapes), axis=(1, 2))
    return shapes[kept] if kept.any() else None


def picked(values: Any, count: int) -> list[float]:
    """Return some of the values of an axis, spread evenly, rising; all if there are no more."""
    rising = np.unique(np.asarray(values, dtype=float))
    step = -(-rising.size // count)
    # What an even step leaves over is left out on both sides.
    first = (rising.size - 1) % step // 2
    return [float(value) for value in rising[first::step]]


def check_shapes(store: xr.Dataset) -> None:
    """Refuse a store that has kept nothing of the last periods.

    Raises
    ------
    InputError
        It has none.
    """
    if "shapes" not in store:
        raise InputError(
            "the store has kept no shapes; run the sweep with study.keep = 'period' to draw them"
        )


def _dots_at(
    place: tuple[float, float], at: Mapping[str, int], tries: tuple[Any, Any, Any]
) -> Iterator[Dot]:
    words, rates, states = tries
    done = np.flatnonzero(states == DONE)
    if not done.size:
        failed = np.flatnonzero(states == FAILED)
        first = int(failed[0]) if failed.size else 0
        yield Dot(*place, "", bool(failed.size), np.nan, 0, 0, 0, 1, {**at, TRY: first})
        return
    # In the order of their first tries.
    named = list(dict.fromkeys(words[done].tolist()))
    for number, verdict in enumerate(named):
        own = done[words[done] == verdict]
        known = rates[own][np.isfinite(rates[own])]
        rate = float(np.median(known)) if known.size else np.nan
        index = {**at, TRY: int(own[0])}
        yield Dot(*place, str(verdict), False, rate, own.size, done.size, number, len(named), index)


def _numbers(store: xr.Dataset, name: str, like: xr.DataArray) -> Any:
    if name not in store:
        return np.full(like.shape, np.nan)
    return np.abs(np.asarray(store[name].transpose(*like.dims).values, dtype=float))
