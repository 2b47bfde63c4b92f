"""Whether a motion that looks settled still changes: its two halves compared.

What is small and grows may be the beginning of another motion; a modulation that shrinks may be the
end of one. Either is told from the halves of a window long before the whole of it changes.
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

# Parts of a window that are compared one by one, and the least fall from the first to the last that
# counts: beats cut at any place change the share of a motion that has settled by a hundredth.
_PARTS, _SLOWEST = 4, 0.05


@dataclass(frozen=True)
class Halves:
    """A measure of each half of a window."""

    first: float
    last: float

    def grows(self, factor: float, floor: float) -> bool:
        """Whether it grows by more than a factor to more than a floor."""
        return self.last > floor and self.last > factor * self.first

    @property
    def difference(self) -> float:
        """Difference between the halves, relative to their mean."""
        mean = 0.5 * (abs(self.first) + abs(self.last))
        return abs(self.last - self.first) / mean if mean > 0.0 else 0.0


def shape_change(nodes: Shapes) -> Halves:
    """How much the shape of nodes (m, N + 1, 3) changes, up to turns, relative to its size."""
    return _halves(nodes, _change)


def out_of_plane(nodes: Shapes) -> Halves:
    """How far the motion of nodes (m, N + 1, 3) is from a plane, one of its own in each half."""
    return _halves(nodes, planarity)


def flattens(nodes: Shapes) -> bool:
    """Tell whether the motion of nodes (m, N + 1, 3) comes nearer to a plane all the time.

    From quarter to quarter, each with a plane of its own: a fall that is too slow to be seen from
    one half to the other is seen by its going one way.
    """
    shares = [planarity(part) for part in np.array_split(nodes, _PARTS)]
    falls = all(later < earlier for earlier, later in pairwise(shares))
    return falls and shares[-1] < (1.0 - _SLOWEST) * shares[0]


def swing(nodes: Shapes) -> Halves:
    """How far the displacement of nodes (m, N + 1, 3) swings about its mean, squared [L^2].

    Under a Hann weight, which makes a cut through a period harmless.
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
