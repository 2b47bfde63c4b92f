"""Searches for the orbits of known systems (`cycles`) from guesses that are somewhat off."""

from typing import Any

import numpy as np

from cycles import turned, turning
from undula.arrays import Array
from undula.numerics.orbits.periodic_orbit import Orbit, Search, find_orbit
from undula.numerics.orbits.radau import radau
from undula.numerics.orbits.shooting import Shooting
from undula.numerics.orbits.symmetry import OrbitSymmetry, Rotation

EXACT = OrbitSymmetry()
TURNING = OrbitSymmetry(rotation=Rotation(turned, turning))


def mirrored(y: Array) -> Array:
    return -y


def shooting(
    equations: Any, intervals: int, symmetry: OrbitSymmetry = EXACT, stages: int = 3
) -> Shooting:
    return Shooting(lambda _: equations, symmetry, intervals, radau(stages))


def near(y: Array, *times: float) -> Array:
    """Return a guess near positions and times."""
    u = np.append(y, times)
    return np.asarray(u + 0.02 * np.cos(np.arange(u.size)))


def search(equations: Any, intervals: int, stages: int = 3) -> Search:
    """Search for the orbit of a system that runs in the plane or on the globe."""
    guess = near(equations.on_orbit()[equations.differential], equations.period)
    return find_orbit(shooting(equations, intervals, stages=stages), guess, 0.0)


def found(result: Search) -> Orbit:
    assert result.orbit is not None, result.advice
    return result.orbit
