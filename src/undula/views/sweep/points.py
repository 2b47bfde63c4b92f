"""Points of a diagram of a stored sweep: arrangement of the axes, and verdicts at each point."""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from undula.errors import InputError
from undula.schema.sweep_axes import DONE, FAILED, REPLICATE, axes_of, varied, verdicts_of
from undula.views.common import style

FORCE = "load.force"
#: Verdicts that have no frequency of their own.
AT_REST = ("straight",)
#: A place on the axes of a sweep, and a sentence on it.
Note = tuple[Mapping[str, float], str]


@dataclass(frozen=True)
class Dot:
    """A verdict at a point of a diagram.

    Attributes
    ----------
    x, y : float
        Place on the axes; y is 0 for a single axis.
    verdict : str
        The verdict; "" without a result.
    failed : bool
        True if the point has failed, False if it is not done.
    frequency : float
        Median frequency of the replicates with this verdict, NaN without one.
    tries, of : int
        Number of replicates with this verdict, and of all replicates with a result.
    place, places : int
        Place of the verdict among those of its point, from 0 on, and their number.
    index : mapping of str to int
        Indices of the first such replicate in the store.
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
    """Return the names of the horizontal and the vertical axis of a stored sweep.

    Raises
    ------
    InputError
        The dataset is not a stored sweep, or varies more than two axes.
    """
    return laid_out(varied(store) or axes_of(store)[:1])


def laid_out(names: Sequence[str]) -> tuple[str, str | None]:
    """Return the horizontal and the vertical axis; of two axes the force is vertical.

    Raises
    ------
    InputError
        More than two names or no name is given.
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
    """Return the dots of a store that varies one or two axes."""
    x, y = diagram_axes(store)
    verdicts = verdicts_of(store)
    frequencies = _numbers(store, "frequency", verdicts)
    status = store["status"].transpose(*verdicts.dims).values
    dots: list[Dot] = []
    for index in np.ndindex(verdicts.shape[:-1]):
        indices = {str(name): k for name, k in zip(verdicts.dims[:-1], index, strict=True)}
        height = 0.0 if y is None else float(store[y].values[indices[y]])
        place = float(store[x].values[indices[x]]), height
        words, rates, states = verdicts.values[index], frequencies[index], status[index]
        dots += _dots_at(place, indices, (words, rates, states))
    return dots


def colour_span(dots: Sequence[Dot]) -> tuple[float, float] | None:
    """Return the least and the greatest frequency of dots, None without any frequency."""
    rates = np.array([dot.frequency for dot in dots if dot.verdict not in AT_REST])
    positive = rates[np.isfinite(rates) & (rates > 0.0)]
    return (float(positive.min()), float(positive.max())) if positive.size else None


def note_at(dot: Dot, names: tuple[str, str | None], notes: Sequence[Note]) -> str | None:
    """Return the note on the verdict of a dot, None without a note.

    Parameters
    ----------
    dot
        The dot.
    names
        Names of the horizontal and the vertical axis.
    notes
        All notes.
    """
    x, y = names
    for place, sentence in notes:
        same = place[x] == dot.x and (y is None or place[y] == dot.y)
        if same and dot.verdict and sentence.startswith(dot.verdict):
            return sentence
    return None


def heading(store: xr.Dataset) -> str:
    """Return model and load in words, and the values of axes that do not vary."""
    load = [str(store.attrs["load"])] if "load" in store.attrs else []
    fixed = [
        f"{style.parameter_label(name)} = {float(store[name].values[0]):g}"
        for name in axes_of(store)
        if store.sizes[name] == 1 and name in store.coords
    ]
    return ", ".join([*load, *fixed])


def units_of(store: xr.Dataset) -> style.UnitNames:
    """Return the names of a store's units; those of a filament if it names none."""
    named = store.attrs.get("units", "{}")
    return dict(style.FILAMENT) | (json.loads(named) if isinstance(named, str) else dict(named))


def axis_label(name: str, units: style.UnitNames) -> str:
    """Return the name of an axis with its unit.

    Parameters
    ----------
    name
        Name of the axis.
    units
        Names of the units by quantity.
    """
    return style.force_label(units) if name == FORCE else style.parameter_label(name)


def stored_shapes(store: xr.Dataset, index: Mapping[str, int]) -> Any:
    """Return the stored shapes (k, N + 1, 3) of a replicate, None without shapes.

    Parameters
    ----------
    store
        The stored sweep.
    index
        Indices of the replicate.
    """
    shapes = np.asarray(store["shapes"].isel(dict(index)).transpose("shape", "node", "axis").values)
    complete = np.all(np.isfinite(shapes), axis=(1, 2))
    return shapes[complete] if complete.any() else None


def even_selection(values: Any, count: int) -> list[float]:
    """Return at most `count` evenly spaced values of an axis, rising.

    Parameters
    ----------
    values
        Values of the axis.
    count
        Largest number of values.
    """
    rising = np.unique(np.asarray(values, dtype=float))
    step = -(-rising.size // count)
    # The values that an even step leaves over are omitted on both sides.
    first = (rising.size - 1) % step // 2
    return [float(value) for value in rising[first::step]]


def check_shapes(store: xr.Dataset) -> None:
    """Refuse a store without shapes of last periods.

    Raises
    ------
    InputError
        The store has no shapes.
    """
    if "shapes" not in store:
        raise InputError(
            "the store has kept no shapes; run the sweep with study.keep = 'period' to draw them"
        )


def _dots_at(
    place: tuple[float, float], indices: Mapping[str, int], replicates: tuple[Any, Any, Any]
) -> Iterator[Dot]:
    """Yield the dots of a point from verdicts, frequencies and status of its replicates."""
    words, rates, states = replicates
    done = np.flatnonzero(states == DONE)
    if not done.size:
        failed = np.flatnonzero(states == FAILED)
        first = int(failed[0]) if failed.size else 0
        yield Dot(*place, "", bool(failed.size), np.nan, 0, 0, 0, 1, {**indices, REPLICATE: first})
        return
    # Verdicts are in the order of their first replicates.
    named = list(dict.fromkeys(words[done].tolist()))
    for number, verdict in enumerate(named):
        own = done[words[done] == verdict]
        finite = rates[own][np.isfinite(rates[own])]
        rate = float(np.median(finite)) if finite.size else np.nan
        index = {**indices, REPLICATE: int(own[0])}
        yield Dot(*place, str(verdict), False, rate, own.size, done.size, number, len(named), index)


def _numbers(store: xr.Dataset, name: str, like: xr.DataArray) -> Any:
    if name not in store:
        return np.full(like.shape, np.nan)
    return np.abs(np.asarray(store[name].transpose(*like.dims).values, dtype=float))
