"""The exact derivative of the linked rod's residual, in blocks (see `undula.models.rod.tables`).

With t = e / |e| for extensible links, dt = (I - t t) de / l and dl = t . de; for rigid ones dt = de
/ h and l does not change. The derivative with respect to link k of the force q_i along link i is

    dq_i/dt_{i-1} = H_i / l_i,    dq_i/dt_{i+1} = H_{i+1} / l_i,
    dq_i/dt_i = -(H_i + H_{i+1}) / l_i - T_i,
    H_i = G_i - G'_i d_i d_i,    d_i = t_i - t_{i-1},    G = K g(c),  G' = K dg/dc
    dq_i/dl_i = -(a_{i+1} - a_i) / l_i^2.
"""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from undula.jit.compilation import kernel
from undula.models.rod.joint import stiffening, stiffening_slope
from undula.models.rod.residual import cosine_kernel, mean_tangent_kernel, tangents_kernel
from undula.numerics.integration.matrices import derivative_half_bandwidth


@cache
def drag_block_kernel(rod: Any) -> Callable[..., Any]:
    """Return `drag_block(system, t, w, i, mean, block)`: d (R_i w_i) / dt_i, as for t_{i+1}."""
    d, m = rod.dimension, rod.stride
    mean_tangent = mean_tangent_kernel(d)

    @kernel
    def drag_block(system: Any, t: Any, w: Any, i: Any, mean: Any, block: Any) -> None:
        factor = -system.weight[i] * system.anisotropy * mean_tangent(t, i, mean)
        along = 0.0
        for a in range(d):
            along += mean[a] * w[m * i + a]
        for a in range(d):
            for b in range(d):
                across = w[m * i + b] - 2.0 * along * mean[b]
                block[a, b] = factor * (mean[a] * across + (along if a == b else 0.0))

    return drag_block


@cache
def link_blocks_kernel(rod: Any) -> Callable[..., Any]:
    """Return `link_blocks(system, y, t, l, blocks)`, with blocks[i, s] = dq_i / de_{i-1+s}."""
    d, m, extensible = rod.dimension, rod.stride, rod.extensible
    cosine = cosine_kernel(d)

    @kernel
    def project(t: Any, length: Any, k: Any, block: Any) -> None:
        """Convert d/dt_k to d/de_k, in place."""
        for a in range(d):
            along = 0.0
            for b in range(d):
                along += block[a, b] * t[k, b]
            for b in range(d):
                if extensible:
                    block[a, b] -= along * t[k, b]
                block[a, b] /= length[k]

    @kernel
    def link_blocks(system: Any, y: Any, t: Any, length: Any, blocks: Any) -> None:
        n = t.shape[0]
        clamp = np.zeros(d)
        clamp[d - 1] = 1.0
        blocks[:] = 0.0
        for i in range(n):  # the joint between links i - 1 and i, on the forces of both
            c = cosine(t, i)
            bend, slope = system.joint[i] * stiffening(c), system.joint[i] * stiffening_slope(c)
            previous = t[i - 1] if i > 0 else clamp
            for a in range(d):
                for b in range(d):
                    rate = -slope * (t[i, a] - previous[a]) * (t[i, b] - previous[b])
                    rate += bend if a == b else 0.0
                    blocks[i, 0, a, b] += rate / length[i]
                    blocks[i, 1, a, b] -= rate / length[i]
                    if i > 0:
                        blocks[i - 1, 1, a, b] -= rate / length[i - 1]
                        blocks[i - 1, 2, a, b] += rate / length[i - 1]
        for i in range(n):
            for a in range(d):
                blocks[i, 1, a, a] -= y[m * i + d]
            for s in range(3):
                if 0 <= i - 1 + s < n:
                    project(t, length, i - 1 + s, blocks[i, s])
        if extensible:
            for i in range(n):
                for a in range(d):
                    force = (
                        -system.joint[i]
                        * stiffening(cosine(t, i))
                        * (t[i, a] - (t[i - 1, a] if i > 0 else clamp[a]))
                    )
                    if i + 1 < n:
                        force += (
                            system.joint[i + 1]
                            * stiffening(cosine(t, i + 1))
                            * (t[i + 1, a] - t[i, a])
                        )
                    for b in range(d):
                        blocks[i, 1, a, b] -= force * t[i, b] / (length[i] * length[i])

    return link_blocks


