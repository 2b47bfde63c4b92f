"""The matrix of Newton's method for the linked rod (see `undula.models.rod`).

The exact derivative has half-bandwidth 3 m - 1 for m numbers a node. Newton's method on rigid links
does with less: without the slope of g, elastic forces depend on links through multiples of the
identity, so that the half-bandwidth is 2 m and the stiff part does not turn with the filament. The
slope's terms are of relative size psi^2; the iteration makes up for them as long as joints bend
gently. Links that fold need the exact derivative, and so do extensible ones, whose bending and
stretching stiffnesses are of one size.

Coefficients of links, J[k] = d (row i) / de_k for k = i-1 .. i+2, come first; a node p then gets
J[p] - J[p+1].
"""

from typing import Any

import numpy as np

from undula.compiled import entry
from undula.models.framed_derivative import framed_derivative
from undula.models.joint import stiffening
from undula.models.rod import GENTLE_RODS, RODS, FramedRod, WindingRod
from undula.models.rod_derivative import derivative_kernel, drag_block_kernel, link_blocks_kernel
from undula.models.rod_equations import cosine_kernel, tangents_kernel
from undula.models.winding_derivative import winding_derivative
from undula.numerics.system import derivative, implements, matrix


def _register_gentle(rod: Any) -> None:
    d, m, half = rod.dimension, rod.stride, rod.half_bandwidth
    tangents, cosine, drag_block = tangents_kernel(rod), cosine_kernel(d), drag_block_kernel(rod)

    @implements(matrix, rod)
    def rod_matrix(system: Any, y: Any, w: Any, c: Any, turn: Any, band: Any) -> None:
        n, h = system.joint.shape[0], system.link
        t, length, bend = np.empty((n, d)), np.empty(n), np.zeros(n + 2)
        mean, block = np.empty(d), np.empty((d, d))
        tangents(system, y, t, length)
        for i in range(n):
            bend[i] = system.joint[i] * stiffening(cosine(t, i)) / (h * h)
        band[:] = 0.0
        for i in range(n):
            last = i == n - 1
            drag_block(system, t, w, i, mean, block)
            # -c df_i/de_k: multiples of the identity for k = i-1, i, i+1, i+2
            tension, next_tension = y[m * i + d] / h, 0.0 if last else y[m * i + m + d] / h
            foot = 0.0 if last else system.foot[i + 1] / h
            before = -c * bend[i]
            here = c * (bend[i] + 2.0 * bend[i + 1] + tension + system.head[i] / h)
            after = -c * (2.0 * bend[i + 1] + bend[i + 2] + next_tension - foot)
            beyond = c * bend[i + 2]
            for a in range(d):
                row = m * i + a
                if i > 1:
                    band[row, half - 2 * m] = -before
                if i > 0:
                    band[row, half - m] = before - here
                    for b in range(d):
                        band[row, half - m + b - a] -= block[a, b] / h
                band[row, half] = here - after
                for b in range(d):
                    band[row, half + b - a] -= system.weight[i] * system.lag * mean[a] * mean[b]
                    if last:
                        band[row, half + b - a] += block[a, b] / h
                band[row, half] += system.weight[i]
                if not last:
                    band[row, half + m] = after - beyond
                    for b in range(d):
                        band[row, half + m + b - a] += block[a, b] / h
                    band[row, half + m + d - a] = -c * t[i + 1, a]
                if i < n - 2:
                    band[row, half + 2 * m] = beyond
                band[row, half + d - a] = c * t[i, a]
                if d == 3:
                    drag_x = (1.0 if a == 0 else 0.0) - system.lag * mean[a] * mean[0]
                    drag_y = (1.0 if a == 1 else 0.0) - system.lag * mean[a] * mean[1]
                    band[row, half - a] += turn * system.weight[i] * drag_y
                    band[row, half + 1 - a] -= turn * system.weight[i] * drag_x
            for a in range(d):
                band[m * i + d, half + a - d] = t[i, a] / h
                if i > 0:
                    band[m * i + d, half + a - d - m] = -t[i, a] / h


_OTHERS: dict[Any, Any] = {WindingRod: winding_derivative, FramedRod: framed_derivative}
for _rod in RODS:
    _derivative: Any = _OTHERS.get(_rod) or derivative_kernel(_rod, link_blocks_kernel(_rod))
    implements(derivative, _rod)(_derivative.py_func)
    if _rod in GENTLE_RODS:
        _register_gentle(_rod)
    else:
        implements(matrix, _rod)(_derivative.py_func)


@entry
def exact_derivative(system: Any, y: Any, w: Any, c: Any, turn: Any, band: Any) -> None:
    """Write the exact derivative of the residual to band (n, 2 b + 1), see `matrix`."""
    derivative(system, y, w, c, turn, band)
