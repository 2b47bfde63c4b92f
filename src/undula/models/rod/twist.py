"""Directors, twist moments and energy of a rod with directors at given positions.

The equations are those of `undula.models.rod.material_frame`: the moments obey m_j - m_{j-1} = e_j,
with m = 0 in the last link, and directors rotate by h m / C from link to link. Without twist the
directors follow directly. With twist their angles alpha obey a discrete pendulum equation, which
Newton's method solves:

    d2(dalpha)_j - (h / C) e'_j dalpha_j = -(h / C) (m_j - m_{j-1} - e_j),    e' = de/dalpha,

with the second difference d2, dalpha = 0 at the clamp, and no difference beyond the last joint.
For a small twist stiffness it may have several solutions. Where the matrix is not that of a minimum
of the energy, negative e' are left out, and corrections are halved until the energy falls.

The vector y has eight numbers a node: position, tension, director and twist moment.
"""

from typing import Any

import numpy as np

from undula.jit.compilation import kernel, overwrite
from undula.models.rod.material_frame import (
    JOINT,
    bends,
    director_above,
    first_director,
    joint_at,
    joint_cosine,
    of_cosine,
    transport,
    twist_of,
)
from undula.models.rod.residual import tangents_kernel
from undula.models.rod.tables import DirectedRod
from undula.models.rod.tridiagonal import solve_tridiagonal

_tangents = tangents_kernel(DirectedRod)

#: Largest number of Newton corrections.
_MAX_CORRECTIONS = 60
#: Largest number of halvings of a correction that does not lower the energy.
_MAX_HALVINGS = 40
#: Increase of the energy, relative to itself plus 1, that counts as round-off.
_ROUND_OFF = 1e-12
#: Largest correction [rad] after which quadratic convergence leaves only round-off.
_STEP_TOLERANCE = 1e-9


@kernel
def carry_directors(system: Any, y: Any, t: Any, turning: Any, stiffness: Any) -> Any:
    """Write to y the directors that follow from its moments; return the energy of the joints.

    The derivatives e and e' (N,) of the joints by a rotation of their directors are written to
    `turning` and `stiffness`.
    """
    n, energy = system.joint.shape[0], 0.0
    x, transported, first = np.empty(JOINT), np.empty(3), np.empty(3)
    for j in range(n):
        joint_at(y, t, j, x)
        first_director(j, first, x)
        (g, _, inverse), joint = of_cosine(joint_cosine(x)), system.joint[j]
        transport(x, inverse, twist_of(system, x, j), transported)
        if j == 0:
            overwrite(first, transported)
        else:
            overwrite(y[8 * (j - 1) + 4 : 8 * (j - 1) + 7], transported)
        director_above(y, transported, j, x)
        along, across, first_moment, second_moment = bends(system, x, g, j)
        u1, u2 = g * across, -g * along
        turning[j] = first_moment * u2 - second_moment * u1
        stiffness[j] = (
            joint * (u2 * u2 + system.ratio * u1 * u1) - first_moment * u1 - second_moment * u2
        )
        energy += 0.5 * (
            first_moment * (u1 - system.natural[j, 0]) + second_moment * (u2 - system.natural[j, 1])
        )
    overwrite(y[8 * n - 4 : 8 * n - 1], y[8 * n - 12 : 8 * n - 9])
    return energy


@kernel
def twist_energy(system: Any, y: Any) -> Any:
    """Return the energy of the twist of all links."""
    energy = 0.0
    for j in range(system.joint.shape[0]):
        energy += 0.5 * system.compliance * system.link * y[8 * j + 7] * y[8 * j + 7]
    return energy


@kernel
def newton_turns(system: Any, y: Any, turning: Any, stiffness: Any, turn: Any) -> Any:
    """Write Newton's correction of the angles to turn (N,); False if the energy is not convex."""
    n, twist_compliance, convex = system.joint.shape[0], system.compliance * system.link, True
    lower, diagonal, upper = np.ones(n), np.full(n, -2.0), np.ones(n)
    diagonal[0], upper[0], diagonal[n - 1], turn[0] = 1.0, 0.0, -1.0, 0.0
    for j in range(1, n):
        diagonal[j] -= twist_compliance * stiffness[j]
        turn[j] = -twist_compliance * (y[8 * j + 7] - y[8 * j - 1] - turning[j])
    solve_tridiagonal(lower, diagonal, upper, turn)
    for j in range(1, n):
        convex = convex and diagonal[j] < 0.0
    return convex


@kernel
def apply_turns(system: Any, y: Any, turn: Any, before: Any, part: Any) -> None:
    """Set the moments in y to `before` (N,), changed by a part of the correction of the angles."""
    for j in range(before.shape[0] - 1):
        change = (turn[j + 1] - turn[j]) / (system.compliance * system.link)
        y[8 * j + 7] = before[j] + part * change


@kernel
def find_directors(system: Any, y: Any) -> Any:
    """Compute directors and twist moments at the positions in y (n,), in place.

    The minimisation of the energy starts from the moments in y; they are NaN afterwards if it
    fails. The energy of joints and twist is returned.
    """
    n = system.joint.shape[0]
    t, length, turning, stiffness = np.empty((n, 3)), np.empty(n), np.empty(n), np.empty(n)
    _tangents(system, y, t, length)
    y[8 * n - 1] = 0.0
    energy = carry_directors(system, y, t, turning, stiffness) + twist_energy(system, y)
    if system.compliance == 0.0:
        for j in range(n - 1, 0, -1):
            y[8 * j - 1] = y[8 * j + 7] - turning[j]
        return energy
    turn, before = np.empty(n), np.empty(n)
    for _ in range(_MAX_CORRECTIONS):
        if not newton_turns(system, y, turning, stiffness, turn):
            for j in range(n):
                stiffness[j] = max(stiffness[j], 0.0)
            newton_turns(system, y, turning, stiffness, turn)
        largest, part, trial_energy = np.abs(turn).max(), 1.0, np.inf
        overwrite(before, y[7::8])
        for _ in range(_MAX_HALVINGS):
            apply_turns(system, y, turn, before, part)
            trial_energy = carry_directors(system, y, t, turning, stiffness) + twist_energy(
                system, y
            )
            if trial_energy <= energy + _ROUND_OFF * (1.0 + abs(energy)):
                break
            part *= 0.5
        energy = trial_energy
        if largest <= _STEP_TOLERANCE:
            return energy
    y[7::8] = np.nan
    return np.nan


@kernel
def directed_energy(system: Any, y: Any) -> Any:
    """Return the energies of bending and twist, and of stretching (0), at y (n,)."""
    return find_directors(system, y.copy()), 0.0
