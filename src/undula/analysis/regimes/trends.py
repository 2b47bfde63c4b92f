"""Slow changes of a motion, from a comparison of the two halves of a window.

A small part that grows may be the onset of another motion; a modulation that shrinks may be the end
of one. The halves of a window show such a change long before the window as a whole does.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from undula.analysis.observables.alignment import aligned_distance, largest_distance
from undula.analysis.observables.planarity import planarity
from undula.analysis.observables.shapes import displacement
from undula.analysis.observables.spectrum import hann
from undula.arrays import Array, Shapes

# Number of parts of a window that are compared, and least relative fall from the first to the last:
# incomplete beats alone change the share of a settled motion by a hundredth.
_PART_COUNT, _MIN_FALL = 4, 0.05


@dataclass(frozen=True)
class Halves:
    """A measure of the two halves of a window.

    Attributes
    ----------
    first, last : float
        In the unit of the measure.
    """

    first: float
    last: float

    def grows(self, factor: float, floor: float) -> bool:
        """Return True if the measure grows by more than a factor to more than a floor.

        Parameters
        ----------
        factor : float
            Least quotient of last and first, at least 1.
        floor : float
            Least value in the last half, in the unit of the measure.
        """
        return self.last > floor and self.last > factor * self.first

    @property
    def difference(self) -> float:
        """Difference between the halves, relative to their mean."""
        mean = 0.5 * (abs(self.first) + abs(self.last))
        return abs(self.last - self.first) / mean if mean > 0.0 else 0.0


def shape_change(nodes: Shapes) -> Halves:
    """Return the change of shape in each half, up to rotations, relative to the displacement.

    Parameters
    ----------
    nodes
        Node positions [L], shape ``(m, N + 1, 3)``, m at least 2.
    """
    return _halves(nodes, _change)


def out_of_plane(nodes: Shapes) -> Halves:
    """Return the out-of-plane share of each half, with respect to its own principal plane.

    Parameters
    ----------
    nodes
        Node positions [L], shape ``(m, N + 1, 3)``, m at least 2.
    """
    return _halves(nodes, planarity)


def flattens(nodes: Shapes) -> bool:
    """Return True if the out-of-plane share of a motion falls from quarter to quarter.

    Each quarter has its own principal plane. A monotone fall over the quarters shows a change that
    is too slow for the comparison of the halves.

    Parameters
    ----------
    nodes
        Node positions [L], shape ``(m, N + 1, 3)``, m at least 4.
    """
    shares = [planarity(part) for part in np.array_split(nodes, _PART_COUNT)]
    falls = all(later < earlier for earlier, later in pairwise(shares))
    return falls and shares[-1] < (1.0 - _MIN_FALL) * shares[0]


def displacement_variance(nodes: Shapes) -> Halves:
    """Return the variance of the displacement in each half [L^2], under a Hann weight.

    The weight removes the effect of a cut period.

    Parameters
    ----------
    nodes
        Node positions [L], shape ``(m, N + 1, 3)``, m at least 2.
    """
    return _halves(displacement(nodes), _variance)


def _halves(samples: Array, measure: Callable[[Array], float]) -> Halves:
    half = len(samples) // 2
    return Halves(measure(samples[:half]), measure(samples[-half:]))


def _change(nodes: Shapes) -> float:
    middle = nodes[len(nodes) // 2]
    size = float(displacement(middle)) or 1.0
    return largest_distance(nodes, middle, aligned_distance) / size


def _variance(values: Array) -> float:
    weights = hann(len(values))
    return float(weights @ (values - weights @ values) ** 2)
