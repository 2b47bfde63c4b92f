"""The filament as users of PyElastica set it up: a Cosserat rod with a little mass, stepped openly.

The rod is round, a/L = 1/100, so that EA L^2 / B = 4e4; it can shear (G = E / 3). Drag is the
library's slender-body theory, whose ratio is 2, one end is fixed, and the tip bears a follower
force. A mass per length m, in units of zeta_perp T, stands in for none: its relaxation time is m,
and it has to be short beside a period. Rotations are damped at the rate 1 / m, which is a drag on
rotation of a^2 / 4 and keeps shear waves from ringing.
"""

import logging
import time
from dataclasses import dataclass
from typing import Any

import elastica as ea
import numpy as np

from contenders.textbook import Array

RADIUS = 0.01
#: The library warns that so light a rod has little inertia, which is the point.
logging.getLogger().setLevel(logging.ERROR)
#: Steps that tell whether a time step is stable: instability may grow slowly near the limit.
TRIAL_STEPS = 10_000


class TipFollowerForce(ea.NoForces):
    """A force at the last node against the last tangent."""

    def __init__(self, force: float) -> None:
        super().__init__()
        self.force = force

    def apply_forces(self, system: Any, time: float = 0.0) -> None:  # noqa: ARG002
        """Add it."""
        system.external_forces[:, -1] -= self.force * system.tangents[:, -1]


class Simulator(ea.BaseSystemCollection, ea.Constraints, ea.Forcing, ea.Damping):
    """What the library puts a simulation together from."""


@dataclass
class Elastica:
    """A simulation that can be stepped."""

    simulator: Any
    rod: Any
    step: float
    time: float = 0.0

    def __post_init__(self) -> None:
        """Make the stepper."""
        self._stepper = ea.PositionVerlet()

    def advance(self, steps: int) -> bool:
        """Take so many steps; return whether the rod is still a rod."""
        try:
            with np.errstate(all="ignore"):
                for _ in range(steps):
                    self.time = self._stepper.step(self.simulator, self.time, self.step)
        except ZeroDivisionError:  # what compiled parts of the library meet in a rod that explodes
            return False
        tilt = np.sum(self.rod.director_collection[2] * self.rod.tangents, axis=0)
        nodes = self.rod.position_collection
        # Shear waves become unstable first: cross-sections tumble while the centre line stays.
        return bool(np.isfinite(nodes).all() and np.abs(nodes).max() < 2.0 and tilt.min() > 0.9)


def directors(tangents: Array) -> Array:
    """Return frames (3, 3, n), rows d1, d2, t, that do not twist along the tangents (n, 3)."""
    frames, normal = np.empty((3, 3, len(tangents))), np.array([1.0, 0.0, 0.0])
    for j, t in enumerate(tangents):
        normal = normal - (normal @ t) * t
        normal /= np.linalg.norm(normal)
        frames[:, :, j] = normal, np.cross(t, normal), t
    return frames


def build(x: Array, force: float, mass: float, step: float) -> Elastica:
    """Return the simulation that starts from the shape x (3 n,), its first element upright."""
    links = np.diff(x.reshape(-1, 3), axis=0, prepend=np.zeros((1, 3)))
    tangents = links / np.linalg.norm(links, axis=1)[:, None]
    tangents[0] = 0.0, 0.0, 1.0
    nodes = np.vstack([np.zeros(3), np.cumsum(tangents / len(tangents), axis=0)])
    youngs = 4.0 / (np.pi * RADIUS**4)
    rod = ea.CosseratRod.straight_rod(
        len(tangents),
        np.zeros(3),
        np.array([0.0, 0.0, 1.0]),
        np.array([1.0, 0.0, 0.0]),
        1.0,
        RADIUS,
        mass / (np.pi * RADIUS**2),
        youngs_modulus=youngs,
        shear_modulus=youngs / 3.0,
        position=np.ascontiguousarray(nodes.T),
        directors=directors(tangents),
    )
    simulator = Simulator()
    simulator.append(rod)
    simulator.constrain(rod).using(
        ea.OneEndFixedBC, constrained_position_idx=(0,), constrained_director_idx=(0,)
    )
    simulator.add_forcing_to(rod).using(TipFollowerForce, force)
    viscosity = np.log(1.0 / RADIUS) / (4.0 * np.pi)
    simulator.add_forcing_to(rod).using(ea.SlenderBodyTheory, dynamic_viscosity=viscosity)
    turning = rod.mass_second_moment_of_inertia[0, 0].mean() / mass
    simulator.dampen(rod).using(
        ea.AnalyticalLinearDamper,
        translational_damping_constant=0.0,
        rotational_damping_constant=turning,
        time_step=step,
    )
    simulator.finalize()
    return Elastica(simulator, rod, step)


def longest_stable_step(x: Array, force: float, mass: float) -> float:
    """Return the longest step, to 2 per cent, with which the rod survives `TRIAL_STEPS`."""
    low, high = 0.0, mass
    step = 0.1 * np.sqrt(mass) / x.size  # about a tenth of what a stretching wave allows
    while high - low > 0.02 * high:
        if build(x, force, mass, step).advance(TRIAL_STEPS):
            low = step
        else:
            high = step
        step = min(2.0 * low, 0.5 * (low + high)) if low > 0.0 else 0.5 * high
    return low


def seconds_a_step(x: Array, force: float, mass: float, step: float, count: int = 1000) -> float:
    """Return what a step takes, after some that do not count."""
    simulation = build(x, force, mass, step)
    simulation.advance(100)
    begun = time.process_time()
    simulation.advance(count)
    return (time.process_time() - begun) / count
