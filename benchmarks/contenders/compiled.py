"""The same right-hand side compiled with numba, and its exact Jacobian as a band."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numba import njit

from contenders.textbook import HALF_BANDWIDTH, Array, Rod

#: psi / sin psi as a series in sin^2(psi / 2), for small angles.
_SERIES = tuple(
    math.prod((2.0 * k / (2.0 * k + 1.0) for k in range(1, n + 1)), start=1.0) for n in range(14)
)
_SMALL = 0.03
_B = HALF_BANDWIDTH


def kernel(function: Callable[..., Any]) -> Any:
    """Compile a function once for all processes."""
    return njit(cache=True, error_model="numpy", fastmath={"contract", "nsz"})(function)


@kernel
def stiffening(c: float) -> tuple[float, float]:
    """Return g = psi / sin psi and dg/dc at c = cos psi."""
    z = 0.5 * (1.0 - c)
    if z > _SMALL:
        g = math.acos(c) / math.sqrt(1.0 - c * c)
        return g, (c * g - 1.0) / (1.0 - c * c)
    g, slope = _SERIES[13], 0.0
    for k in range(12, -1, -1):
        slope = slope * z + g
        g = g * z + _SERIES[k]
    return g, -0.5 * slope


@kernel
def geometry(x: Array, rod: Rod) -> tuple[Array, Array, Array, Array]:
    """Return tangents (n, 3), lengths (n,), and K g, K dg/dc of the joints (n + 1,)."""
    n = rod.joint.shape[0]
    t, length, bend, slope = np.empty((n, 3)), np.empty(n), np.zeros(n + 1), np.zeros(n + 1)
    for j in range(n):
        square = 0.0
        for a in range(3):
            t[j, a] = x[3 * j + a] - (x[3 * j - 3 + a] if j > 0 else 0.0)
            square += t[j, a] * t[j, a]
        length[j] = math.sqrt(square)
        inverse = 1.0 / length[j]
        for a in range(3):
            t[j, a] *= inverse
        c = t[0, 2]
        if j > 0:
            c = t[j - 1, 0] * t[j, 0] + t[j - 1, 1] * t[j, 1] + t[j - 1, 2] * t[j, 2]
        g, dg = stiffening(min(c, 1.0))
        bend[j], slope[j] = rod.joint[j] * g, rod.joint[j] * dg
    return t, length, bend, slope


@kernel
def pulls(t: Array, bend: Array) -> Array:
    """Return K_j g_j t_{j-1} + K_{j+1} g_{j+1} t_{j+1} (n, 3)."""
    n = t.shape[0]
    pull = np.zeros((n, 3))
    pull[0, 2] = bend[0]
    for j in range(n):
        for a in range(3):
            if j > 0:
                pull[j, a] += bend[j] * t[j - 1, a]
            if j + 1 < n:
                pull[j, a] += bend[j + 1] * t[j + 1, a]
    return pull


@kernel
def forces(t: Array, length: Array, pull: Array, rod: Rod) -> Array:
    """Return the forces on the nodes (n, 3)."""
    n = t.shape[0]
    force = np.zeros((n, 3))
    for j in range(n):
        along = t[j, 0] * pull[j, 0] + t[j, 1] * pull[j, 1] + t[j, 2] * pull[j, 2]
        tension = rod.tensile * (length[j] * n - 1.0)
        inverse = 1.0 / length[j]
        for a in range(3):
            inner = (pull[j, a] - along * t[j, a]) * inverse - tension * t[j, a]
            force[j, a] += inner
            if j > 0:
                force[j - 1, a] -= inner
    for a in range(3):
        force[n - 1, a] -= rod.force * t[n - 1, a]
    return force


@kernel
def rhs(x: Array, rod: Rod) -> Array:
    """Return dx/dt (3 n,), see `contenders.textbook`."""
    n = rod.joint.shape[0]
    t, length, bend, _ = geometry(x, rod)
    force = forces(t, length, pulls(t, bend), rod)
    velocity = np.empty(3 * n)
    for i in range(n):
        product = square = 0.0
        for a in range(3):
            s = t[i, a] + (t[i + 1, a] if i + 1 < n else 0.0)
            product += s * force[i, a]
            square += s * s
        along = (rod.drag_ratio - 1.0) * product / square
        for a in range(3):
            s = t[i, a] + (t[i + 1, a] if i + 1 < n else 0.0)
            velocity[3 * i + a] = (force[i, a] + along * s) / rod.weight[i]
    return velocity


@kernel
def projectors(t: Array, length: Array) -> Array:
    """Return dt_j / de_j = (I - t_j t_j) / l_j (n, 3, 3)."""
    across = np.empty((t.shape[0], 3, 3))
    for j in range(t.shape[0]):
        for a in range(3):
            for b in range(3):
                across[j, a, b] = ((a == b) - t[j, a] * t[j, b]) / length[j]
    return across


@kernel
def hessian(t: Array, length: Array, bend: Array, slope: Array, rod: Rod) -> Array:
    """Return d p_j / d e_k (n, 3, 3, 3) for the links k = j - 1, j, j + 1."""
    n, pull, across = t.shape[0], pulls(t, bend), projectors(t, length)
    out, u, w, base = np.zeros((n, 3, 3, 3)), np.empty(3), np.empty(3), np.array([0.0, 0.0, 1.0])
    for j in range(n):
        along = t[j, 0] * pull[j, 0] + t[j, 1] * pull[j, 1] + t[j, 2] * pull[j, 2]
        tension, inverse = rod.tensile * (length[j] * n - 1.0), 1.0 / length[j]
        before = t[j - 1] if j > 0 else base
        for a in range(3):
            u[a] = w[a] = 0.0
            for b in range(3):
                u[a] += across[j, a, b] * before[b]
                w[a] += across[max(j - 1, 0), a, b] * t[j, b]
        for a in range(3):
            for b in range(3):
                tt = t[j, a] * t[j, b]
                pushed = pull[j, a] * t[j, b] + t[j, a] * pull[j, b] - 2.0 * along * tt
                out[j, 1, a, b] += slope[j] * u[a] * u[b] - rod.tensile * n * tt
                out[j, 1, a, b] -= pushed * inverse * inverse
                out[j, 1, a, b] -= (along * inverse + tension) * across[j, a, b]
                if j > 0:
                    coupled = slope[j] * u[a] * w[b]
                    for c in range(3):
                        coupled += bend[j] * across[j, a, c] * across[j - 1, c, b]
                    out[j, 0, a, b] = out[j - 1, 2, b, a] = coupled
                    out[j - 1, 1, a, b] += slope[j] * w[a] * w[b]
    return out


@kernel
def leaning(m: Array, size: float, force: Array, extra: float, out: Array) -> None:
    """Put d[extra m (m . f)] / ds into `out` (3, 3), s = size m."""
    along = m[0] * force[0] + m[1] * force[1] + m[2] * force[2]
    for a in range(3):
        for b in range(3):
            turned = along * ((a == b) - m[a] * m[b]) + m[a] * (force[b] - along * m[b])
            out[a, b] = extra * turned / size


@kernel
def by_links(i: int, t: Array, across: Array, inner: Array, force: Array, rod: Rod) -> Array:
    """Return d v_i / d e_k (4, 3, 3) for the links k = i - 1 .. i + 2."""
    n, extra = t.shape[0], rod.drag_ratio - 1.0
    out, m, turned, size = np.zeros((4, 3, 3)), np.empty(3), np.empty((3, 3)), 0.0
    for a in range(3):
        m[a] = t[i, a] + (t[i + 1, a] if i + 1 < n else 0.0)
        size += m[a] * m[a]
    size = math.sqrt(size)
    for a in range(3):
        m[a] /= size
    leaning(m, size, force[i], extra, turned)
    for k in range(4):
        j = i + k - 1
        for a in range(3):
            for b in range(3):
                if k < 3:
                    out[k, a, b] += inner[i, k, a, b]
                if k > 0 and i + 1 < n:
                    out[k, a, b] -= inner[i + 1, k - 1, a, b]
                if k == 1 and i == n - 1:
                    out[k, a, b] -= rod.force * across[i, a, b]
        for b in range(3):
            along = m[0] * out[k, 0, b] + m[1] * out[k, 1, b] + m[2] * out[k, 2, b]
            for a in range(3):
                out[k, a, b] += extra * m[a] * along
                if (k == 1 or k == 2) and j < n:
                    for c in range(3):
                        out[k, a, b] += turned[a, c] * across[j, c, b]
                out[k, a, b] /= rod.weight[i]
    return out


@kernel
def band(x: Array, rod: Rod) -> Array:
    """Return the Jacobian d rhs / dx, row i and column j in entry [8 + i - j, j] (17, 3 n)."""
    n = rod.joint.shape[0]
    t, length, bend, slope = geometry(x, rod)
    force, across = forces(t, length, pulls(t, bend), rod), projectors(t, length)
    inner, out = hessian(t, length, bend, slope, rod), np.zeros((2 * _B + 1, 3 * n))
    for i in range(n):
        blocks = by_links(i, t, across, inner, force, rod)
        for k in range(4):
            j = i + k - 1  # the link from node j - 1 to node j
            for a in range(3):
                for b in range(3):
                    if 0 <= j < n:
                        out[_B + 3 * (i - j) + a - b, 3 * j + b] += blocks[k, a, b]
                    if 0 < j < n:
                        out[_B + 3 * (i - j + 1) + a - b, 3 * j - 3 + b] -= blocks[k, a, b]
    return out


@kernel
def fill(banded: Array, dense: Array) -> None:
    """Put a band into a matrix whose entries beyond it are nobody's business."""
    size = dense.shape[0]
    for j in range(size):
        for i in range(max(0, j - _B), min(size, j + _B + 1)):
            dense[i, j] = banded[_B + i - j, j]
