"""The exact derivative of the residual of unwrapped links (see `undula.models.rod.unwrapped`).

The force along a link depends on its own direction and on the angles at its ends,

    dq_j/dt_j = (M_{j+1} - M_j) J / h - T_j,    J t = n,    dq_j/dpsi_j = -K_j n_j / h,

and an angle on the directions of its links, d angle = n_j . dt_j / |t_j|^2 - n_{j-1} . dt_{j-1} /
|t_{j-1}|^2.
"""

from typing import Any

import numpy as np

from undula.jit.compilation import kernel
from undula.models.rod.jacobian import derivative_kernel
from undula.models.rod.residual import tangents_kernel
from undula.models.rod.tables import UnwrappedRod
from undula.models.rod.unwrapped import moment_step

_HALF = 3 * UnwrappedRod.stride - 1
_tangents = tangents_kernel(UnwrappedRod)


@kernel
def _link_blocks(system: Any, y: Any, t: Any, length: Any, blocks: Any) -> None:  # noqa: ARG001
    """Write dq_i / de_{i-1+s} to blocks[i, s]."""
    blocks[:] = 0.0
    for i in range(t.shape[0]):
        couple, tension = moment_step(system, y, i) / system.link, y[4 * i + 2] / system.link
        blocks[i, 1, 0, 0] = blocks[i, 1, 1, 1] = -tension
        blocks[i, 1, 0, 1], blocks[i, 1, 1, 0] = couple, -couple


_at_fixed_angles = derivative_kernel(UnwrappedRod, _link_blocks)


@kernel
def unwrapped_derivative(system: Any, y: Any, w: Any, c: Any, turn: Any, band: Any) -> None:
    """Write the derivative of the residual to band (n, 2 b + 1)."""
    n = system.joint.shape[0]
    t, length = np.empty((n, 2)), np.empty(n)
    _tangents(system, y, t, length)
    _at_fixed_angles(system, y, w, c, turn, band)
    for i in range(n):
        square = t[i, 0] * t[i, 0] + t[i, 1] * t[i, 1]
        band[4 * i + 3, _HALF] = 1.0
        for a in range(2):
            normal = (t[i, 1] if a == 0 else -t[i, 0]) / system.link
            # q_i with the angles at both ends of link i, on its outer and on its inner node
            for j in range(i, min(i + 2, n)):
                force = -c * normal * system.joint[j] * (1.0 if j > i else -1.0)
                band[4 * i + a, _HALF + 4 * (j - i) + 3 - a] += force
                if i > 0:
                    band[4 * (i - 1) + a, _HALF + 4 * (j - i + 1) + 3 - a] -= force
            # the angles at both ends of link i with its nodes
            for j in range(i, min(i + 2, n)):
                slope = normal / square * (1.0 if j > i else -1.0)
                band[4 * j + 3, _HALF + 4 * (i - j) + a - 3] += slope
                if i > 0:
                    band[4 * j + 3, _HALF + 4 * (i - 1 - j) + a - 3] -= slope
