"""A branch as a smooth line: a cubic spline through its states."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline

from undula.analysis.states.branch import Bifurcation, Branch
from undula.arrays import Array
from undula.views.branches.branch_lines import BranchLine, line_point

# Points of the line from one state to the next: enough for a curve at the width of a page.
_POINTS_PER_INTERVAL = 16
# Number of trial points in the search for a bifurcation on the spline, and number of refinements
# around the point whose value is nearest. A search for a crossing would miss a fold, where the
# spline only touches the value.
_TRIAL_POINTS, _ROUNDS = 101, 4


def smooth_line(branch: Branch[Any]) -> BranchLine:
    """Return a branch as a cubic spline through its states, cut where its stability changes.

    Between two states of which one is stable, the stable part ends at the bifurcation there, or
    half-way if the branch has none.

    Parameters
    ----------
    branch : Branch
        With at least two states.

    Returns
    -------
    BranchLine
        Its marks are the points at which stability changes.
    """
    points = np.array([*map(line_point, branch.values, branch.states)])
    distance = _distances(points)
    curve = CubicSpline(distance, points)
    stable = np.array([state.stable for state in branch.states])
    cuts = [
        _cut(curve, distance[k : k + 2], branch.bifurcations, loses=bool(stable[k]))
        for k in np.flatnonzero(stable[1:] != stable[:-1])
    ]
    count = distance.size
    finer = np.arange((count - 1) * _POINTS_PER_INTERVAL + 1) / _POINTS_PER_INTERVAL
    places = np.unique(np.concatenate([np.interp(finer, np.arange(count), distance), cuts]))
    # Each cut reverses the stability of the parts behind it.
    crossed = np.searchsorted(cuts, 0.5 * (places[1:] + places[:-1]))
    values, frequencies, low, high, mean = curve(places).T
    parts = (crossed % 2 == 1) != stable[0]
    marks = np.searchsorted(places, cuts)
    return BranchLine(values, frequencies, low, high, mean, parts, marks)


def _distances(points: Array) -> Array:
    """Return the distance of each state along the branch; quantities are over their ranges."""
    ranges = np.ptp(points, axis=0)
    ranges[ranges == 0.0] = 1.0
    return np.concatenate(
        [[0.0], np.cumsum(np.linalg.norm(np.diff(points / ranges, axis=0), axis=1))]
    )


def _cut(
    curve: CubicSpline, ends: Array, bifurcations: Sequence[Bifurcation[Any]], *, loses: bool
) -> float:
    """Return the distance along the branch at which stability changes between two states."""
    values = [point.value for point in bifurcations if (point.loses if loses else point.gains)]
    if not values:
        return float(ends.mean())
    middle = curve(ends.mean())[0]
    value = min(values, key=lambda value: abs(value - middle))
    low, high = ends
    for _ in range(_ROUNDS):
        places = np.linspace(low, high, _TRIAL_POINTS)
        nearest = int(np.argmin(np.abs(curve(places)[:, 0] - value)))
        low, high = places[max(nearest - 1, 0)], places[min(nearest + 1, _TRIAL_POINTS - 1)]
    return float(places[nearest])
