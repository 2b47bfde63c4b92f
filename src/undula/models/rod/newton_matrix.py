"""The matrix of Newton's method for the linked rod (see `undula.models.rod.tables`).

The exact derivative has half-bandwidth 3 m - 1 for m numbers a node. For rigid links Newton's
method converges with a simpler matrix: without the slope of g, elastic forces depend on links
through multiples of the identity, so that the half-bandwidth is 2 m and the stiff part does not
rotate with the filament. The neglected terms are of relative size psi^2, and the iteration corrects
them as long as joint angles are small. Links with large joint angles need the exact derivative, and
so do extensible links, whose bending and stretching stiffnesses are of the same order.

Coefficients of links, J[k] = d (row i) / de_k for k = i-1 .. i+2, are computed first; node p then
has J[p] - J[p+1]. The band begins with the node at the tip (`small_angle_structure`).
"""

import math
from collections.abc import Callable
from typing import Any

from undula.jit.borrowed import borrowed
from undula.jit.compilation import entry, kernel
from undula.models.rod.jacobian import derivative_kernel, link_blocks_kernel
from undula.models.rod.joint import stiffening
from undula.models.rod.material_frame_jacobian import directed_derivative
from undula.models.rod.sizes import sizes_match
from undula.models.rod.tables import RODS, SMALL_ANGLE_RODS, DirectedRod, SpatialRod, UnwrappedRod
from undula.models.rod.unwrapped_jacobian import unwrapped_derivative
from undula.models.rod.vectors import vectors
from undula.numerics.integration.matrices import derivative_width
from undula.numerics.integration.system import derivative, implements, matrix, planar_matrix, plane
from undula.numerics.linalg.banded import clear_kernel


def small_angle_kernel(rod: Any, *, planar: bool) -> Callable[..., Any]:
    """Return `write(system, y, w, cosine, sine, c, turn, band)`, the matrix for a kind of rod.

    The planar matrix is that of links in space that lie in the plane whose azimuth has this cosine
    and sine. Of a node's unknowns x, y, z, T, in the orientation of this plane, y is then coupled
    to the y of other nodes only.
    """
    structure = rod.planar_structure if planar else rod.structure
    d, m, half = 2 if planar else rod.dimension, rod.stride, rod.half_bandwidth
    _, _, plus, minus, times, dot, axis = vectors(d)
    clear, zero = clear_kernel(structure), (0.0,) * d
    read_vector, read_spatial = vectors(rod.dimension).read, vectors(3).read
    # Position of coordinate a among a node's unknowns, over a; position of its multiplier.
    coordinate_stride, multiplier_index = m // d, m - 1

    @kernel
    def read(y: Any, k: Any, cosine: Any, sine: Any) -> Any:
        if not planar:
            return read_vector(y, k)
        along, across, up = read_spatial(y, k)
        return cosine * along + sine * across, up

    @kernel
    def bending(system: Any, t: Any, u: Any, i: Any) -> Any:
        """Return K g / h^2 of the joint from t to u, below link i."""
        step = minus(u, t)
        stiffness = system.joint[i] * stiffening(1.0 - 0.5 * dot(step, step))
        return stiffness / (system.link * system.link)

    @kernel
    def drag(weight: Any, reduction: Any, s: Any, a: Any, b: Any) -> Any:
        """Return an entry of R_i."""
        return (weight if a == b else 0.0) - reduction * s[a] * s[b]

    @kernel
    def write(
        system: Any, y: Any, w: Any, cosine: Any, sine: Any, c: Any, turn: Any, band: Any
    ) -> None:
        n, per_link = system.joint.shape[0], 1.0 / system.link
        # Links i, i + 1, i + 2 have tangents t, u, v; the joints below them bend, next_bend, ...
        inmost, node = read(y, 0, cosine, sine), read(y, m * min(1, n - 1), cosine, sine)
        t, u = times(per_link, inmost), times(per_link, minus(node, inmost))
        bend, next_bend = bending(system, axis, t, 0), 0.0
        if n > 1:
            next_bend = bending(system, t, u, 1)
        for i in range(n):
            k, last = m * i, i + 1 == n
            v, last_bend = u, 0.0
            if i + 2 < n:
                next_node = read(y, k + 2 * m, cosine, sine)
                v = times(per_link, minus(next_node, node))
                last_bend = bending(system, u, v, i + 2)
                node = next_node
            s = t if last else plus(t, u)
            # d(R_i w_i) / de = s across + isotropic I for links i and i + 1
            moved, per_square = read(w, k, cosine, sine), 1.0 / dot(s, s)
            weight, along = system.weight[i], dot(s, moved)
            reduction = weight * system.anisotropy * per_square
            change = -reduction * per_link
            across = times(change, minus(moved, times(2.0 * along * per_square, s)))
            isotropic = change * along
            # -c df_i / de_k: multiples of the identity for k = i-1, i, i+1, i+2
            tension, next_tension = (
                y[k + multiplier_index],
                0.0 if last else y[k + m + multiplier_index],
            )
            inner_force = 0.0 if last else system.inner_force[i + 1]
            before, beyond = -c * bend, c * last_bend
            here = c * (bend + 2.0 * next_bend + per_link * (tension + system.outer_force[i]))
            after = -c * (2.0 * next_bend + last_bend + per_link * (next_tension - inner_force))
            inner, own, outer = before - here - isotropic, here - after, after - beyond + isotropic
            # Terms of nodes beyond the ends are zero.
            from_inner = from_outer = across
            from_own = zero
            if i == 0:
                inner, from_inner = 0.0, zero
            if i < 2:
                before = 0.0
            if last:
                own, from_own = own + isotropic, across
                outer, from_outer, next_pull = 0.0, zero, zero
            else:
                next_pull = times(-c, u)
            pull, stretch = times(c, t), times(per_link, t)
            first = m * (n - 1 - i)
            length_row = first + multiplier_index
            clear(band, first)
            band[length_row, half] = 0.0
            for row in range(first, length_row):
                band[row, half + 2 * m] = -before
                band[row, half + m] = inner
                band[row, half] = own + weight
                band[row, half - m] = outer
                band[row, half - 2 * m] = beyond
            for a in range(d):
                p = coordinate_stride * a
                row = first + p
                for b in range(d):
                    entry_column, identity = (
                        half + coordinate_stride * b - p,
                        1.0 if a == b else 0.0,
                    )
                    resistance = drag(weight, reduction, s, a, b)
                    if d == 3 and b == 0:  # w changes with a node by 1 + turn S
                        resistance += turn * drag(weight, reduction, s, a, 1)
                    if d == 3 and b == 1:
                        resistance -= turn * drag(weight, reduction, s, a, 0)
                    band[row, entry_column + m] = identity * inner - s[a] * from_inner[b]
                    band[row, entry_column] = identity * own + resistance + s[a] * from_own[b]
                    band[row, entry_column - m] = identity * outer + s[a] * from_outer[b]
                band[row, half + multiplier_index - p] = pull[a]
                band[row, half - m + multiplier_index - p] = next_pull[a]
                band[length_row, half + p - multiplier_index] = stretch[a]
                band[length_row, half + m + p - multiplier_index] = -stretch[a] if i > 0 else 0.0
            t, u, bend, next_bend = u, v, next_bend, last_bend

    return write


