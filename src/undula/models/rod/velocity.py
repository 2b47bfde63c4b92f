"""Velocity, multipliers and energy of the linked rod at given positions.

Rigid links: the multipliers follow from t_i . (v_i - v_{i-1}) = 0, a tridiagonal system, since

    v_i = M_i (f_i - T_i t_i + T_{i+1} t_{i+1}),    M_i = [I + (gamma - 1) m m] / w_i.

Extensible links: the multiplier follows from the stretch of its link.
"""

from typing import Any

import numpy as np

from undula.jit.compilation import entry, kernel, overwrite
from undula.models.rod.joint import joint_energy, stiffening
from undula.models.rod.residual import cosine_kernel, mean_tangent_kernel, tangents_kernel
from undula.models.rod.sizes import sizes_match
from undula.models.rod.tables import RODS, RODS_WITH_OWN_JOINTS, DirectedRod, UnwrappedRod
from undula.models.rod.tridiagonal import solve_tridiagonal
from undula.models.rod.twist import directed_energy, find_directors
from undula.models.rod.unwrapped import unwrapped_energy, update_angles
from undula.numerics.integration.system import RATES, generic, implements, rates, residual


@generic
def find_multipliers(system: Any, y: Any) -> Any:
    """Overwrite the multipliers in y (n,) by those of its positions."""


@generic
def find_velocity(system: Any, y: Any, v: Any) -> Any:
    """Write the velocity at positions and multipliers y (n,) to v (n,)."""


@generic
def elastic_energy(system: Any, y: Any) -> Any:
    """Return the energies of bending and of stretching at y (n,)."""
    return 0.0, 0.0


def _register(rod: Any) -> None:
    d, m, extensible = rod.dimension, rod.stride, rod.extensible
    tangents, cosine, mean_tangent = tangents_kernel(rod), cosine_kernel(d), mean_tangent_kernel(d)

    @implements(find_velocity, rod)
    def rod_velocity(system: Any, y: Any, v: Any) -> None:
        n = system.joint.shape[0]
        t, length, mean, force = np.empty((n, d)), np.empty(n), np.empty(d), np.empty(n * m)
        tangents(system, y, t, length)
        residual(system, y, np.zeros(n * m), -1.0, force)
        for i in range(n):
            mean_tangent(t, i, mean)
            along = 0.0
            for a in range(d):
                along += mean[a] * force[m * i + a]
            along *= system.anisotropy / (1.0 - system.anisotropy)  # gamma - 1
            for a in range(d):
                v[m * i + a] = (force[m * i + a] + along * mean[a]) / system.weight[i]
            for k in range(m * i + d, m * i + m):
                v[k] = 0.0

    @kernel
    def mobility(system: Any, t: Any, mean: Any, p: Any, q: Any, i: Any) -> Any:
        """Return t_p . M_i t_q, with m of node i in `mean`."""
        product = first = second = 0.0
        for a in range(d):
            product += t[p, a] * t[q, a]
            first += t[p, a] * mean[a]
            second += t[q, a] * mean[a]
        excess = system.anisotropy / (1.0 - system.anisotropy)  # gamma - 1
        return (product + excess * first * second) / system.weight[i]

    @kernel
    def rigid_multipliers(system: Any, y: Any) -> None:
        n = system.joint.shape[0]
        t, length, mean, v = np.empty((n, d)), np.empty(n), np.empty(d), np.empty(n * m)
        lower, diagonal, upper, tension = np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n)
        tangents(system, y, t, length)
        for i in range(n):
            y[m * i + d] = 0.0
        rod_velocity_compiled(system, y, v)
        for i in range(n):
            mean_tangent(t, i, mean)
            diagonal[i] += mobility(system, t, mean, i, i, i)
            if i + 1 < n:
                diagonal[i + 1] += mobility(system, t, mean, i + 1, i + 1, i)
                upper[i] = lower[i + 1] = -mobility(system, t, mean, i, i + 1, i)
            for a in range(d):
                previous = v[m * (i - 1) + a] if i > 0 else 0.0
                tension[i] += t[i, a] * (v[m * i + a] - previous)
        solve_tridiagonal(lower, diagonal, upper, tension)
        for i in range(n):
            y[m * i + d] = tension[i]

    @kernel
    def extensible_multipliers(system: Any, y: Any) -> None:
        n = system.joint.shape[0]
        t, length = np.empty((n, d)), np.empty(n)
        tangents(system, y, t, length)
        for i in range(n):
            shortfall = 0.0
            for j in range(i, min(i + 2, n)):
                c = cosine(t, j)
                shortfall += system.joint[j] * stiffening(c) * (1.0 - c)
            tension = system.tensile * (length[i] / system.link - 1.0)
            y[m * i + d] = tension - shortfall / length[i]

    @kernel
    def unwrapped_multipliers(system: Any, y: Any) -> None:
        update_angles(system, y)
        rigid_multipliers(system, y)

    @kernel
    def directed_multipliers(system: Any, y: Any) -> None:
        find_directors(system, y)
        rigid_multipliers(system, y)

    rod_velocity_compiled = kernel(rod_velocity)
    compiled = extensible_multipliers if extensible else rigid_multipliers
    if rod is UnwrappedRod:
        compiled = unwrapped_multipliers
    if rod is DirectedRod:
        compiled = directed_multipliers

    @implements(find_multipliers, rod)
    def rod_multipliers(system: Any, y: Any) -> None:
        compiled(system, y)


