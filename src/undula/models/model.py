"""The contract between models and everything else: all that an analysis uses of a model.

A state x (size,) holds the positions of the free nodes, node by node, in the coordinates in which
the model moves: x, y, z in space, or x, z for a model that is confined to a plane. Everything is
dimensionless. The constraint forces follow from the state and are not part of it. Solvers and the
integrator use a longer vector (n,), of positions and multipliers (`undula.models.equations`).
"""

from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Any, Protocol, Self

from undula.arrays import Array, Nodes, State
from undula.models.equations import ModelEquations, System
from undula.models.loads.analytic import DensityLoad, Load
from undula.models.units import Units


@dataclass(frozen=True)
class Energetics:
    """Energies and powers of m states, in the model's units.

    Attributes
    ----------
    bending_energy, stretching_energy : ndarray of shape (m,)
        Elastic energies.
    active_power : ndarray of shape (m,)
        Power put in by the load.
    dissipation : ndarray of shape (m,)
        Power dissipated by the drag.
    """

    bending_energy: Array
    stretching_energy: Array
    active_power: Array
    dissipation: Array

    def part(self, chosen: slice) -> Self:
        """Return the energies and powers of a slice of the states."""
        values = (getattr(self, field.name)[chosen] for field in fields(self))
        return type(self)(*values)


class Model(Protocol):
    """A model of a clamped body, frozen: a filament, a chain, or several of them.

    Unknowns are vectors (n,) of positions and multipliers in the model's own order. Values are in
    the model's units, with time in T.
    """

    @property
    def size(self) -> int:
        """Number of entries of a state."""

    @property
    def dimension(self) -> int:
        """Coordinates of a node in a state: 3, or 2 if confined to the x-z plane."""

    @property
    def axisymmetric(self) -> bool:
        """True if rotations about the axis take motions to motions."""

    @property
    def extensible(self) -> bool:
        """True if links stretch, False if they keep their length."""

    @property
    def balances(self) -> bool:
        """True if the energy balance holds, which a dropped twist moment violates."""

    @property
    def load(self) -> Load:
        """The follower force."""

    @property
    def links(self) -> int:
        """Number of links of the model, at least 1."""

    @property
    def units(self) -> Units:
        """Names of the units of its numbers."""

    @property
    def equations(self) -> ModelEquations:
        """Equations for solvers of states."""

    @property
    def system(self) -> System:
        """Tables for the integrator."""

    def unknowns(self, x: State) -> Array:
        """Return the unknowns (n,) of a state: positions, and the multipliers that belong to it."""

    def positions(self, unknowns: Array) -> State:
        """Return the states (..., size) in unknowns (..., n)."""

    def joint_angles(self, unknowns: Array) -> Array:
        """Return the angles between neighbouring links (..., links) of unknowns (..., n) [rad].

        The first one is between the clamp's axis and the first link. Angles of unwrapped joints
        have signs and full turns; others lie between 0 and pi.
        """

    @property
    def unwrapped(self) -> bool:
        """True if angles of joints grow beyond pi, False if they fold there."""

    @property
    def position_mask(self) -> Array:
        """1 at the positions, 0 at the multipliers of the unknowns, shape (n,)."""

    def straight(self) -> State:
        """Return the straight state along the axis, an equilibrium.

        Raises
        ------
        InputError
            The load is as large as the stiffness of extensible links.
        """

    def straight_unknowns(self) -> Array:
        """Return the unknowns (n,) of the straight state."""

    def rest(self) -> State:
        """Return the state in which nothing is bent: straight without natural curvature."""

    def admissible(self, x: State) -> State:
        """Return the state near x that meets the model's constraints to round-off."""

    def rates(self, x: State) -> Array:
        """Return the rates of change at x of the unknowns and of three integrals.

        Returns
        -------
        ndarray of shape (n + 3,)
            The last three are the rate of rotation [rad/T], the active power and the dissipation.
        """

    def unknowns_and_rates(self, x: State) -> tuple[Array, Array]:
        """Return `unknowns` (n,) and `rates` (n + 3,) of a state at the cost of one of them."""

    def rhs(self, x: State) -> State:
        """Return dx/dt, shape (size,) [L/T]."""

    def jacobian(self, x: State) -> Array:
        """Return d rhs / dx, shape (size, size), exact."""

    def linearised(self) -> tuple[Array, Array]:
        """Return stiffness and drag of small displacements of the straight state across the axis.

        Displacements y of the nodes in one direction obey drag y' = -stiffness y. Those in the
        other direction obey the same equation, independently.

        Returns
        -------
        tuple of ndarray, each of shape (links, links)

        Raises
        ------
        InputError
            The straight state is not an equilibrium.
        """

    def displaced(self, along_x: Array, along_y: Array | None = None) -> State:
        """Return the change of a state at small displacements across the axis.

        Parameters
        ----------
        along_x : ndarray of shape (links,)
            Displacements of the nodes along x, in the order of `linearised` [L].
        along_y : ndarray of shape (links,), optional
            Displacements along y, for models in space.
        """

    @property
    def continuum_load(self) -> DensityLoad | None:
        """The load of the continuous filament that the links stand for; None without one."""

    def with_links(self, links: int) -> Self | None:
        """Return the same body made of another number of links; None if its links are the body."""

    def tangent_distance(self, x: State) -> float:
        """Return the distance of x from straight, in the integrator's norm of errors."""

    def energy(self, x: State) -> float:
        """Return the elastic energy."""

    def power(self, x: State) -> tuple[float, float]:
        """Return the power put in by the load and the power dissipated."""

    def observe(self, unknowns: Array) -> Energetics:
        """Return energies and powers of unknowns (m, n)."""

    def energies(self, unknowns: Array) -> tuple[Array, Array]:
        """Return the energies of bending and of stretching of unknowns (m, n), each (m,)."""

    def nodes(self, x: State) -> Nodes:
        """Return the nodes (..., links + 1, 3) of states (..., size), base first [L]."""

    def from_nodes(self, nodes: Nodes) -> State:
        """Return the state with these nodes (links + 1, 3) [L].

        Raises
        ------
        InputError
            The nodes have another shape, or are not finite.
        """

    def rotate(self, x: State, angle: float) -> State:
        """Return the state rotated about the axis by an angle [rad].

        Raises
        ------
        InputError
            The model is confined to a plane, or not axisymmetric.
        """

    def rotation_generator(self, x: State) -> State:
        """Return the velocity of a unit rate of rotation; 0 without rotational symmetry."""

    def reflect(self, x: State) -> State:
        """Return the state reflected in the plane x = 0.

        Raises
        ------
        InputError
            The model has no mirror symmetry.
        """

    def with_(self, **changes: Any) -> Self:
        """Return the model with other values of its own fields or of its load's.

        Raises
        ------
        InputError
            Neither has such a field, or a value is out of its range.
        """


#: A start: a function that returns an initial state of a model.
Start = Callable[[Model], State]
