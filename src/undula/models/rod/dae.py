"""The linked rod as a differential-algebraic equation, for solvers of states.

It implements `undula.models.equations.ModelEquations` with the compiled residual and its exact
derivative.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from undula.arrays import Array
from undula.errors import InputError
from undula.jit.borrowed import borrowed
from undula.jit.compilation import entry
from undula.models.rod.layout import Layout
from undula.models.rod.newton_matrix import exact_derivative
from undula.models.rod.sizes import sizes_match
from undula.models.rod.tables import DirectedRod, Rod
from undula.numerics.integration.matrices import derivative_half_bandwidth
from undula.numerics.integration.system import apply_drag, generator, residual


@entry("y (n), w (n), out (n)", where=lambda system, n: sizes_match(borrowed(system), n))
def balance(system: Any, y: Any, w: Any, out: Any) -> None:
    """Write the residual R(x) w - f and the constraints to out (n,)."""
    residual(borrowed(system), borrowed(y), borrowed(w), 1.0, borrowed(out))


@entry("y (n), out (n), dragged (n)", where=lambda system, n: sizes_match(borrowed(system), n))
def turning(system: Any, y: Any, out: Any, dragged: Any) -> None:
    """Write the velocity S x of a unit rate of rotation, and R(x) S x, to out and dragged."""
    generator(system, y, out)
    apply_drag(system, y, out, dragged)


@dataclass(frozen=True)
class RodFlow:
    """The equations of a linked rod in its vector y (n,) of positions and multipliers.

    Attributes
    ----------
    system : Rod
        Its tables.
    """

    system: Rod

    @property
    def half_bandwidth(self) -> int:
        """Half-bandwidth of the matrices."""
        return derivative_half_bandwidth(type(self.system))

    @cached_property
    def layout(self) -> Layout:
        """Places of positions and multipliers in y."""
        rod = self.system
        return Layout(rod.joint.size, int(rod.dimension), int(rod.stride))

    @property
    def differential(self) -> Any:
        """True at positions, False at multipliers, shape (n,)."""
        return self.layout.differential

    @property
    def across(self) -> Any:
        """True at the y coordinates of nodes, which are 0 in the x-z plane, shape (n,)."""
        return self.layout.across

    def residual(self, y: Array, w: Array) -> Array:
        """Return R(x) w - f(x, z) and g(x, z), shape (n,), for velocities w (n,)."""
        out = np.empty(y.size)
        balance(self.system, y, w, out)
        return out

    def parts(self, y: Array, w: Array, turn: float) -> tuple[Array, Array]:
        """Return the bands (n, 2 b + 1) of d residual / dy, plus `turn` R S, and of R."""
        whole = np.empty((y.size, 2 * self.half_bandwidth + 1))
        drag, d = np.empty_like(whole), int(self.system.dimension)
        exact_derivative(self.system, y, w, 1.0, turn, whole)
        exact_derivative(self.system, y, np.zeros(y.size), 0.0, 0.0, drag)
        drag.reshape(-1, self.layout.stride, drag.shape[1])[:, d:] = 0.0
        whole -= drag
        return whole, drag

    def turning(self, y: Array) -> tuple[Array, Array]:
        """Return S x and R(x) S x, each of shape (n,)."""
        out, dragged = np.empty(y.size), np.empty(y.size)
        turning(self.system, y, out, dragged)
        return out, dragged

    def rotated(self, y: Array, angle: float) -> Array:
        """Return a vector (n,) of links in space rotated about the axis by an angle [rad]."""
        return self.layout.rotated(y, angle)

    def from_plane(self, y: Array) -> Array:
        """Return vectors of the same links confined to the x-z plane as vectors (..., n) in space.

        Both kinds have positions and tensions only; the confined links have no unwrapped angles.
        """
        return self.layout.from_plane(y)

    def mirrored(self, y: Array) -> Array:
        """Return vectors reflected in the plane x = 0.

        Unwrapped angles change their sign. The first director, normal to the mirror at the clamp,
        becomes the opposite of its image.

        Parameters
        ----------
        y : ndarray, shape (..., n)
            Vectors of positions and multipliers.

        Returns
        -------
        ndarray, shape (..., n)
            Their reflections.

        Raises
        ------
        InputError
            Natural curvature about the second director breaks the symmetry.
        """
        signs = np.ones(self.layout.stride)
        signs[0] = -1.0
        signs[self.system.dimension + 1 :] = -1.0
        if isinstance(self.system, DirectedRod):
            if self.system.natural[:, 1].any() or self.system.tip[0] != 0.0:
                raise InputError(
                    "a rod that is curved about its second director is no mirror image of itself;"
                    " give it natural curvature about the first one alone"
                )
            signs[self.system.dimension + 1] = 1.0
        return np.asarray(y * np.tile(signs, self.system.joint.size))

    def displacements(self, y: Array) -> Array:
        """Return an orthonormal basis (n, k) of small displacements that keep links rigid.

        Extensible links may be displaced in any way.
        """
        moves, d, m = self.differential, int(self.system.dimension), self.layout.stride
        if self.system.extensible:
            return np.eye(y.size)[:, moves]
        links = np.diff(y.reshape(-1, m)[:, :d], axis=0, prepend=0.0)
        count = links.shape[0]
        across = np.linalg.svd(links[:, None, :])[2][:, 1:, :]
        # The rotation of a link moves all nodes from its outer end on.
        raw = np.zeros((count, m, count, d - 1))
        raw[:, :d] = np.tri(count)[:, None, :, None] * across.transpose(2, 0, 1)
        return np.asarray(np.linalg.qr(raw.reshape(y.size, -1))[0])