def _register_energy(rod: Any) -> None:
    d, extensible = rod.dimension, rod.extensible
    tangents = tangents_kernel(rod)

    @implements(elastic_energy, rod)
    def rod_energy(system: Any, y: Any) -> Any:
        n = system.joint.shape[0]
        t, length = np.empty((n, d)), np.empty(n)
        tangents(system, y, t, length)
        bending = stretching = 0.0
        for i in range(n):
            chord = 0.0  # |t_i - t_{i-1}|^2 = 4 sin^2(psi / 2), accurate for small angles too
            for a in range(d):
                previous = t[i - 1, a] if i > 0 else (1.0 if a == d - 1 else 0.0)
                chord += (t[i, a] - previous) ** 2
            bending += system.joint[i] * joint_energy(chord)
            if extensible:
                strain = length[i] / system.link - 1.0
                stretching += 0.5 * system.tensile * system.link * strain * strain
        return bending, stretching


for _rod in RODS:
    _register(_rod)
    if _rod not in RODS_WITH_OWN_JOINTS:
        _register_energy(_rod)
implements(elastic_energy, UnwrappedRod)(unwrapped_energy)
implements(elastic_energy, DirectedRod)(directed_energy)


@entry(f"y (n), v (n + {RATES})", where=lambda system, n: sizes_match(system, n))
def rate_of_change(system: Any, y: Any, v: Any) -> None:
    """Compute the multipliers at the positions in y, in place, and all rates.

    Parameters
    ----------
    system : Rod
        The tables.
    y : ndarray, shape (n,)
        Positions; receives the multipliers.
    v : ndarray, shape (n + RATES,)
        Receives the velocity and the rates of the integrals.
    """
    n = y.shape[0]
    find_multipliers(system, y)
    find_velocity(system, y, v[:n])
    rates(system, y, v[:n], v[n:])


@entry(
    "states (m, n), out (m, q)",
    where=lambda system, n, q: sizes_match(system, n) and (q == 2 or q == 4),
)
def observe(system: Any, states: Any, out: Any) -> None:
    """Compute energies and powers of several states.

    Parameters
    ----------
    system : Rod
        The tables.
    states : ndarray, shape (m, n)
        Positions and multipliers; the multipliers are recomputed.
    out : ndarray, shape (m, 4) or (m, 2)
        Receives the energies of bending and of stretching, the active power and the dissipation;
        with two columns the energies only, which need no velocities.
    """
    y, v, rates_found = np.empty(states.shape[1]), np.empty(states.shape[1]), np.empty(3)
    for k in range(states.shape[0]):
        overwrite(y, states[k])
        out[k, 0], out[k, 1] = elastic_energy(system, y)
        if out.shape[1] > 2:
            find_multipliers(system, y)
            find_velocity(system, y, v)
            rates(system, y, v, rates_found)
            out[k, 2], out[k, 3] = rates_found[1], rates_found[2]
