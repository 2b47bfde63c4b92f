"""The framed rod once more, slow and obvious: frames are rotations, forces differences of energies.

Joints are the rotation vectors between frames as scipy finds them; the twist of least energy is
found by a general minimiser. Nothing is shared with the kernels.
"""

from functools import cache
from itertools import pairwise

import numpy as np
from scipy.integrate import quad_vec
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

import naive
from undula.arrays import Array, State
from undula.models.filament import Filament


def tangents(model: Filament, x: State) -> Array:
    links = naive.links_of(model, x)
    return np.asarray(links / naive.lengths(links)[:, None])


def least_turn(start: Array, end: Array) -> Rotation:
    """Return the smallest rotation that takes one unit vector to another."""
    axis = np.cross(start, end)
    sine = np.linalg.norm(axis)
    angle = np.arctan2(sine, start @ end)
    return Rotation.from_rotvec(axis / sine * angle if sine > 0.0 else np.zeros(3))


@cache
def natural_angles(model: Filament) -> Array:
    """Return the angles (N, 2) by which joints are bent at rest, integrals of the curvature."""
    n, given = model.segments, model.natural_curvature
    ends = np.append(0.0, (np.arange(n) + 0.5) / n)
    if not callable(given):
        return np.outer(np.diff(ends), given)
    return np.array([quad_vec(lambda s: np.array(given(s)), a, b)[0] for a, b in pairwise(ends)])


def energy(model: Filament, x: State, twists: Array) -> float:
    """Return the energy at the twists (N - 1,) of all links but the last [rad]."""
    t, n, total = tangents(model, x), model.segments, 0.0
    natural, below, frame = natural_angles(model), np.array([0.0, 0.0, 1.0]), Rotation.identity()
    for j in range(n):
        if j > 0:
            frame = Rotation.from_rotvec(twists[j - 1] * below) * frame
        above = least_turn(below, t[j]) * frame
        bend = (frame.inv() * above).as_rotvec()
        assert abs(bend[2]) < 1e-12
        stiffness = 2.0 * n if j == 0 else float(n)
        excess = bend[:2] - natural[j]
        total += 0.5 * stiffness * (excess[0] ** 2 + model.bending_ratio * excess[1] ** 2)
        frame, below = above, t[j]
    return total + 0.5 * model.twist_stiffness * n * float(twists @ twists)


def least_energy(model: Filament, x: State, near: Array) -> float:
    """Return the energy, minimised over the twist where links are free to."""
    if model.twist != "elastic":
        return energy(model, x, np.zeros(model.segments - 1))
    found = minimize(lambda twists: energy(model, x, twists), near, tol=1e-9)
    return float(found.fun)


def velocity(model: Filament, x: State, near: Array) -> State:
    """Return dx/dt of a filament without load: R v = -dE/dx - G^T T, with G v = 0."""
    step = 2e-3 / model.segments
    slopes = naive.differences(lambda at: np.array([least_energy(model, at, near)]), x, step)[0]
    rates = naive.stretching(model, x)
    n = len(rates)
    saddle = np.block([[naive.drag(model, x), rates.T], [rates, np.zeros((n, n))]])
    solved = np.linalg.solve(saddle, np.concatenate([-slopes, np.zeros(n)]))
    return np.asarray(solved[:-n])
