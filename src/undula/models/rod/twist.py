"""Directors, twist moments and energy of a framed rod at given positions (see `framed`).

The moments obey m_j - m_{j-1} = e_j, with m = 0 in the last link and directors that turn from link
to link by h m / C. Links that do not twist have directors that are known at once; else the turns
alpha of the directors are a discrete pendulum, which Newton's method solves:

    d2(dalpha)_j - (h / C) e'_j dalpha_j = -(h / C) (m_j - m_{j-1} - e_j),    e' = de/dalpha,

with the second difference d2, dalpha = 0 at the clamp, and no difference beyond the last joint.
Several turns may be in balance where twist is soft. Where the matrix is not that of a minimum of
the energy, negative e' are left out of it, and corrections are halved until the energy falls.
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

#: Corrections after which the search for the twist is given up.
_MOST_CORRECTIONS = 60
#: How often a correction is halved that does not lower the energy.
_MOST_HALVINGS = 40
#: An energy that rises by less, relative to 1 and to itself, has not risen.
_ROUND_OFF = 1e-12
#: Corrections double their digits: behind one so small there is round-off.
_CONVERGED = 1e-9


@kernel
def carry_directors(system: Any, y: Any, t: Any, turning: Any, stiffness: Any) -> Any:
    """Write the directors that belong to the moments in y to y; return the energy of the joints.

    The slopes e and e' (N,) of the joints by a turn of their directors go to the other arrays.
    """
    n, energy = system.joint.shape[0], 0.0
    x, moved, first = np.empty(JOINT), np.empty(3), np.empty(3)
    for j in range(n):
        joint_at(y, t, j, x)
        first_director(j, first, x)
        (g, _, inverse), joint = of_cosine(joint_cosine(x)), system.joint[j]
        transport(x, inverse, twist_of(system, x, j), moved)
        if j == 0:
            overwrite(first, moved)
        else:
            overwrite(y[8 * (j - 1) + 4 : 8 * (j - 1) + 7], moved)
        director_above(y, moved, j, x)
        along, across, one, two = bends(system, x, g, j)
        u1, u2 = g * across, -g * along
        turning[j] = one * u2 - two * u1
        stiffness[j] = joint * (u2 * u2 + system.ratio * u1 * u1) - one * u1 - two * u2
        energy += 0.5 * (one * (u1 - system.natural[j, 0]) + two * (u2 - system.natural[j, 1]))
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
    """Write Newton's correction of the directors to turn (N,); False where it seeks no minimum."""
    n, soft, convex = system.joint.shape[0], system.compliance * system.link, True
    lower, diagonal, upper = np.ones(n), np.full(n, -2.0), np.ones(n)
    diagonal[0], upper[0], diagonal[n - 1], turn[0] = 1.0, 0.0, -1.0, 0.0
    for j in range(1, n):
        diagonal[j] -= soft * stiffness[j]
        turn[j] = -soft * (y[8 * j + 7] - y[8 * j - 1] - turning[j])
    solve_tridiagonal(lower, diagonal, upper, turn)
    for j in range(1, n):
        convex = convex and diagonal[j] < 0.0
    return convex


@kernel
def take_turns(system: Any, y: Any, turn: Any, before: Any, part: Any) -> None:
    """Overwrite the moments in y by those before (N,) and a part of the turns of directors."""
    for j in range(before.shape[0] - 1):
        change = (turn[j + 1] - turn[j]) / (system.compliance * system.link)
        y[8 * j + 7] = before[j] + part * change


@kernel
def find_frames(system: Any, y: Any) -> Any:
    """Overwrite directors and twist moments in y (n,) by those that belong to its positions.

    The search for the twist of least energy starts from the moments in y, which are NaN afterwards
    if it found none. Returns the energy of joints and twist.
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
    for _ in range(_MOST_CORRECTIONS):
        if not newton_turns(system, y, turning, stiffness, turn):
            for j in range(n):
                stiffness[j] = max(stiffness[j], 0.0)
            newton_turns(system, y, turning, stiffness, turn)
        largest, part, found = np.abs(turn).max(), 1.0, np.inf
        overwrite(before, y[7::8])
        for _ in range(_MOST_HALVINGS):
            take_turns(system, y, turn, before, part)
            found = carry_directors(system, y, t, turning, stiffness) + twist_energy(system, y)
            if found <= energy + _ROUND_OFF * (1.0 + abs(energy)):
                break
            part *= 0.5
        energy = found
        if largest <= _CONVERGED:
            return energy
    y[7::8] = np.nan
    return np.nan


@kernel
def framed_energy(system: Any, y: Any) -> Any:
    """Return the energies of bending, with that of the twist, and of stretching at y (n,)."""
    return find_frames(system, y.copy()), 0.0
