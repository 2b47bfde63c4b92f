"""What the claims of the catalogue measure on answers, beyond arithmetic.

Curves are points in any order; a claim on a range asks where a condition holds without a gap.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicSpline

from undula.arrays import Points

__all__ = [
    "at",
    "crossing",
    "exactly",
    "falling",
    "first_present",
    "forces",
    "gaining",
    "holding",
    "holding_error",
    "largest_spread",
    "minimum",
    "missing",
    "on",
    "peak",
    "peak_error",
    "regimes",
    "roundoff",
    "slowness",
    "spinning_energy",
]

FORCE = "load.force"


def at(where: float, of: ArrayLike, values: ArrayLike) -> float:
    """Return the value of a curve at a place, by the parabola through three points around it.

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
    return float(_parabola(places[near] - where, known[near])[0])


def exactly(where: float, of: ArrayLike, values: ArrayLike) -> float:
    """Return what was computed at a place itself.

    Raises
    ------
    ValueError
        Nothing was.
    """
    found = np.flatnonzero(np.asarray(of, dtype=float) == where)
    if not len(found):
        raise ValueError(f"nothing was computed at {where:g}")
    return float(np.asarray(values, dtype=float)[found[0]])


def on(where: ArrayLike, of: ArrayLike, values: ArrayLike) -> Points:
    """Return a curve at several places, from the nearest three of its own points each."""
    places, known = _sorted(of, values)
    wanted = np.asarray(where, dtype=float)
    return np.array([at(min(max(one, places[0]), places[-1]), places, known) for one in wanted])


def holding(of: ArrayLike, condition: ArrayLike, around: float) -> list[float]:
    """Return the ends of the range around a place over which a condition holds.

    Parameters
    ----------
    of
        Places.
    condition
        Positive where it holds; the range ends where it passes through zero, or with the places.
    around
        A place inside.

    Raises
    ------
    ValueError
        It does not hold there.
    """
    return _range(*_sorted(of, condition), around, _zero)


def holding_error(of: ArrayLike, condition: ArrayLike, around: float) -> list[float]:
    """Return the errors of the ends: what a straight line between points would make of them."""
    places, margin = _sorted(of, condition)
    smooth, straight = (_range(places, margin, around, zero) for zero in (_zero, _straight_zero))
    return [abs(one - other) for one, other in zip(smooth, straight, strict=True)]


def crossing(of: ArrayLike, values: ArrayLike) -> float:
    """Return the first place at which a curve passes through zero.

    Raises
    ------
    ValueError
        It does not.
    """
    places, known = _sorted(of, values)
    changes = np.flatnonzero(np.sign(known[1:]) != np.sign(known[:-1]))
    if not len(changes):
        raise ValueError("the values do not pass through zero")
    return _zero(places, known, int(changes[0]))


def peak(of: ArrayLike, values: ArrayLike) -> float:
    """Return the place of the first maximum of a curve inside of its ends.

    Raises
    ------
    ValueError
        There is none.
    """
    places, known = _sorted(of, values)
    inner = known[1:-1]
    tops = np.flatnonzero((inner > known[:-2]) & (inner >= known[2:])) + 1
    if not len(tops):
        raise ValueError("the values have no maximum inside")
    top = int(tops[0])
    flat = CubicSpline(places, known).derivative().roots(extrapolate=False)
    return float(flat[np.abs(flat - places[top]).argmin()])


def peak_error(of: ArrayLike, values: ArrayLike) -> float:
    """Return the error of that place: what a parabola through the three greatest makes of it."""
    places, known = _sorted(of, values)
    found = peak(places, known)
    middle = int(np.clip(np.abs(places - found).argmin(), 1, len(places) - 2))
    near = slice(middle - 1, middle + 2)
    _, slope, bend = _parabola(places[near] - found, known[near])
    return float(abs(slope / (2.0 * bend)))


def minimum(first: ArrayLike, second: ArrayLike) -> Points:
    """Return the smaller of two values, place by place: both conditions have to hold."""
    return np.asarray(np.minimum(first, second), dtype=float)


def falling(values: ArrayLike) -> bool:
    """Return whether every value is smaller than the one before."""
    return bool((np.diff(np.asarray(values, dtype=float)) < 0.0).all())


