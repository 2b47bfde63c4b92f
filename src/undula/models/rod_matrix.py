"""The matrix of Newton's method for the linked rod (see `undula.models.rod`).

The exact derivative has half-bandwidth 3 m - 1 for m numbers a node. Newton's method on rigid links
does with less: without the slope of g, elastic forces depend on links through multiples of the
identity, so that the half-bandwidth is 2 m and the stiff part does not turn with the filament. The
slope's terms are of relative size psi^2; the iteration makes up for them as long as joints bend
gently. Links that fold need the exact derivative, and so do extensible ones, whose bending and
stretching stiffnesses are of one size.

Coefficients of links, J[k] = d (row i) / de_k for k = i-1 .. i+2, come first; a node p then gets
J[p] - J[p+1]. The band begins with the node at the tip (`gentle_structure`).
"""

import math
from typing import Any

from undula.compiled import entry, kernel
from undula.models.framed_derivative import framed_derivative
from undula.models.joint import stiffening
from undula.models.rod import GENTLE_RODS, RODS, FramedRod, WindingRod
from undula.models.rod_derivative import derivative_kernel, link_blocks_kernel
from undula.models.vectors import vectors
from undula.models.winding_derivative import winding_derivative
from undula.numerics.system import derivative, implements, matrix


def _register_gentle(rod: Any) -> None:
    d, m, half = rod.dimension, rod.stride, rod.half_bandwidth
    read, _, plus, minus, times, dot, axis = vectors(d)
    width = 2 * half + 1

    @kernel
    def bending(system: Any, t: Any, u: Any, i: Any) -> Any:
        """Return K g / h^2 of the joint from t to u, at the foot of link i."""
        step = minus(u, t)
        stiffness = system.joint[i] * stiffening(1.0 - 0.5 * dot(step, step))
        return stiffness / (system.link * system.link)

    @implements(matrix, rod)
    def rod_matrix(system: Any, y: Any, w: Any, c: Any, turn: Any, band: Any) -> None:
        n, per_link = system.joint.shape[0], 1.0 / system.link
        # Links i, i + 1, i + 2 have tangents t, u, v, the joints at their feet bend, next_bend, ...
        node = read(y, m * min(1, n - 1))
        t, u = times(per_link, read(y, 0)), times(per_link, minus(node, read(y, 0)))
        bend, next_bend = bending(system, axis, t, 0), 0.0
        if n > 1:
            next_bend = bending(system, t, u, 1)
        for i in range(n):
            k, last = m * i, i + 1 == n
            v, last_bend = u, 0.0
            if i + 2 < n:
                next_node = read(y, k + 2 * m)
                v = times(per_link, minus(next_node, node))
                last_bend = bending(system, u, v, i + 2)
                node = next_node
            s = t if last else plus(t, u)
            # d(R_i w_i) / de = across + alike I for links i and i + 1
            scale = 1.0 / math.sqrt(dot(s, s))
            mean, moved = times(scale, s), read(w, k)
            weight, lagging = system.weight[i], system.weight[i] * system.lag
            along, change = dot(mean, moved), -lagging * scale * per_link
            across = times(change, minus(moved, times(2.0 * along, mean)))
            alike = change * along
            # -c df_i / de_k: multiples of the identity for k = i-1, i, i+1, i+2
            tension, next_tension = y[k + d], 0.0 if last else y[k + m + d]
            foot = 0.0 if last else system.foot[i + 1]
            before, beyond = -c * bend, c * last_bend
            here = c * (bend + 2.0 * next_bend + per_link * (tension + system.head[i]))
            after = -c * (2.0 * next_bend + last_bend + per_link * (next_tension - foot))
            inner, own, outer = before - here - alike, here - after + weight, after - beyond + alike
            if last:
                own += alike
            first = m * (n - 1 - i)
            length_row = first + d
            for row in range(first, first + m):
                for column in range(width):
                    band[row, column] = 0.0
            for a in range(d):
                row, slower = first + a, lagging * mean[a]
                if i > 1:
                    band[row, half + 2 * m] = -before
                if i > 0:
                    band[row, half + m] = inner
                    for b in range(d):
                        band[row, half + m + b - a] -= mean[a] * across[b]
                    band[length_row, half + m + a - d] = -t[a] * per_link
                band[row, half] = own
                for b in range(d):
                    band[row, half + b - a] -= slower * mean[b]
                if d == 3:  # w changes with a node by 1 + turn S
                    band[row, half - a] += turn * ((weight if a == 1 else 0.0) - slower * mean[1])
                    band[row, half + 1 - a] -= turn * (
                        (weight if a == 0 else 0.0) - slower * mean[0]
                    )
                band[row, half + d - a] = c * t[a]
                band[length_row, half + a - d] = t[a] * per_link
                if last:
                    for b in range(d):
                        band[row, half + b - a] += mean[a] * across[b]
                else:
                    band[row, half - m] = outer
                    for b in range(d):
                        band[row, half - m + b - a] += mean[a] * across[b]
                    band[row, half - m + d - a] = -c * u[a]
                if i + 2 < n:
                    band[row, half - 2 * m] = beyond
            t, u, bend, next_bend = u, v, next_bend, last_bend


_OTHERS: dict[Any, Any] = {WindingRod: winding_derivative, FramedRod: framed_derivative}
for _rod in RODS:
    _derivative: Any = _OTHERS.get(_rod) or derivative_kernel(_rod, link_blocks_kernel(_rod))
    implements(derivative, _rod)(_derivative)
    if _rod in GENTLE_RODS:
        _register_gentle(_rod)
    else:
        implements(matrix, _rod)(_derivative)


@entry
def exact_derivative(system: Any, y: Any, w: Any, c: Any, turn: Any, band: Any) -> None:
    """Write the exact derivative of the residual to band (n, 2 b + 1), see `matrix`."""
    derivative(system, y, w, c, turn, band)
