"""Links with a material frame: joints with natural angles and anisotropic bending stiffness.

Each link has directors a, b = t x a normal to its tangent t. A joint bends without twist: directors
are transported from the link below, t, to the link above, t', by the smallest rotation of t to t',

    P v = v - (t'. v) / (1 + c) (t + t'),    c = t . t',    v . t = 0.

The bend of the joint is the vector g t x t', g = psi / sin psi, with equal components on the
directors of either link. The energy E of the joint is that of their excess over natural angles n:

    u1 = g t . b',   u2 = -g t . a',     w1 = K (u1 - n1),   w2 = beta K (u2 - n2)
    E = [K (u1 - n1)^2 + beta K (u2 - n2)^2] / 2

With V = w1 b' - w2 a' and s = V . t, and directors that follow the tangents without rotation about
them, the derivatives of E by both tangents and by a rotation of a', b' about t' are

    dE/dt = g V + g' s t',   dE/dt' = g' s t - g c V,   e = -g (w1 t . a' + w2 t . b').

The twist moment m of a link balances the torques of the joints: m_j = m_{j-1} + e_j at joint j, and
m = 0 in the last link. It twists its link by h m / C, at half its length. Joints do not twist; they
transmit m by forces that follow from their holonomy: q t x t' / (1 + c) is added to both
derivatives, where q is the moment below the joint, m_{j-1}, and m_0 - e_0 at the clamp. It is the
sum of -e_j / 2 and the mean of the moments of both links; where the moment is dropped
(`transmitted` = 0), it is -e_j / 2. So

    q_j = transmitted m - share e_j:    m = m_{j-1}, share = (1 - transmitted) / 2
                                        m = m_0, share = (1 + transmitted) / 2  at the clamp.

The load of the last link is opposite to the tangent at its point of action, which natural curvature
rotates from the tangent at the middle of the link: `tip` has its components on a, b and t.

The vector y has eight numbers a node, (x, y, z, T, a_x, a_y, a_z, m): tension and twist moment of
the link that ends in the node, and the director above its joint. At the tip it is that of the last
link.

Source: discrete elastic rods, Bergou et al. (2008), for holonomy and twist; docs/theory/curved.md.
"""

import math
from typing import Any

import numpy as np

from undula.jit.compilation import kernel, overwrite
from undula.models.rod.joint import stiffening, stiffening_slope
from undula.models.rod.residual import along_kernel, rates_kernel, tangents_kernel
from undula.models.rod.tables import DirectedRod
from undula.numerics.integration.system import constraint_error, implements, rates, residual

_tangents, _along = tangents_kernel(DirectedRod), along_kernel(DirectedRod)
_along_links = rates_kernel(DirectedRod)

# Numbers of a joint: t, t', the director below or above, and a twist moment.
JOINT = 10


@kernel
def joint_at(y: Any, t: Any, j: Any, x: Any) -> None:
    """Write the joint below link j to x (10,), with the director below it."""
    for k in range(3):
        x[k] = t[j - 1, k] if j > 0 else (1.0 if k == 2 else 0.0)
        x[3 + k] = t[j, k]
        x[6 + k] = y[8 * (j - 2) + 4 + k] if j > 1 else (1.0 if k == 0 else 0.0)
    x[9] = y[8 * max(j - 1, 0) + 7]


@kernel
def joint_cosine(x: Any) -> Any:
    """Return c = t . t' of a joint."""
    return x[0] * x[3] + x[1] * x[4] + x[2] * x[5]


@kernel
def of_cosine(c: Any) -> Any:
    """Return g, dg/dc and 1 / (1 + c)."""
    return stiffening(c), stiffening_slope(c), 1.0 / (1.0 + c)


@kernel
def twist_of(system: Any, x: Any, j: Any) -> Any:
    """Return cosine and sine of the twist of the link below joint j, 1 and 0 at the clamp."""
    twist = system.compliance * system.link * x[9] if j > 0 else 0.0
    return math.cos(twist), math.sin(twist)


@kernel
def transport(x: Any, inverse: Any, twist: Any, transported: Any) -> None:
    """Write the director above a joint to transported (3,), from 1 / (1 + c) and `twist_of`."""
    cosine, sine = twist
    transported[0] = cosine * x[6] + sine * (x[1] * x[8] - x[2] * x[7])
    transported[1] = cosine * x[7] + sine * (x[2] * x[6] - x[0] * x[8])
    transported[2] = cosine * x[8] + sine * (x[0] * x[7] - x[1] * x[6])
    lever = (x[3] * transported[0] + x[4] * transported[1] + x[5] * transported[2]) * inverse
    for k in range(3):
        transported[k] -= lever * (x[k] + x[3 + k])


@kernel
def bends(system: Any, x: Any, g: Any, j: Any) -> Any:
    """Return t . a', t . b', w1 and w2 of a joint, x (10,) with the director above it."""
    along = x[0] * x[6] + x[1] * x[7] + x[2] * x[8]
    across = x[0] * (x[4] * x[8] - x[5] * x[7]) + x[1] * (x[5] * x[6] - x[3] * x[8])
    across += x[2] * (x[3] * x[7] - x[4] * x[6])
    first = system.joint[j] * (g * across - system.natural[j, 0])
    second = system.ratio * system.joint[j] * (-g * along - system.natural[j, 1])
    return along, across, first, second


