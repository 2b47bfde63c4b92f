"""PyElastica: its longest stable step, what a step takes, and by how much its frequency is off.

The time of a window is extrapolated from the first two. The frequency is seen in short runs with a
heavier rod, where steps are longer, and its errors by the number of elements and by inertia are
taken to be proportional to 1/n and to the mass.
"""

from dataclasses import dataclass

import numpy as np

from contenders import elastica_rod
from contenders.orbits import FORCES, orbit

#: Mass per length [zeta_perp T] of what is timed.
MASS = 1e-6
#: Masses and numbers of elements of the runs that show frequencies.
_SHOWN = ((1e-5, 20), (1e-5, 40), (1e-4, 20))
#: Part of the longest stable step, periods to settle in and to count.
_SAFE, _SETTLING, _COUNTED, _LOOKS = 0.8, 3, 2, 40


@dataclass(frozen=True)
class Pushed:
    """What was measured, and what follows for a window."""

    motion: str
    segments: int
    step: float  # longest stable [T]
    seconds: float  # a step
    window: float  # [s], extrapolated


@dataclass(frozen=True)
class Accuracy:
    """Its frequency [1/T] = limit (1 + coarseness / n + inertia m)."""

    motion: str
    limit: float
    coarseness: float
    inertia: float


def pushed(motion: str, segments: int, periods: float) -> Pushed:
    """Measure step and cost on a motion; extrapolate to some periods of it."""
    exact = orbit("undula", segments, motion)
    step = elastica_rod.longest_stable_step(exact.start, FORCES[motion], MASS)
    took = min(
        elastica_rod.seconds_a_step(exact.start, FORCES[motion], MASS, step) for _ in range(5)
    )
    window = periods / exact.frequency / step * took
    return Pushed(motion, segments, step, took, window)


def accuracy(motion: str) -> Accuracy:
    """Run heavier rods and take their errors apart."""
    (m, coarse), (_, fine), (heavy, _) = _SHOWN
    a, b, c = (_frequency(motion, segments, mass) for mass, segments in _SHOWN)
    # f = limit + p / n + q m
    p = (a - b) / (1.0 / coarse - 1.0 / fine)
    q = (c - a) / (heavy - m)
    limit = a - p / coarse - q * m
    return Accuracy(motion, limit, p / limit, q / limit)


def _frequency(motion: str, segments: int, mass: float) -> float:
    """Return the rate at which the tip passes x = 0 in one direction."""
    exact, force = orbit("undula", segments, motion), FORCES[motion]
    step = _SAFE * elastica_rod.longest_stable_step(exact.start, force, mass)
    rod = elastica_rod.build(exact.start, force, mass, step)
    stride = round(1.0 / (exact.frequency * step * _LOOKS))
    rod.advance(stride * _LOOKS * _SETTLING)
    seen = []
    for _ in range((_COUNTED + 1) * _LOOKS):
        if not rod.advance(stride):
            raise RuntimeError(f"the rod of {segments} elements and mass {mass:g} explodes")
        seen.append((rod.time, rod.rod.position_collection[0, -1]))
    time, x = np.array(seen).T
    up = np.flatnonzero((x[:-1] < 0.0) & (x[1:] >= 0.0))
    passed = time[up] - x[up] * (time[up + 1] - time[up]) / (x[up + 1] - x[up])
    return float((passed.size - 1) / (passed[-1] - passed[0]))
