"""The filament as a user would write it in numpy: dx/dt of n links that are stiff springs.

    w_i v_i = (I + (gamma - 1) m_i m_i) f_i,     f_i = p_i - p_{i+1},  at the tip less F t_n
    p_j = - dE/de_j = P_j (K_j g_j t_{j-1} + K_{j+1} g_{j+1} t_{j+1}) / l_j - S (l_j / h - 1) t_j
    E = sum of K_j psi_j^2 / 2 + S h (l_j / h - 1)^2 / 2,    g = psi / sin psi,    P = I - t t

with links e_j of length l_j along t_j, joint angles psi_j, the clamp's t_0 = e_z, and m_i the
normalised mean of the tangents beside node i. The textbook gives all cells one length, h; `half`
cells at the ends (K_1 = 2 / h, w_n = h / 2) are undula's and make the layout second order.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: EA L^2 / B of a rod whose radius is a hundredth of its length.
TENSILE_STIFFNESS = 4e4
#: Nodes feel two neighbours on either side, each three numbers.
HALF_BANDWIDTH = 8


class Rod(NamedTuple):
    """The numbers that make the filament."""

    joint: Array  # K (n,), of the joint at the foot of each link
    weight: Array  # w (n,)
    force: float  # F
    drag_ratio: float  # gamma
    tensile: float  # S


def textbook(
    segments: int, force: float, *, half: bool = False, tensile: float = TENSILE_STIFFNESS
) -> Rod:
    """Return the rod of n links with full cells, or `half` ones, at its ends."""
    h = 1.0 / segments
    joint, weight = np.full(segments, 1.0 / h), np.full(segments, h)
    if half:
        joint[0], weight[-1] = 2.0 / h, 0.5 * h
    return Rod(joint, weight, force, 2.0, tensile)


def rhs(x: Array, rod: Rod) -> Array:
    """Return dx/dt of the positions x (3 n,), node by node from the one after the clamp."""
    n = rod.joint.size
    nodes = np.vstack([np.zeros(3), x.reshape(n, 3)])
    links = np.diff(nodes, axis=0)
    lengths = np.linalg.norm(links, axis=1)
    t = links / lengths[:, None]
    before = np.vstack([[0.0, 0.0, 1.0], t[:-1]])
    cross = np.linalg.norm(np.cross(before, t), axis=1)
    psi = np.arctan2(cross, np.sum(before * t, axis=1))
    bend = rod.joint * np.where(psi > 1e-8, psi / np.where(psi > 1e-8, np.sin(psi), 1.0), 1.0)
    pull = bend[:, None] * before
    pull[:-1] += bend[1:, None] * t[1:]
    across = pull - np.sum(pull * t, axis=1)[:, None] * t
    inner = across / lengths[:, None] - (rod.tensile * (lengths * n - 1.0))[:, None] * t
    force = inner.copy()
    force[:-1] -= inner[1:]
    force[-1] -= rod.force * t[-1]
    mean = t.copy()
    mean[:-1] += t[1:]
    mean /= np.linalg.norm(mean, axis=1)[:, None]
    along = np.sum(mean * force, axis=1)[:, None] * mean
    velocity = (force + (rod.drag_ratio - 1.0) * along) / rod.weight[:, None]
    return velocity.ravel()
