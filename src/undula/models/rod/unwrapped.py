"""Rigid links in a plane with unwrapped joint angles, which are continuous beyond pi.

In a plane the angle psi from one link to the next has a sign and is defined up to full turns, which
the continuity of a motion determines. The energy K psi^2 / 2 of a joint then has no kink: where the
joint of `undula.models.rod.joint` folds over, the moment of this joint keeps growing. With M_j the
moment of the joint below link j and n_j its normal, the force along link j is

    q_j = (M_{j+1} - M_j) n_j / h - T_j t_j,    M_j = K_j psi_j,    n = (t_z, -t_x)    in (x, z)

and the rest is as in `undula.models.rod.tables`. Moments act as couples, so that T_j is the
multiplier of the length alone and the equations have no singularity. psi_j is positive where link j
is inclined more towards x than the link before it. It is an unknown, (x_i, z_i, T_i, psi_i) node by
node, with the equation

    psi_j - angle from t_{j-1} to t_j = 0,

whose left side is taken between -pi and pi, and does not count full turns. A step continues them
from the states before it. For a state without them (psi = 0) the principal angles are taken.
"""

import math
from typing import Any

import numpy as np

from undula.jit.compilation import kernel
from undula.models.rod.residual import along_kernel, tangents_kernel
from undula.models.rod.tables import UnwrappedRod
from undula.numerics.integration.system import constraint_error, implements, residual

_tangents, _along = tangents_kernel(UnwrappedRod), along_kernel(UnwrappedRod)


@kernel
def angle_excess(y: Any, t: Any, i: Any) -> Any:
    """Return psi below link i less the angle between the links, in (-pi, pi]."""
    x, z = (t[i - 1, 0], t[i - 1, 1]) if i > 0 else (0.0, 1.0)
    cosine, sine = x * t[i, 0] + z * t[i, 1], z * t[i, 0] - x * t[i, 1]
    c, s = math.cos(y[4 * i + 3]), math.sin(y[4 * i + 3])
    return math.atan2(s * cosine - c * sine, c * cosine + s * sine)


@kernel
def moment_step(system: Any, y: Any, i: Any) -> Any:
    """Return (M_{i+1} - M_i) / h for link i."""
    step = -system.joint[i] * y[4 * i + 3]
    if i + 1 < system.joint.shape[0]:
        step += system.joint[i + 1] * y[4 * i + 7]
    return step / system.link


@kernel
def update_angles(system: Any, y: Any) -> None:
    """Overwrite each psi in y (n,) by the nearest angle that is consistent with the links."""
    n = system.joint.shape[0]
    t, length = np.empty((n, 2)), np.empty(n)
    _tangents(system, y, t, length)
    for i in range(n):
        y[4 * i + 3] -= angle_excess(y, t, i)


@kernel
def unwrapped_energy(system: Any, y: Any) -> Any:
    """Return the energies of bending and of stretching at y (n,), full turns included."""
    n, bending = system.joint.shape[0], 0.0
    t, length = np.empty((n, 2)), np.empty(n)
    _tangents(system, y, t, length)
    for i in range(n):
        psi = y[4 * i + 3] - angle_excess(y, t, i)
        bending += 0.5 * system.joint[i] * psi * psi
    return bending, 0.0


@implements(residual, UnwrappedRod)
def unwrapped_residual(system: Any, y: Any, w: Any, c: Any, out: Any) -> None:
    """Write R(x) w - c f(x, z) and the constraints to out (n,)."""
    n = system.joint.shape[0]
    t, length = np.empty((n, 2)), np.empty(n)
    _tangents(system, y, t, length)
    for i in range(n):
        couple, reduction = moment_step(system, y, i), system.anisotropy * _along(t, w, i)
        square = 0.0
        for a in range(2):
            normal = t[i, 1] if a == 0 else -t[i, 0]
            force = couple * normal - y[4 * i + 2] * t[i, a]
            if i > 0:
                out[4 * (i - 1) + a] += c * (force + system.inner_force[i] * t[i, a])
            direction = t[i, a] + (t[i + 1, a] if i + 1 < n else 0.0)
            drag = system.weight[i] * (w[4 * i + a] - reduction * direction)
            out[4 * i + a] = drag - c * (force - system.outer_force[i] * t[i, a])
            square += t[i, a] * t[i, a]
        out[4 * i + 2] = 0.5 * (square - 1.0)
        out[4 * i + 3] = angle_excess(y, t, i)


@implements(constraint_error, UnwrappedRod)
def unwrapped_constraint_error(system: Any, y: Any) -> Any:
    """Return the largest violation of the constraints at y (n,)."""
    n, largest = system.joint.shape[0], 0.0
    t, length = np.empty((n, 2)), np.empty(n)
    _tangents(system, y, t, length)
    for i in range(n):
        square = t[i, 0] * t[i, 0] + t[i, 1] * t[i, 1]
        largest = max(largest, abs(0.5 * (square - 1.0)), abs(angle_excess(y, t, i)))
    return largest
