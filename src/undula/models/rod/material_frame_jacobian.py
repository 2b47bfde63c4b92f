"""The exact derivative of the residual of a rod with directors.

The equations are those of `undula.models.rod.material_frame`. The forces of a joint, its torque
about the tangent and its transported director depend on ten numbers. Their derivative by each is
computed by a complex step, which has no truncation error. Functions of the angle between the links,
or of the twist, get their imaginary parts from their own derivatives. The director of the first
link is not an unknown, but a function of that link's tangent.
"""

from typing import Any

import numpy as np

from undula.jit.compilation import kernel, overwrite
from undula.models.rod.jacobian import derivative_kernel
from undula.models.rod.joint import stiffening_curvature
from undula.models.rod.material_frame import (
    JOINT,
    director_above,
    first_director,
    joint_at,
    joint_cosine,
    joint_slopes,
    of_cosine,
    transport,
    twist_of,
)
from undula.models.rod.residual import tangents_kernel
from undula.models.rod.tables import DirectedRod

_HALF = DirectedRod.half_bandwidth
_STEP = 1e-30
_tangents = tangents_kernel(DirectedRod)


@kernel
def _link_blocks(system: Any, y: Any, t: Any, length: Any, blocks: Any) -> None:  # noqa: ARG001
    """Write dq_i / de_{i-1+s} without the joints to blocks[i, s]."""
    blocks[:] = 0.0
    for i in range(t.shape[0]):
        for a in range(3):
            blocks[i, 1, a, a] = -y[8 * i + 3] / system.link


_without_joints = derivative_kernel(DirectedRod, _link_blocks)


@kernel
def transport_derivative(system: Any, x: Any, inverse: Any, j: Any, out: Any) -> None:
    """Write the derivative of the director above a joint by x (10,) to out (3, 10)."""
    cosine, sine = twist_of(system, x, j)
    twist_compliance = system.compliance * system.link if j > 0 else 0.0
    z, transported = np.empty(JOINT, np.complex128), np.empty(3, np.complex128)
    for k in range(JOINT):
        overwrite(z, x)
        z[k] += complex(0.0, _STEP)
        slant = -inverse * inverse * joint_cosine(z).imag
        turn = twist_compliance * z[9].imag
        twist = complex(cosine, -sine * turn), complex(sine, cosine * turn)
        transport(z, complex(inverse, slant), twist, transported)
        for a in range(3):
            out[a, k] = transported[a].imag / _STEP


@kernel
def slopes_derivative(system: Any, x: Any, of_c: Any, j: Any, out: Any) -> None:
    """Write the derivative of `joint_slopes` by x (10,) to out (7, 10)."""
    z, slope_values = np.empty(JOINT, np.complex128), np.empty(7, np.complex128)
    g, slope, inverse = of_c
    curvature = stiffening_curvature(joint_cosine(x))
    for k in range(JOINT):
        overwrite(z, x)
        z[k] += complex(0.0, _STEP)
        step = joint_cosine(z).imag
        stiff = complex(g, slope * step), complex(slope, curvature * step)
        slant = complex(inverse, -inverse * inverse * step)
        joint_slopes(system, z, (*stiff, slant), j, slope_values)
        for a in range(7):
            out[a, k] = slope_values[a].imag / _STEP


@kernel
def eliminate_first_director(by_joint: Any, first: Any, at: Any) -> None:
    """Convert derivatives by the first link's director to those by its tangent at x[at]."""
    for a in range(by_joint.shape[0]):
        for k in range(3):
            for b in range(3):
                by_joint[a, at + k] += by_joint[a, 6 + b] * first[b, 3 + k]
        by_joint[a, 6:9] = 0.0


@kernel
def by_nodes(by_joint: Any, j: Any, director: Any, h: Any, out: Any) -> None:
    """Convert derivatives (k, 10) of joint j to those by the 24 numbers of nodes j - 2 to j.

    `director` is the index, 0 to 2, of the node of the director.
    """
    out[:] = 0.0
    for a in range(by_joint.shape[0]):
        for k in range(3):
            if j > 0:
                out[a, 8 + k] += by_joint[a, k] / h
                out[a, k] -= by_joint[a, k] / h
            out[a, 16 + k] += by_joint[a, 3 + k] / h
            out[a, 8 + k] -= by_joint[a, 3 + k] / h
            out[a, 8 * director + 4 + k] += by_joint[a, 6 + k]
        out[a, 15 if j > 0 else 23] += by_joint[a, 9]


