"""A branch as a line: its states with its bifurcations in between, and its stable parts."""

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from undula.analysis.states.branch import Bifurcation, Branch
from undula.analysis.states.state import State
from undula.arrays import Array
from undula.errors import InputError


@dataclass(frozen=True)
class BranchLine:
    """Points of a branch in the order of following, bifurcations among them.

    Attributes
    ----------
    values, frequencies : ndarray of shape (k,)
        The parameter, and the frequency [cycles per T].
    low, high, mean : ndarray of shape (k,)
        Bending energy over a cycle.
    stable : ndarray of bool, shape (k - 1,)
        True where the branch is stable between one point and the next.
    marks : ndarray of int, shape (b,)
        Indices of the points that are bifurcations, in their order.
    """

    values: Array
    frequencies: Array
    low: Array
    high: Array
    mean: Array
    stable: NDArray[np.bool_]
    marks: NDArray[np.intp]

    @property
    def parts(self) -> list[tuple[slice, bool]]:
        """Points of each stable or unstable part, ends included, and True for a stable part.

        A single point has no parts.
        """
        changes = np.flatnonzero(self.stable[1:] != self.stable[:-1]) + 1
        return [
            (slice(first, last + 1), bool(self.stable[first]))
            for first, last in pairwise([0, *changes.tolist(), self.stable.size])
            if first < last
        ]

    @property
    def stable_intervals(self) -> list[tuple[float, float]]:
        """Least and greatest value of the parameter of each stable part."""
        return [
            (float(self.values[part].min()), float(self.values[part].max()))
            for part, stable in self.parts
            if stable
        ]

    def interpolated(self, quantity: Array, values: Array) -> Array:
        """Return a quantity at values of the parameter.

        Parameters
        ----------
        quantity : ndarray of shape (k,)
            At the points, as `frequencies`.
        values : ndarray of shape (m,)
            Within those of the branch.

        Returns
        -------
        ndarray of shape (m,)

        Raises
        ------
        InputError
            The branch folds back, so that a value of the parameter does not give the state.
        """
        steps = np.diff(self.values)
        if not (np.all(steps >= 0.0) or np.all(steps <= 0.0)):
            raise InputError(
                "the branch folds back, so that it has several states at one force; follow it over"
                " forces without a fold"
            )
        order = slice(None, None, 1 if steps.sum() > 0.0 else -1)
        return np.asarray(np.interp(values, self.values[order], quantity[order]))


def branch_line(branch: Branch[Any]) -> BranchLine:
    """Return the states of a branch with its bifurcations inserted between them.

    Between two states without a bifurcation the branch is stable only if both states are.

    Parameters
    ----------
    branch : Branch
        With at least one state.

    Returns
    -------
    BranchLine
    """
    places = _intervals(branch)
    inside: list[list[Bifurcation[Any]]] = [[] for _ in branch.states]
    for bifurcation, place in zip(branch.bifurcations, places, strict=True):
        inside[place].append(bifurcation)
    points, stable = [], []
    for place, (value, state) in enumerate(zip(branch.values, branch.states, strict=True)):
        points.append(line_point(value, state))
        for bifurcation in inside[place]:
            points.append(line_point(bifurcation.value, bifurcation.state))
            stable.append(bifurcation.unstable_before == 0)
        if inside[place]:
            stable.append(inside[place][-1].unstable_after == 0)
        elif place + 1 < len(branch.states):
            stable.append(state.stable and branch.states[place + 1].stable)
    marks = np.array([place + 1 + before for before, place in enumerate(places)], dtype=np.intp)
    values, frequencies, low, high, mean = np.array(points).T
    parts = np.array(stable, dtype=np.bool_)
    return BranchLine(values, frequencies, low, high, mean, parts, marks)


def line_point(value: float, state: State) -> tuple[float, float, float, float, float]:
    """Return value, frequency, and least, greatest and mean bending energy of a state."""
    energy = state.bending_energy
    return float(value), state.frequency, energy.min, energy.max, energy.mean


def _intervals(branch: Branch[Any]) -> list[int]:
    """Return for each bifurcation the index of the state after which it lies.

    On a branch that folds back the parameter alone does not determine the interval, and a fold lies
    outside the values of its neighbours. Among the intervals in which as many disturbances change,
    the one that a detour over the bifurcation lengthens least is taken.
    """
    points = _coordinates([*zip(branch.values, branch.states, strict=True)])
    bifurcations = _coordinates([(point.value, point.state) for point in branch.bifurcations])
    scale = np.ptp(points, axis=0)
    scale[scale == 0.0] = 1.0
    counts = np.array([np.count_nonzero(s.exponents.real > 0.0) for s in branch.states])
    places: list[int] = []
    for bifurcation, coordinates in zip(branch.bifurcations, bifurcations, strict=True):
        distance = np.linalg.norm((points - coordinates) / scale, axis=1)
        detour = (
            distance[:-1] + distance[1:] - np.linalg.norm(np.diff(points, axis=0) / scale, axis=1)
        )
        ahead = np.arange(detour.size) >= (places[-1] if places else 0)
        fitting = ahead & _passed(counts, bifurcation)
        allowed = fitting if np.any(fitting) else ahead
        places.append(int(np.argmin(np.where(allowed, detour, np.inf))))
    return places


def _coordinates(states: list[tuple[float, Any]]) -> Array:
    return np.array([(value, s.frequency, s.bending_energy.mean) for value, s in states]).reshape(
        -1, 3
    )


def _passed(counts: NDArray[np.intp], bifurcation: Bifurcation[Any]) -> NDArray[np.bool_]:
    """Return for each interval whether the count of growing disturbances passes a bifurcation's."""
    before, after = bifurcation.unstable_before, bifurcation.unstable_after
    rises = (counts[:-1] <= before) & (after <= counts[1:])
    falls = (counts[:-1] >= before) & (after >= counts[1:])
    if before == after:
        return rises | falls
    return rises if before < after else falls
