"""The contract between models and everything else: what an analysis may ask of any model.

A state x (size,) holds the positions of the free nodes, node by node, in the coordinates in which
the model moves: x, y, z in space, or x, z for a model that is confined to a plane. Everything is
dimensionless. The constraint forces follow from the state and are not part of it.
"""

from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Any, Protocol, Self

from undula.arrays import Array, Nodes, State
from undula.models.loads.analytic import DensityLoad, Load
from undula.models.units import Units


@dataclass(frozen=True)
class Energetics:
    """Energies and powers of a row of states, each of shape (m,), in the model's units."""

    bending_energy: Array
    stretching_energy: Array
    active_power: Array
    dissipation: Array

    def part(self, chosen: slice) -> Self:
        """Return those of some of the states."""
        values = (getattr(self, field.name)[chosen] for field in fields(self))
        return type(self)(*values)


class Model(Protocol):
    """A model of a clamped filament or chain, frozen."""

    @property
    def size(self) -> int:
        """Number of entries of a state."""

    @property
    def dimension(self) -> int:
        """Coordinates of a node in a state: 3, or 2 if confined to a plane."""

    @property
    def axisymmetric(self) -> bool:
        """Whether no direction across the axis is singled out: all motions can be turned."""

    @property
    def extensible(self) -> bool:
        """Whether links stretch, instead of keeping their length."""

    @property
    def balances(self) -> bool:
        """Whether the equations keep account of all energy: not where twist moments are dropped."""

    @property
    def load(self) -> Load:
        """The follower force."""

    @property
    def links(self) -> int:
        """Number of links that the model is made of."""

    @property
    def units(self) -> Units:
        """Names of the units of its numbers."""

    @property
    def equations(self) -> Any:
        """Equations for solvers of states: `undula.numerics.continuation.problem.Equations`.

        They tell as well, as `turning(y)`, the velocity of a unit rate of turning and its drag.
        """

    @property
    def system(self) -> Any:
        """The equations as the integrator wants them, see `undula.numerics.integration.system`."""

    def unknowns(self, x: State) -> Array:
        """Return the integrator's vector: positions and the multipliers that belong to them."""

    def positions(self, unknowns: Array) -> State:
        """Return the state in the integrator's vector; further axes in front are kept."""

    def joint_angles(self, unknowns: Array) -> Array:
        """Return the angles between neighbouring links (..., links) of integrator's vectors [rad].

        The clamp's axis is before the first. With their signs and full turns if joints wind up.
        """

    @property
    def unwrapped(self) -> bool:
        """Whether joints wind up beyond pi, instead of folding there."""

    @property
    def position_mask(self) -> Array:
        """1 at the positions, 0 at the multipliers of the integrator's vector."""

    def straight(self) -> State:
        """Return the straight state along the axis, an equilibrium."""

    def straight_unknowns(self) -> Array:
        """Return the integrator's vector in the straight state."""

    def rest(self) -> State:
        """Return the state in which nothing is bent: straight, unless the body is curved."""

    def admissible(self, x: State) -> State:
        """Return the state near x that meets the model's constraints to round-off."""

    def rates(self, x: State) -> Array:
        """Return the rates of change of the integrator's vector and of its integrals at x."""

    def moving(self, x: State) -> tuple[Array, Array]:
        """Return the integrator's vector at x and its rates of change, at once."""

    def rhs(self, x: State) -> State:
        """Return dx/dt."""

    def jacobian(self, x: State) -> Array:
        """Return d rhs / dx, shape (size, size), exact."""

    def linearised(self) -> tuple[Array, Array]:
        """Return stiffness and drag (links, links) of small displacements across the axis.

        Displacements y of the nodes in one direction obey drag y' = -stiffness y; the other
        direction, if there is one, obeys the same and does not know of the first.
        """

    @property
    def continuum_load(self) -> DensityLoad | None:
        """The load of the continuous filament that the links stand for; None without one."""

    def with_links(self, links: int) -> Self | None:
        """Return the same body made of another number of links; None if its links are the body."""

    def tangent_distance(self, x: State) -> float:
        """Return how far x is from straight, in the norm in which the integrator measures."""

    def energy(self, x: State) -> float:
        """Return the elastic energy."""

    def power(self, x: State) -> tuple[float, float]:
        """Return the power put in by the load and the power dissipated."""

    def observe(self, unknowns: Array) -> Energetics:
        """Return energies and powers of rows of the integrator's vector, shape (m, n)."""

    def energies(self, unknowns: Array) -> tuple[Array, Array]:
        """Return the energies of bending and of stretching alone, each (m,): this is quick."""

    def nodes(self, x: State) -> Nodes:
        """Return the positions of all nodes in space, base first; axes in front are kept."""

    def from_nodes(self, nodes: Nodes) -> State:
        """Return the state whose nodes these are."""

    def rotate(self, x: State, angle: float) -> State:
        """Return the state turned about the axis; a model without that symmetry refuses."""

    def rotation_generator(self, x: State) -> State:
        """Return the velocity of a unit rate of rotation about the axis; 0 if it is no symmetry."""

    def reflect(self, x: State) -> State:
        """Return the state reflected in a plane through the axis (x to -x)."""

    def with_(self, **changes: Any) -> Self:
        """Return the model with other values of its own fields or of its load's."""


#: A start makes a state for a model.
Start = Callable[[Model], State]