@kernel
def add_row(band: Any, row: Any, j: Any, scale: Any, values: Any) -> None:
    """Add scale * values (24,), the derivatives by nodes j - 2 to j, to a row of the matrix."""
    start = 8 * (j - 2)
    for k in range(24):
        if values[k] != 0.0 and start + k >= 0:
            band[row, _HALF + start + k - row] += scale * values[k]


@kernel
def add_last_load(system: Any, y: Any, t: Any, c: Any, band: Any) -> None:
    """Add the derivative of the last link's load, less that of a load along its tangent."""
    n, h = t.shape[0], system.link
    on_a, on_b, on_t = system.tip[0], system.tip[1], system.tip[2] - 1.0
    for node in range(n - 2, n):
        load = c * (system.outer_force[n - 1] if node == n - 1 else system.inner_force[n - 1])
        at = 8 * (n - 1 - node) + _HALF
        for k in range(3):
            p, q, row = (k + 1) % 3, (k + 2) % 3, 8 * node + k
            by_t = (k, on_t), (p, on_b * y[8 * n - 4 + q]), (q, -on_b * y[8 * n - 4 + p])
            by_a = (k, on_a), (p, -on_b * t[n - 1, q]), (q, on_b * t[n - 1, p])
            for b, value in by_t:
                band[row, at + b - k] += load * value / h
                band[row, at - 8 + b - k] -= load * value / h
            for b, value in by_a:
                band[row, at + 4 + b - k] += load * value


@kernel
def directed_derivative(system: Any, y: Any, w: Any, c: Any, turn: Any, band: Any) -> None:  # noqa: ARG001
    """Write the derivative of the residual to band (n, 2 b + 1), in the lab frame only."""
    n, h = system.joint.shape[0], system.link
    t, length, x, transported = np.empty((n, 3)), np.empty(n), np.empty(JOINT), np.empty(3)
    first, carried, slope_values = np.empty((3, JOINT)), np.empty((3, JOINT)), np.empty((7, JOINT))
    director, by_carried, by_slopes = np.empty(3), np.empty((3, 24)), np.empty((7, 24))
    _tangents(system, y, t, length)
    _without_joints(system, y, w, c, 0.0, band)
    add_last_load(system, y, t, c, band)
    for j in range(n):
        joint_at(y, t, j, x)
        first_director(j, director, x)
        of_c = of_cosine(joint_cosine(x))
        transport(x, of_c[2], twist_of(system, x, j), transported)
        transport_derivative(system, x, of_c[2], j, carried)
        director_above(y, transported, j, x)
        slopes_derivative(system, x, of_c, j, slope_values)
        if j == 0:
            overwrite(director, transported)
            for a in range(3):
                overwrite(first[a], carried[a])
            eliminate_first_director(slope_values, first, 3)
        elif j == 1:
            eliminate_first_director(carried, first, 0)
        by_nodes(slope_values, j, 1, h, by_slopes)
        for k in range(3):
            for a, node in ((3 + k, j), (k, j - 1)):
                if node >= 0:
                    add_row(band, 8 * node + k, j, c / h, by_slopes[a])
                if node > 0:
                    add_row(band, 8 * (node - 1) + k, j, -c / h, by_slopes[a])
        if j > 0:
            by_nodes(carried, j, 0, h, by_carried)
            for k in range(3):
                band[8 * (j - 1) + 4 + k, _HALF] += 1.0
                add_row(band, 8 * (j - 1) + 4 + k, j, -1.0, by_carried[k])
            add_row(band, 8 * j - 1, j, -1.0, by_slopes[6])
            band[8 * j - 1, _HALF] -= 1.0
            band[8 * j - 1, _HALF + 8] += 1.0
    for k in range(3):
        band[8 * n - 4 + k, _HALF] = 1.0
        band[8 * n - 4 + k, _HALF - 8] = -1.0
    band[8 * n - 1, _HALF] = -1.0