@cache
def derivative_kernel(rod: Any, link_blocks: Callable[..., Any]) -> Callable[..., Any]:
    """Return `derivative(system, y, w, c, turn, band)`, the exact derivative for a kind of rod."""
    d, m, extensible = rod.dimension, rod.stride, rod.extensible
    half = derivative_half_bandwidth(rod)
    tangents, cosine, drag_block = tangents_kernel(rod), cosine_kernel(d), drag_block_kernel(rod)

    @kernel
    def add(band: Any, i: Any, k: Any, n: Any, scale: Any, block: Any) -> None:
        """Add scale * block = d (row i) / de_k, which depends on nodes k and k - 1."""
        if not 0 <= k < n:
            return
        for a in range(d):
            for b in range(d):
                value = scale * block[a, b]
                band[m * i + a, half + m * (k - i) + b - a] += value
                if k > 0:
                    band[m * i + a, half + m * (k - 1 - i) + b - a] -= value

    @kernel
    def tangent_block(t: Any, length: Any, k: Any, block: Any) -> None:
        """Write dt_k / de_k to block (d, d)."""
        for a in range(d):
            for b in range(d):
                block[a, b] = 1.0 / length[k] if a == b else 0.0
                if extensible:
                    block[a, b] -= t[k, a] * t[k, b] / length[k]

    @kernel
    def derivative(system: Any, y: Any, w: Any, c: Any, turn: Any, band: Any) -> None:
        n = system.joint.shape[0]
        t, length, blocks = np.empty((n, d)), np.empty(n), np.empty((n, 3, d, d))
        mean, drag, dt, product = np.empty(d), np.empty((d, d)), np.empty((d, d)), np.empty((d, d))
        tangents(system, y, t, length)
        link_blocks(system, y, t, length, blocks)
        band[:] = 0.0
        for i in range(n):
            drag_block(system, t, w, i, mean, drag)
            for s in range(3):
                add(band, i, i - 1 + s, n, -c, blocks[i, s])
                if i + 1 < n:
                    add(band, i, i + s, n, c, blocks[i + 1, s])
            for k in range(i, min(i + 2, n)):
                tangent_block(t, length, k, dt)
                product[:] = 0.0
                for a in range(d):
                    for b in range(d):
                        for e in range(d):
                            product[a, b] += drag[a, e] * dt[e, b]
                add(band, i, k, n, 1.0, product)
                add(
                    band,
                    i,
                    k,
                    n,
                    c * (system.outer_force[i] if k == i else system.inner_force[k]),
                    dt,
                )
            for a in range(d):
                row = m * i + a
                for b in range(d):
                    weight = system.weight[i] * (
                        (1.0 if a == b else 0.0) - system.anisotropy * mean[a] * mean[b]
                    )
                    band[row, half + b - a] += weight
                    if d == 3 and b < 2:
                        band[row, half + 1 - b - a] += turn * weight * (1.0 if b == 1 else -1.0)
                band[row, half + d - a] += c * t[i, a]
                if i + 1 < n:
                    band[row, half + m + d - a] -= c * t[i + 1, a]
                stretch = t[i, a] / system.link
                band[m * i + d, half + a - d] += stretch
                if i > 0:
                    band[m * i + d, half + a - d - m] -= stretch
            if extensible:
                band[m * i + d, half] -= 1.0 / system.tensile
                shortfall_slope(system, t, length, i, band)

    @kernel
    def shortfall_slope(system: Any, t: Any, length: Any, i: Any, band: Any) -> None:
        """Add the derivative of -S_i / (l_i EA) to the constraint row of link i."""
        n, row, scale = t.shape[0], m * i + d, -1.0 / (length[i] * system.tensile)
        shortfall = 0.0
        clamp = np.zeros(d)
        clamp[d - 1] = 1.0
        for j in range(i, min(i + 2, n)):  # the joints below and above link i
            c = cosine(t, j)
            shortfall += system.joint[j] * stiffening(c) * (1.0 - c)
            slope = system.joint[j] * (stiffening_slope(c) * (1.0 - c) - stiffening(c))
            for a in range(d):
                previous = t[j - 1, a] if j > 0 else clamp[a]
                outer = scale * slope * (previous - c * t[j, a]) / length[j]
                band[row, half + m * (j - i) + a - d] += outer
                if j > 0:
                    band[row, half + m * (j - 1 - i) + a - d] -= outer
                    inner = scale * slope * (t[j, a] - c * previous) / length[j - 1]
                    band[row, half + m * (j - 1 - i) + a - d] += inner
                    if j > 1:
                        band[row, half + m * (j - 2 - i) + a - d] -= inner
        for a in range(d):
            value = -scale * shortfall * t[i, a] / length[i]
            band[row, half + a - d] += value
            if i > 0:
                band[row, half + a - d - m] -= value

    return derivative
