"""Branches as answers of `undula follow` tell them: as lines with stable and unstable parts."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from undula.arrays import Array
from undula.errors import InputError
from undula.views.common import style

FORCE = "load.force"
# Points of the line from one state to the next: enough for a curve at the width of a page.
_FINER = 16
# A bifurcation is looked for among so many places, then among as many around the nearest one: a
# fold is the force nearest to its own, which no search for a crossing would find.
_PLACES, _ROUNDS = 101, 4


@dataclass(frozen=True)
class Turn:
    """A bifurcation: its force, its kind, and whether stability is "lost" or "gained" there."""

    force: float
    kind: str
    stability: str


@dataclass(frozen=True)
class AnsweredBranch:
    """States along the force, between them a cubic spline.

    Attributes
    ----------
    forces, frequencies : ndarray of shape (k,)
        In the order of following; frequencies in cycles per T.
    low, high, mean : ndarray of shape (k,)
        Bending energy over a cycle.
    stable : ndarray of bool, shape (k - 1,)
        Whether the branch is stable between one point and the next.
    turns : tuple of Turn
        Its bifurcations.
    onset : float or None
        Force at which it leaves the straight state, where it was followed from there.
    units : mapping of str to str
        Names of the units.
    """

    forces: Array
    frequencies: Array
    low: Array
    high: Array
    mean: Array
    stable: NDArray[np.bool_]
    turns: tuple[Turn, ...]
    onset: float | None
    units: style.UnitNames

    def at(self, forces: Array, name: str) -> Array:
        """Return a quantity by its name, as "frequencies", at forces within the branch.

        Raises
        ------
        InputError
            The branch folds back, so that a force does not tell the state.
        """
        steps, values = np.diff(self.forces), getattr(self, name)
        if not (np.all(steps >= 0.0) or np.all(steps <= 0.0)):
            raise InputError(
                "the branch folds back, so that it has several states at one force; follow it over"
                " forces without a fold"
            )
        way = 1 if steps.sum() > 0.0 else -1
        return np.asarray(np.interp(forces, self.forces[::way], values[::way]))

    @property
    def stable_stretches(self) -> list[tuple[float, float]]:
        """Least and greatest force of each stable part."""
        return [
            (float(part.min()), float(part.max()))
            for start, end, stable in parts(self.stable)
            if stable
            for part in [self.forces[start : end + 1]]
        ]


def read_branch(answer: Mapping[str, Any]) -> AnsweredBranch:
    """Take a branch of spinning or flapping states from an answer.

    Parameters
    ----------
    answer : mapping
        Of `undula follow --json` along the force. Between two states of which one is stable, the
        part that is ends at the bifurcation, or half-way if none is told.

    Raises
    ------
    InputError
        The answer has fewer than two states, or they are along something else.
    """
    points: Sequence[Mapping[str, Any]] = answer.get("points") or ()
    if len(points) < 2:
        why = answer.get("reason", f"it has {len(points)} state(s)")
        raise InputError(f"the answer holds no branch ({why}); follow states along {FORCE}")
    if answer.get("parameter") != FORCE or "bending_energy" not in points[0]:
        raise InputError(
            f"the answer is not of spinning or flapping states along {FORCE}, but along"
            f" {answer.get('parameter')}; give another"
        )
    known = np.array([_numbers(point) for point in points])
    turns = tuple(
        Turn(float(one["value"]), one["kind"], one.get("stability", ""))
        for one in answer.get("bifurcations", ())
    )
    way = _way(known)
    curve = CubicSpline(way, known)
    states = np.array([bool(point["stable"]) for point in points])
    cuts = [
        _cut(curve, way[k : k + 2], turns, loses=bool(states[k]))
        for k in np.flatnonzero(states[1:] != states[:-1])
    ]
    finer = np.interp(np.arange((way.size - 1) * _FINER + 1) / _FINER, np.arange(way.size), way)
    finer = np.unique(np.concatenate([finer, cuts]))
    crossed = np.searchsorted(cuts, 0.5 * (finer[1:] + finer[:-1]))
    onset = _onset(known) if answer.get("birth") else None
    stable = (crossed % 2 == 1) != states[0]
    forces, frequencies, low, high, mean = curve(finer).T
    energies = low, high, mean
    return AnsweredBranch(forces, frequencies, *energies, stable, turns, onset, answer["units"])


def parts(stable: NDArray[np.bool_]) -> list[tuple[int, int, bool]]:
    """Return first and last point of each part of one stability, and whether it is stable."""
    changes = np.flatnonzero(stable[1:] != stable[:-1]) + 1
    return [(a, b, bool(stable[a])) for a, b in pairwise([0, *changes.tolist(), stable.size])]


def same_units(*answers: style.UnitNames) -> style.UnitNames:
    """Return the units of answers.

    Raises
    ------
    InputError
        They are not all the same.
    """
    for other in answers[1:]:
        if other != answers[0]:
            raise InputError(
                f"the answers are in {answers[0]['force']} and in {other['force']}; give answers of"
                " one model"
            )
    return answers[0]


def _numbers(point: Mapping[str, Any]) -> tuple[float, ...]:
    energy = point["bending_energy"]
    if not isinstance(energy, Mapping):
        energy = dict.fromkeys(("min", "max", "mean"), energy)
    return point[FORCE], point["frequency"], energy["min"], energy["max"], energy["mean"]


def _way(known: Array) -> Array:
    """Return how far each state is along the branch, every quantity by its own range."""
    ranges = np.ptp(known, axis=0)
    ranges[ranges == 0.0] = 1.0
    return np.concatenate(
        [[0.0], np.cumsum(np.linalg.norm(np.diff(known / ranges, axis=0), axis=1))]
    )


def _cut(curve: Any, ends: Array, turns: Sequence[Turn], *, loses: bool) -> float:
    """Return the place between two states at which stability is lost or gained."""
    wanted = [turn.force for turn in turns if turn.stability == ("lost" if loses else "gained")]
    if not wanted:
        return float(ends.mean())
    middle = curve(ends.mean())[0]
    force = min(wanted, key=lambda one: abs(one - middle))
    low, high = ends
    for _ in range(_ROUNDS):
        places = np.linspace(low, high, _PLACES)
        nearest = int(np.argmin(np.abs(curve(places)[:, 0] - force)))
        low, high = places[max(nearest - 1, 0)], places[min(nearest + 1, _PLACES - 1)]
    return float(places[nearest])


def _onset(known: Array) -> float:
    # Near its birth the energy of a state grows as the force does, with a small quadratic part.
    force, energy = known[:3, 0], known[:3, 4]
    return float(np.polynomial.Polynomial.fit(energy, force, force.size - 1)(0.0))
