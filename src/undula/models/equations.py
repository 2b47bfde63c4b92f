"""The equations of a model, as solvers of states and the integrator use them.

Positions and multipliers form one vector y (n,) in the model's own order: solvers use the masks
and maps of this protocol only. A model may therefore be one rod, several rods, or rods with other
unknowns.
"""

from typing import Any, ClassVar, Protocol

from undula.arrays import Array
from undula.numerics.continuation.problem import Equations


class System(Protocol):
    """Tables of a model for compiled code: a `typing.NamedTuple` of arrays and numbers.

    The equations are generic functions registered for its type, see
    `undula.numerics.integration.system`. Each type registers `residual` and `matrix`, and `rates`
    and `error_norm` unless their defaults hold; a type with a rotation about the axis also
    registers `generator` and `rotate`.
    """

    half_bandwidth: ClassVar[int]


class ModelEquations(Equations, Protocol):
    """Equations R(x) dx/dt = f(x, z), 0 = g(x, z) with the symmetries of a clamped model.

    The axis is z. Models that are not axisymmetric have neither `rotated` nor a `turning` other
    than 0; models confined to the x-z plane have nothing across it and no `from_plane`.
    """

    @property
    def across(self) -> Any:
        """True at the y coordinates of nodes, which are 0 in the x-z plane, shape (n,).

        The same rows of the equations hold the forces across the plane.
        """

    def turning(self, y: Array) -> tuple[Array, Array]:
        """Return the velocity of a unit rate of rotation about the axis, and its drag.

        Parameters
        ----------
        y : ndarray of shape (n,)
            Positions and multipliers.

        Returns
        -------
        tuple of ndarray, each of shape (n,)
            S y and R(x) S y; both are 0 without rotational symmetry.
        """

    def rotated(self, y: Array, angle: float) -> Array:
        """Return a vector rotated about the axis.

        Parameters
        ----------
        y : ndarray of shape (n,)
            Positions and multipliers.
        angle : float
            Angle from x to y [rad].

        Returns
        -------
        ndarray of shape (n,)
            The rotated vector.
        """

    def mirrored(self, y: Array) -> Array:
        """Return vectors (..., n) reflected in the plane x = 0, shape (..., n).

        Raises
        ------
        InputError
            The model has no mirror symmetry.
        """

    def from_plane(self, y: Array) -> Array:
        """Return vectors of the model confined to the x-z plane as vectors of this one in space.

        Parameters
        ----------
        y : ndarray of shape (..., m)
            Vectors of the confined model.

        Returns
        -------
        ndarray of shape (..., n)
            Vectors of this model, in the x-z plane.
        """
