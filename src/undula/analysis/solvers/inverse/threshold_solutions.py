"""Solutions on a curve of thresholds along a parameter.

The threshold is solved for at equally spaced values of the parameter, each next to the last, and
then between them by a root finder.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from undula.analysis.linear.stability import method_for_all
from undula.analysis.parameters import FORCE, changed
from undula.analysis.solvers.inverse.crossings import crossings
from undula.analysis.solvers.inverse.searched import Searched
from undula.analysis.solvers.inverse.solutions import Solution
from undula.analysis.solvers.inverse.targets import Target
from undula.analysis.solvers.inverse.threshold_interval import (
    ThresholdCurve,
    ThresholdInterval,
    ThresholdSample,
)
from undula.analysis.solvers.threshold_record import Threshold
from undula.analysis.solvers.threshold_search import WANTED
from undula.analysis.solvers.thresholds import single_threshold, threshold_on_links
from undula.analysis.states.along_parameter import model_along
from undula.analysis.states.extrapolation import error_of_links
from undula.analysis.states.follow_branch import Progress
from undula.errors import InputError
from undula.models.model import Model

# Number of values of the parameter at which the threshold is solved for first.
_SAMPLES = 9
# Tolerance of the parameter relative to the range: thresholds are located to about as much.
_TOLERANCE = 1e-11
# Difference from the target that counts as none, relative to the target.
_ROUND_OFF = 1e-9


@dataclass(frozen=True)
class SearchedCurve:
    """Thresholds over a range of the parameter.

    Attributes
    ----------
    curve : ThresholdCurve
        The curve.
    samples : tuple of (float, Threshold)
        Values of the parameter, each with the threshold or the reason for its absence.
    """

    curve: ThresholdCurve
    samples: tuple[tuple[float, Threshold], ...]

    @property
    def runs(self) -> list[list[ThresholdSample]]:
        """Neighbouring samples with a threshold."""
        runs: list[list[ThresholdSample]] = [[]]
        for p, found in self.samples:
            if found.value is None:
                runs.append([])
            else:
                runs[-1].append(self.curve.sample_of(p, found))
        return [run for run in runs if run]

    @property
    def searched(self) -> Searched:
        """Values of the parameter and of the quantity."""
        points = [point for run in self.runs for point in run]
        absent = [(p, found) for p, found in self.samples if found.value is None]
        return Searched(
            tuple(point.p for point in points),
            tuple(point.quantity for point in points),
            f"at {self.curve.parameter} {absent[0][0]:.6g} {absent[0][1].reason}"
            if absent
            else None,
        )

    def solutions(
        self, between: tuple[float, float], stop: Callable[[], bool]
    ) -> tuple[Solution, ...]:
        """Return the solutions on the curve; fewer if `stop` returns True."""
        solutions: list[Solution] = []
        for interval, sample in self._crossings(_TOLERANCE * (between[1] - between[0])):
            solutions.append(_solution(interval, sample))
            if stop():
                break
        return tuple(solutions)

    def _crossings(self, tolerance: float) -> Iterator[tuple[ThresholdInterval, ThresholdSample]]:
        for run in self.runs:
            intervals = [ThresholdInterval(self.curve, *pair, tolerance) for pair in pairwise(run)]
            if intervals:
                size = abs(self.curve.target.value) or max(abs(point.quantity) for point in run)
                yield from crossings(intervals, _ROUND_OFF * size)


def search_thresholds(
    model: Model,
    target: Target,
    parameter: str,
    between: tuple[float, float],
    progress: Progress | None,
    stop: Callable[[], bool],
) -> SearchedCurve:
    """Return the thresholds at equally spaced values of a parameter.

    Parameters
    ----------
    model : Model
        The model; its own value of the parameter does not matter.
    target : Target
        Name of the threshold, and the target of its quantity.
    parameter : str
        Name of the parameter.
    between : (float, float)
        Range of the parameter.
    progress : callable or None
        Called with each value of the parameter.
    stop : callable
        Called after each value; the search ends where it returns True.

    Raises
    ------
    InputError
        The model cannot have such a threshold over the whole range.
    """
    values = np.linspace(*between, _SAMPLES).tolist()
    shared = model_along(model, WANTED[target.kind].kind, parameter, values)
    method = method_for_all([changed(shared, parameter, value) for value in values])
    curve = ThresholdCurve(shared, target, parameter, method, progress)
    samples: list[tuple[float, Threshold]] = []
    near: Threshold | None = None
    for value in values:
        found = curve.threshold_at(value, near)
        near = near if found.value is None else found
        samples.append((value, found))
        if stop():
            break
    return SearchedCurve(curve, tuple(samples))


def require_other_than_force(kind: str, parameter: str) -> None:
    """Refuse the force as the parameter of a threshold, which is a value of it."""
    if parameter == FORCE:
        raise InputError(
            f"{kind} is a value of {FORCE}; take another parameter, such as model.drag_ratio"
        )


def _solution(interval: ThresholdInterval, sample: ThresholdSample) -> Solution:
    """Return the record of a value at which the threshold's quantity has its target."""
    curve, target = interval.curve, interval.curve.target
    slope = interval.slope_at(sample)
    model = changed(curve.model, curve.parameter, sample.p)
    found = single_threshold(model, target.kind, near=sample.threshold, method=curve.method)
    # The frequency is about as accurate as the force, relative to its value.
    share = abs(sample.quantity / (sample.threshold.value or 1.0))
    of_quantity = abs(sample.miss) + share * (sample.threshold.solver_error or 0.0)
    solver_error = interval.tolerance + of_quantity / abs(slope)
    by_links = _quantity_error_of_links(model, sample, curve)
    error = None if by_links is None else by_links / abs(slope) + solver_error
    return Solution(
        parameter=curve.parameter,
        value=sample.p,
        error=error,
        solver_error=solver_error,
        quantity=target.quantity,
        target=target.value,
        slope=slope,
        links=found.links[0] if found.links else None,
        state=None if found.at is None else found.at.state,
        threshold=found,
    )


def _quantity_error_of_links(
    model: Model, sample: ThresholdSample, curve: ThresholdCurve
) -> float | None:
    """Return the error of the quantity against the body that the links stand for."""
    if not sample.threshold.links:
        return 0.0

    def again(other: Model) -> float | None:
        found = threshold_on_links(
            other, curve.target.kind, near=sample.threshold, method=curve.method
        )
        return None if found.value is None else float(curve.target.of(found))

    return error_of_links(model, sample.quantity, again)
