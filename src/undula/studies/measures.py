"""What the claims of the catalogue measure on answers, beyond arithmetic."""

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from undula.arrays import Points
from undula.errors import InputError
from undula.studies.store import load_result
from undula.studies.study_store import load_study

__all__ = [
    "at",
    "between",
    "crossing",
    "holding",
    "result",
    "study",
]


def result(answer: Any) -> xr.Dataset:
    """Return the stored run of an answer of `undula run`."""
    return load_result(answer.folder / "run.nc")


def study(answer: Any) -> xr.Dataset:
    """Return the stored study of an answer of `undula sweep`, kept as study.zarr."""
    return load_study(answer.folder / "study.zarr")


def at(where: float, of: ArrayLike, values: ArrayLike) -> float:
    """Return the value at a place between neighbouring ones, by a parabola through three.

    Parameters
    ----------
    where
        The place.
    of, values
        Places, increasing, and the values there.

    Raises
    ------
    ValueError
        The place is outside.
    """
    places, known = _sorted(of, values)
    if not places[0] <= where <= places[-1]:
        raise ValueError(f"{where:g} is outside of {places[0]:g} to {places[-1]:g}")
    middle = int(np.clip(np.searchsorted(places, where), 1, len(places) - 2))
    near = slice(middle - 1, middle + 2)
    offsets = places[near] - where
    return float(np.polynomial.polynomial.polyfit(offsets, known[near], 2)[0])


def between(low: float, high: float, of: ArrayLike, values: ArrayLike) -> Points:
    """Return the values at places from `low` to `high`."""
    places, known = _sorted(of, values)
    return known[(places >= low) & (places <= high)]


def holding(of: ArrayLike, condition: ArrayLike, around: float) -> list[float]:
    """Return the ends of the range around a place over which a condition holds.

    Parameters
    ----------
    of
        Places, increasing.
    condition
        Positive where it holds; the ends are where it passes through zero.
    around
        A place inside.

    Raises
    ------
    ValueError
        It does not hold there.
    """
    places, margin = _sorted(of, condition)
    inside = int(np.abs(places - around).argmin())
    if not margin[inside] > 0.0:
        raise ValueError(f"it does not hold at {around:g}")
    failing = ~(margin > 0.0)
    before = np.flatnonzero(failing[:inside])
    after = np.flatnonzero(failing[inside:])
    low = places[0] if not len(before) else _zero(places, margin, int(before[-1]))
    high = places[-1] if not len(after) else _zero(places, margin, inside + int(after[0]) - 1)
    return [float(low), float(high)]


def crossing(of: ArrayLike, values: ArrayLike) -> float:
    """Return the first place at which values, linear in between, pass through zero.

    Raises
    ------
    ValueError
        They do not.
    """
    places, known = _sorted(of, values)
    changes = np.flatnonzero(np.sign(known[1:]) != np.sign(known[:-1]))
    if not len(changes):
        raise ValueError("the values do not pass through zero")
    return _zero(places, known, int(changes[0]))


def _zero(places: Points, values: Points, left: int) -> float:
    a, b = values[left], values[left + 1]
    if not np.isfinite(a + b):
        return float(places[left + 1] if np.isfinite(b) else places[left])
    return float(places[left] - a * (places[left + 1] - places[left]) / (b - a))


def _sorted(of: ArrayLike, values: ArrayLike) -> tuple[Points, Points]:
    places, known = np.asarray(of, dtype=float), np.asarray(values, dtype=float)
    if len(places) < 3:
        raise InputError(f"a curve of {len(places)} points is too short; give at least 3")
    order = np.argsort(places, kind="stable")
    return places[order], known[order]