def _register_small_angle(rod: Any) -> None:
    write = small_angle_kernel(rod, planar=False)

    @implements(matrix, rod)
    def rod_matrix(system: Any, y: Any, w: Any, c: Any, turn: Any, band: Any) -> None:
        write(system, y, w, 1.0, 0.0, c, turn, band)


def _register_planar(rod: Any) -> None:
    m, write = rod.stride, small_angle_kernel(rod, planar=True)

    @implements(planar_matrix, rod)
    def rod_planar_matrix(system: Any, y: Any, w: Any, azimuth: Any, c: Any, band: Any) -> None:
        write(system, y, w, math.cos(azimuth), math.sin(azimuth), c, 0.0, band)

    @implements(plane, rod)
    def rod_plane(system: Any, y: Any, w: Any) -> Any:
        # The principal axis of the tangents' components normal to the clamp's axis.
        aligned = skew = inner_a = inner_b = 0.0
        for k in range(0, y.shape[0], m):
            a, b = y[k] - inner_a, y[k + 1] - inner_b
            aligned += (a - b) * (a + b)
            skew += 2.0 * a * b
            inner_a, inner_b = y[k], y[k + 1]
        azimuth = 0.5 * math.atan2(skew, aligned)
        cosine, sine = math.cos(azimuth), math.sin(azimuth)
        off = moving_off = before = moved_before = 0.0
        for k in range(0, y.shape[0], m):
            across = cosine * y[k + 1] - sine * y[k]
            moved_across = cosine * w[k + 1] - sine * w[k]
            off += (across - before) * (across - before)
            moving_off += (moved_across - moved_before) * (moved_across - moved_before)
            before, moved_before = across, moved_across
        return azimuth, math.sqrt(system.joint.shape[0] * max(off, moving_off))


_OWN_DERIVATIVES: dict[Any, Any] = {
    UnwrappedRod: unwrapped_derivative,
    DirectedRod: directed_derivative,
}
for _rod in RODS:
    _derivative: Any = _OWN_DERIVATIVES.get(_rod) or derivative_kernel(
        _rod, link_blocks_kernel(_rod)
    )
    implements(derivative, _rod)(_derivative)
    if _rod in SMALL_ANGLE_RODS:
        _register_small_angle(_rod)
    else:
        implements(matrix, _rod)(_derivative)
_register_planar(SpatialRod)


@entry(
    "y (n), w (n), band (n, d)",
    where=lambda system, n, d: sizes_match(borrowed(system), n) and d == derivative_width(system),
)
def exact_derivative(system: Any, y: Any, w: Any, c: Any, turn: Any, band: Any) -> None:
    """Write the exact derivative of the residual to band (n, 2 b + 1), see `matrix`."""
    derivative(borrowed(system), borrowed(y), borrowed(w), c, turn, borrowed(band))
