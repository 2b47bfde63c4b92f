"""A branch as a line: its states with its bifurcations in between, and where it is stable."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from undula.analysis.states.branch import Bifurcation, Branch
from undula.analysis.states.state import State
from undula.arrays import Array


@dataclass(frozen=True)
class BranchLine:
    """Points in the order of following, bifurcations among them.

    Attributes
    ----------
    values, frequencies : ndarray of shape (k,)
        The parameter, and the frequency [cycles per T].
    low, high, mean : ndarray of shape (k,)
        Bending energy over a cycle.
    stable : ndarray of bool, shape (k - 1,)
        Whether the branch is stable between one point and the next.
    marks : ndarray of int, shape (b,)
        Which points are its bifurcations, in their order.
    """

    values: Array
    frequencies: Array
    low: Array
    high: Array
    mean: Array
    stable: NDArray[np.bool_]
    marks: NDArray[np.intp]


def branch_line(branch: Branch[Any]) -> BranchLine:
    """Insert the bifurcations of a branch between its states.

    Between two states without a bifurcation the branch passes for stable only if both are.

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
        points.append(_point(value, state))
        for bifurcation in inside[place]:
            points.append(_point(bifurcation.value, bifurcation.state))
            stable.append(bifurcation.unstable_before == 0)
        if inside[place]:
            stable.append(inside[place][-1].unstable_after == 0)
        elif place + 1 < len(branch.states):
            stable.append(state.stable and branch.states[place + 1].stable)
    marks = np.array([place + 1 + before for before, place in enumerate(places)], dtype=np.intp)
    values, frequencies, low, high, mean = np.array(points).T
    known = np.array(stable, dtype=np.bool_)
    return BranchLine(values, frequencies, low, high, mean, known, marks)


def _point(value: float, state: State) -> tuple[float, float, float, float, float]:
    energy = state.bending_energy
    return float(value), state.frequency, energy.min, energy.max, energy.mean


def _intervals(branch: Branch[Any]) -> list[int]:
    """Tell for each bifurcation after which state it lies.

    On a branch that folds back the parameter alone does not tell, and a fold lies outside the
    values of its neighbours: among the intervals in which as many disturbances turn, it is the one
    that a detour over the bifurcation lengthens least.
    """
    points = _coordinates([*zip(branch.values, branch.states, strict=True)])
    found = _coordinates([(one.value, one.state) for one in branch.bifurcations])
    scale = np.ptp(points, axis=0)
    scale[scale == 0.0] = 1.0
    counts = np.array([np.count_nonzero(s.exponents.real > 0.0) for s in branch.states])
    places: list[int] = []
    for bifurcation, at in zip(branch.bifurcations, found, strict=True):
        way = np.linalg.norm((points - at) / scale, axis=1)
        detour = way[:-1] + way[1:] - np.linalg.norm(np.diff(points, axis=0) / scale, axis=1)
        ahead = np.arange(detour.size) >= (places[-1] if places else 0)
        fitting = ahead & _turns(counts, bifurcation)
        allowed = fitting if np.any(fitting) else ahead
        places.append(int(np.argmin(np.where(allowed, detour, np.inf))))
    return places


def _coordinates(states: list[tuple[float, Any]]) -> Array:
    return np.array([(value, s.frequency, s.bending_energy.mean) for value, s in states]).reshape(
        -1, 3
    )


def _turns(counts: NDArray[np.intp], bifurcation: Bifurcation[Any]) -> NDArray[np.bool_]:
    """Tell in which intervals the number of growing disturbances passes that of a bifurcation."""
    before, after = bifurcation.unstable_before, bifurcation.unstable_after
    rises = (counts[:-1] <= before) & (after <= counts[1:])
    falls = (counts[:-1] >= before) & (after >= counts[1:])
    if before == after:
        return rises | falls
    return rises if before < after else falls