def missing(values: ArrayLike) -> Any:
    """Return where an answer has no value."""
    return np.isnan(np.asarray(values, dtype=float))


def first_present(of: ArrayLike, values: ArrayLike) -> list[float]:
    """Return the place from which on there are values, and half of the gap before as its error."""
    places, known = _sorted(of, values)
    first = int(np.flatnonzero(~np.isnan(known))[0])
    low = places[max(first - 1, 0)]
    return [float((low + places[first]) / 2.0), float((places[first] - low) / 2.0)]


def forces(branch: Any, *, above: float = 0.0) -> Points:
    """Return the forces of the points of a branch, of those above a force."""
    every = np.asarray(branch.points[FORCE], dtype=float)
    return every[every > above]


def gaining(branch: Any) -> float:
    """Return the least force at which the states of a branch gain stability.

    Raises
    ------
    ValueError
        They never do.
    """
    gained = branch.bifurcations.value[branch.bifurcations.stability == "gained"]
    if not len(gained):
        raise ValueError("no state of the branch gains stability")
    return float(gained.min())


def spinning_energy(branch: Any, *, above: float = 0.0) -> Points:
    """Return the bending energies of the points of a branch of spinning states."""
    every = np.asarray(branch.points.bending_energy, dtype=float)
    return every[np.asarray(branch.points[FORCE], dtype=float) > above]


def roundoff(value: float) -> float:
    """Return the round-off of a value that took a few operations."""
    return float(4.0 * np.finfo(float).eps * abs(value))


def slowness(spinning: Any, flapping: Any) -> Points:
    """Return 1 - flapping/spinning of the frequencies, at the points of the branch of flapping."""
    fast = on(forces(flapping), spinning.points[FORCE], spinning.points.frequency)
    return 1.0 - np.asarray(flapping.points.frequency, dtype=float) / fast


def regimes(steps: Any) -> str:
    """Return the verdicts of a series of steps in their order, without what is undecided."""
    order = [verdict for verdict in steps.regimes.verdict if verdict != "undecided"]
    return ", ".join(dict.fromkeys(order))


def largest_spread(steps: Any, verdict: str) -> float:
    """Return the largest relative range of the bending energy among steps of one verdict."""
    wanted = steps.steps.verdict == verdict
    low, high = steps.steps["bending_energy/min"], steps.steps["bending_energy/max"]
    mean = steps.steps["bending_energy/mean"]
    return float(((high - low) / mean)[wanted].max())


def _parabola(places: Points, values: Points) -> Points:
    """Return the coefficients of the parabola through three points, the constant first."""
    matrix = np.vander(places, 3, increasing=True)
    return np.asarray(np.linalg.solve(matrix, values))


def _range(
    places: Points, margin: Points, around: float, zero: Callable[[Points, Points, int], float]
) -> list[float]:
    inside = int(np.abs(places - around).argmin())
    if not margin[inside] > 0.0:
        raise ValueError(f"it does not hold at {around:g}")
    failing = np.flatnonzero(~(margin > 0.0))
    before, after = failing[failing < inside], failing[failing > inside]
    low = zero(places, margin, int(before[-1])) if len(before) else float(places[0])
    high = zero(places, margin, int(after[0]) - 1) if len(after) else float(places[-1])
    return [low, high]


def _zero(places: Points, values: Points, left: int) -> float:
    """Return where a smooth curve passes through zero right of a point."""
    if not np.isfinite(values).all():
        return _straight_zero(places, values, left)
    roots = CubicSpline(places, values).roots(extrapolate=False)
    here = roots[(roots >= places[left]) & (roots <= places[left + 1])]
    return float(here[0])


def _straight_zero(places: Points, values: Points, left: int) -> float:
    a, b = values[left], values[left + 1]
    return float(places[left] - a * (places[left + 1] - places[left]) / (b - a))


def _sorted(of: ArrayLike, values: ArrayLike) -> tuple[Points, Points]:
    places, known = np.asarray(of, dtype=float), np.asarray(values, dtype=float)
    if len(places) < 3:
        raise ValueError(f"a curve of {len(places)} points is too short")
    order = np.argsort(places, kind="stable")
    return places[order], known[order]
