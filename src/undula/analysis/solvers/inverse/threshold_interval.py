"""A curve of thresholds along a parameter, and intervals of it."""

from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np
from scipy.optimize import brentq

from undula.analysis.linear.results import Method
from undula.analysis.parameters import changed
from undula.analysis.solvers.inverse.targets import Target
from undula.analysis.solvers.threshold_record import Threshold
from undula.analysis.solvers.thresholds import threshold_on_links
from undula.analysis.states.follow_branch import Progress
from undula.models.model import Model

# Change of the parameter over which the slope is a difference, relative to an interval.
_DIFFERENCE = 1e-2


@dataclass(frozen=True, eq=False)
class ThresholdSample:
    """A threshold at a value of the parameter.

    Attributes
    ----------
    p : float
        Value of the parameter.
    threshold : Threshold
        The threshold, which has a value.
    quantity, miss : float
        Its quantity, and the difference of that from the target.
    """

    p: float
    threshold: Threshold
    quantity: float
    miss: float


@dataclass(frozen=True)
class ThresholdCurve:
    """Thresholds of a model along a parameter.

    Attributes
    ----------
    model : Model
        With the same unknowns over the whole range.
    target : Target
        The target.
    parameter : str
        Name of the parameter.
    method : {"spectral", "modes", "discrete"} or None
        Discretisation for onsets, the same at all values.
    progress : callable or None
        Called with each value of the parameter.
    """

    model: Model
    target: Target
    parameter: str
    method: Method | None
    progress: Progress | None = field(default=None)

    def threshold_at(self, p: float, near: Threshold | None) -> Threshold:
        """Return the threshold at a value of the parameter, searched next to a known one."""
        if self.progress:
            self.progress(p)
        model = changed(self.model, self.parameter, p)
        return threshold_on_links(model, self.target.kind, near=near, method=self.method)

    def sample(self, p: float, near: Threshold | None) -> ThresholdSample | None:
        """Return the threshold at a value as a sample; None if it does not exist."""
        found = self.threshold_at(p, near)
        return None if found.value is None else self.sample_of(p, found)

    def sample_of(self, p: float, found: Threshold) -> ThresholdSample:
        """Return a threshold that has a value as a sample."""
        quantity = float(self.target.of(found))
        return ThresholdSample(p, found, quantity, quantity - self.target.value)


@dataclass(frozen=True, eq=False)
class ThresholdInterval:
    """An interval of a curve of thresholds between neighbouring values of the parameter.

    Attributes
    ----------
    curve : ThresholdCurve
    before, after : ThresholdSample
        Ends of the interval.
    tolerance : float
        Error to which the parameter is located.
    """

    curve: ThresholdCurve
    before: ThresholdSample
    after: ThresholdSample
    tolerance: float

    @property
    def length(self) -> float:
        """Difference of the parameter at the ends."""
        return self.after.p - self.before.p

    def at(self, position: float) -> ThresholdSample | None:
        """Return the threshold at a position between 0 and the length; None without one."""
        near = self.before if position < 0.5 * self.length else self.after
        return self.curve.sample(self.before.p + position, near.threshold)

    def zero(self) -> ThresholdSample | None:
        """Return the threshold at which the quantity passes the target; None if it is lost."""
        samples = {sample.p: sample for sample in (self.before, self.after)}

        def miss(p: float) -> float:
            if p not in samples:
                nearest = samples[min(samples, key=lambda other: abs(other - p))]
                sample = self.curve.sample(p, nearest.threshold)
                if sample is None:
                    raise ArithmeticError
                samples[p] = sample
            return samples[p].miss

        try:
            root = brentq(miss, self.before.p, self.after.p, xtol=self.tolerance)
            miss(root)  # stores the sample
        except ArithmeticError:
            return None
        return samples[root]

    def split(self, point: ThresholdSample) -> tuple[Self, Self]:
        """Return the parts before and after a point of the interval."""
        return replace(self, after=point), replace(self, before=point)

    def slope_at(self, point: ThresholdSample) -> float:
        """Return the derivative of the quantity by the parameter; NaN if it is not found."""
        step = _DIFFERENCE * self.length
        neighbour = point.p + (step if point.p + step <= self.after.p else -step)
        other = self.curve.sample(neighbour, point.threshold)
        return np.nan if other is None else (other.quantity - point.quantity) / (other.p - point.p)