@kernel
def joint_slopes(system: Any, x: Any, of_c: Any, j: Any, out: Any) -> None:
    """Write the derivatives by t and t', holonomy included, and e to out (7,)."""
    g, slope, inverse = of_c
    along, across, first, second = bends(system, x, g, j)
    turning = -g * (first * along + second * across)
    cosine = joint_cosine(x)
    share = 0.5 * (1.0 - system.transmitted) if j > 0 else 0.5 * (1.0 + system.transmitted)
    holonomy = (system.transmitted * x[9] - share * turning) * inverse
    change = slope * (first * across - second * along)
    for k in range(3):
        p, q = (k + 1) % 3, (k + 2) % 3
        b = x[3 + p] * x[6 + q] - x[3 + q] * x[6 + p]
        couple = g * (first * b - second * x[6 + k])
        passed = holonomy * (x[p] * x[3 + q] - x[q] * x[3 + p])
        out[k] = couple + change * x[3 + k] + passed
        out[3 + k] = change * x[k] - cosine * couple + passed
    out[6] = turning


@kernel
def director_above(y: Any, transported: Any, j: Any, x: Any) -> None:
    """Write the director above joint j to x: that of y, at the clamp the transported director."""
    for k in range(3):
        x[6 + k] = y[8 * (j - 1) + 4 + k] if j > 0 else transported[k]


@kernel
def first_director(j: Any, first: Any, x: Any) -> None:
    """Write the director of the first link, which is not in y, below joint 1."""
    if j == 1:
        overwrite(x[6:9], first)


@kernel
def last_direction(system: Any, y: Any, t: Any, out: Any) -> None:
    """Write the direction opposite to the last link's load to out (3,)."""
    n = t.shape[0]
    for k in range(3):
        p, q = (k + 1) % 3, (k + 2) % 3
        across = t[n - 1, p] * y[8 * n - 4 + q] - t[n - 1, q] * y[8 * n - 4 + p]
        out[k] = system.tip[0] * y[8 * n - 4 + k] + system.tip[1] * across
        out[k] += system.tip[2] * t[n - 1, k]


@implements(rates, DirectedRod)
def directed_rates(system: Any, y: Any, v: Any, out: Any) -> None:
    """Write the rate of rotation, the active power and the dissipation at velocity v to out."""
    n = system.joint.shape[0]
    t, length, last = np.empty((n, 3)), np.empty(n), np.empty(3)
    _along_links(system, y, v, out)
    _tangents(system, y, t, length)
    last_direction(system, y, t, last)
    for k in range(3):
        aside = last[k] - t[n - 1, k]
        out[1] -= system.outer_force[n - 1] * aside * v[8 * n - 8 + k]
        out[1] -= system.inner_force[n - 1] * aside * v[8 * n - 16 + k]


@implements(residual, DirectedRod)
def directed_residual(system: Any, y: Any, w: Any, c: Any, out: Any) -> None:
    """Write R(x) w - c f(x, z) and the constraints to out (n,)."""
    n = system.joint.shape[0]
    t, length, slopes = np.empty((n, 3)), np.empty(n), np.zeros((n, 3))
    x, transported, first, slope_values = np.empty(JOINT), np.empty(3), np.empty(3), np.empty(7)
    _tangents(system, y, t, length)
    for j in range(n):
        joint_at(y, t, j, x)
        first_director(j, first, x)
        of_c = of_cosine(joint_cosine(x))
        transport(x, of_c[2], twist_of(system, x, j), transported)
        director_above(y, transported, j, x)
        joint_slopes(system, x, of_c, j, slope_values)
        for k in range(3):
            slopes[j, k] += slope_values[3 + k]
            if j > 0:
                slopes[j - 1, k] += slope_values[k]
                out[8 * (j - 1) + 4 + k] = x[6 + k] - transported[k]
            else:
                first[k] = transported[k]
        if j > 0:
            out[8 * (j - 1) + 7] = y[8 * j + 7] - slope_values[6] - y[8 * (j - 1) + 7]
    for k in range(3):
        out[8 * n - 4 + k] = y[8 * n - 4 + k] - y[8 * n - 12 + k]
    out[8 * n - 1] = -y[8 * n - 1]
    last_direction(system, y, t, slope_values)
    for i in range(n):
        reduction, square = system.anisotropy * _along(t, w, i), 0.0
        for k in range(3):
            force = -slopes[i, k] / system.link - y[8 * i + 3] * t[i, k]
            push = t[i, k] if i + 1 < n else slope_values[k]
            if i > 0:
                out[8 * (i - 1) + k] += c * (force + system.inner_force[i] * push)
            direction = t[i, k] + (t[i + 1, k] if i + 1 < n else 0.0)
            drag = system.weight[i] * (w[8 * i + k] - reduction * direction)
            out[8 * i + k] = drag - c * (force - system.outer_force[i] * push)
            square += t[i, k] * t[i, k]
        out[8 * i + 3] = 0.5 * (square - 1.0)


@implements(constraint_error, DirectedRod)
def directed_constraint_error(system: Any, y: Any) -> Any:
    """Return the largest violation of the lengths and of the transport of directors at y (n,)."""
    n, largest = system.joint.shape[0], 0.0
    t, length = np.empty((n, 3)), np.empty(n)
    x, transported, first = np.empty(JOINT), np.empty(3), np.empty(3)
    _tangents(system, y, t, length)
    for j in range(n):
        joint_at(y, t, j, x)
        first_director(j, first, x)
        transport(x, 1.0 / (1.0 + joint_cosine(x)), twist_of(system, x, j), transported)
        square = t[j, 0] * t[j, 0] + t[j, 1] * t[j, 1] + t[j, 2] * t[j, 2]
        largest = max(largest, abs(0.5 * (square - 1.0)))
        for k in range(3):
            if j == 0:
                first[k] = transported[k]
            else:
                largest = max(largest, abs(y[8 * (j - 1) + 4 + k] - transported[k]))
    return largest
