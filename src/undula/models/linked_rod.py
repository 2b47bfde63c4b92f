"""Quantities of a linked rod's states; kinds of linked rods differ in their tables only."""

import dataclasses
from abc import ABC, abstractmethod
from functools import cached_property
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from undula.arrays import Array, Nodes, State
from undula.errors import InputError
from undula.models.loads.analytic import DensityLoad
from undula.models.model import Energetics
from undula.models.rod.dae import RodFlow
from undula.models.rod.folded_angles import folded_angles
from undula.models.rod.layout import Layout
from undula.models.rod.linearised import rate_jacobian, transverse_matrices
from undula.models.rod.link_lengths import admissible, straight
from undula.models.rod.tables import DirectedRod, Rod, UnwrappedRod
from undula.models.rod.velocity import observe, rate_of_change
from undula.numerics.integration.system import RATES


class LinkedRod(ABC):
    """A model made of links: implements `undula.models.model.Model` on top of its tables."""

    if TYPE_CHECKING:  # a property here would be taken for the default of a kind's own field

        @property
        def links(self) -> int:
            """Number of links N."""

    @cached_property
    @abstractmethod
    def system(self) -> Rod:
        """The tables, of one of the types `undula.models.rod.tables.RODS`."""

    @property
    def dimension(self) -> int:
        """Coordinates of a node in a state: 3, or 2 if confined to the x-z plane."""
        return int(self.system.dimension)

    @property
    def unwrapped(self) -> bool:
        """True if angles of joints grow beyond pi, False if they fold there."""
        return isinstance(self.system, UnwrappedRod)

    @property
    def axisymmetric(self) -> bool:
        """True if rotations about the axis take motions to motions."""
        return not isinstance(self.system, DirectedRod)

    @property
    def extensible(self) -> bool:
        """True if links stretch, False if they keep their length."""
        return bool(self.system.extensible)

    @property
    def balances(self) -> bool:
        """True if the energy balance holds, which a dropped twist moment violates."""
        return not isinstance(self.system, DirectedRod) or self.system.transmitted != 0.0

    @property
    def size(self) -> int:
        """Number of entries of a state."""
        return self.links * self.dimension

    @cached_property
    def position_mask(self) -> Array:
        """1 at the positions, 0 at the multipliers of the unknowns, shape (n,)."""
        return np.asarray(self.equations.differential, dtype=float)

    @cached_property
    def equations(self) -> RodFlow:
        """Equations for solvers of states."""
        return RodFlow(self.system)

    @property
    def _layout(self) -> Layout:
        return self.equations.layout

    @property
    def _state_layout(self) -> Layout:
        return Layout(self.links, self.dimension, self.dimension)

    def positions(self, unknowns: Array) -> State:
        """Return the states (..., size) in unknowns (..., n)."""
        return self._layout.positions(unknowns)

    def unknowns(self, x: State) -> Array:
        """Return the unknowns (n,) of a state: positions, and the multipliers that belong to it."""
        return self.unknowns_and_rates(x)[0]

    def admissible(self, x: State) -> State:
        """Return the shape of x with the lengths that the model prescribes for its links.

        Rigid links get theirs to round-off. Extensible links get the lengths at which stretching
        and tension balance: any other start would begin with a fast axial relaxation.
        """
        return admissible(self.system, x)

    def rhs(self, x: State) -> State:
        """Return dx/dt, shape (size,) [L/T]."""
        return self.positions(self.rates(x)[:-RATES])

    def rates(self, x: State) -> Array:
        """Return the rates of change (n + 3,) at x of the unknowns and of three integrals."""
        return self.unknowns_and_rates(x)[1]

    def unknowns_and_rates(self, x: State) -> tuple[Array, Array]:
        """Return `unknowns` (n,) and `rates` (n + 3,) of a state at the cost of one of them."""
        unknowns = self._layout.with_multipliers(x)
        velocity = np.zeros(unknowns.size + RATES)
        rate_of_change(self.system, unknowns, velocity)
        return unknowns, velocity

    def jacobian(self, x: State) -> Array:
        """Return d rhs / dx, shape (size, size), exact."""
        y, velocity = self.unknowns_and_rates(x)
        return rate_jacobian(self.equations, y, velocity[:-RATES])

    def linearised(self) -> tuple[Array, Array]:
        """Return stiffness and drag (N, N) of small displacements across the axis.

        Displacements y of the nodes in one direction obey drag y' = -stiffness y.
        """
        return transverse_matrices(self.equations, self.straight_unknowns())

    def displaced(self, along_x: Array, along_y: Array | None = None) -> State:
        """Return the change (size,) of a state at displacements (N,) of its nodes along x and y."""
        return self._state_layout.displaced(along_x, along_y)

    def joint_angles(self, unknowns: Array) -> Array:
        """Return the angles between neighbouring links (..., N) of unknowns (..., n) [rad].

        The first one is between the clamp's axis and the first link. Angles of unwrapped joints
        have signs and full turns; others lie between 0 and pi.
        """
        by_node = self._layout.by_node(unknowns)
        return by_node[..., -1] if self.unwrapped else folded_angles(by_node[..., : self.dimension])

    def tangent_distance(self, x: State) -> float:
        """Return the root mean square difference of the tangents from straight [rad]."""
        away = self._state_layout.by_node(x - self.straight())
        return float(np.linalg.norm(np.diff(away, axis=0, prepend=0.0)) * np.sqrt(self.links))

    def energy(self, x: State) -> float:
        """Return the elastic energy."""
        bending, stretching = self.energies(np.atleast_2d(self.unknowns(x)))
        return float(bending[0] + stretching[0])

    def power(self, x: State) -> tuple[float, float]:
        """Return the power put in by the load and the power dissipated."""
        observed = self.observe(np.atleast_2d(self.unknowns(x)))
        return float(observed.active_power[0]), float(observed.dissipation[0])

    def observe(self, unknowns: Array) -> Energetics:
        """Return energies and powers of unknowns (m, n)."""
        return Energetics(*self._observed(unknowns, 4))

    def energies(self, unknowns: Array) -> tuple[Array, Array]:
        """Return the energies of bending and of stretching of unknowns (m, n), each (m,)."""
        bending, stretching = self._observed(unknowns, 2)
        return bending, stretching

    def _observed(self, unknowns: Array, quantities: int) -> Array:
        out = np.empty((unknowns.shape[0], quantities))
        observe(self.system, np.ascontiguousarray(unknowns), out)
        return np.ascontiguousarray(out.T)

    def straight(self) -> State:
        """Return the straight state along the axis, an equilibrium; extensible links are short.

        Raises
        ------
        InputError
            The load is as large as the stiffness of extensible links.
        """
        return self._straight.copy()

    @cached_property
    def _straight(self) -> State:
        return straight(self.system)

    def straight_unknowns(self) -> Array:
        """Return the unknowns (n,) of the straight state."""
        return self._straight_unknowns.copy()

    @cached_property
    def _straight_unknowns(self) -> Array:
        return self.unknowns(self._straight)

    def rest(self) -> State:
        """Return the state in which nothing is bent: straight without natural curvature."""
        return self.straight()

    def nodes(self, x: State) -> Nodes:
        """Return the nodes (..., N + 1, 3) of states (..., size), base first [L]."""
        return self._state_layout.nodes(np.asarray(x))

    def from_nodes(self, nodes: Nodes) -> State:
        """Return the state with these nodes (N + 1, 3) [L].

        Raises
        ------
        InputError
            The nodes have another shape, or are not finite.
        """
        nodes = np.asarray(nodes, dtype=float)
        if nodes.shape != (self.links + 1, 3) or not np.isfinite(nodes).all():
            raise InputError(
                f"nodes of shape {nodes.shape} are no state of a model of {self.links} links;"
                f" give finite values of shape {(self.links + 1, 3)}"
            )
        return self._state_layout.coordinates(nodes)

    def rotate(self, x: State, angle: float) -> State:
        """Return the state rotated about the axis by an angle [rad].

        Raises
        ------
        InputError
            The model is confined to a plane, or not axisymmetric.
        """
        if self.dimension == 2:
            raise InputError("a confined model stays in its plane: it cannot be rotated")
        if not self.axisymmetric:
            raise InputError(
                "a naturally curved or anisotropic filament is held by the clamp in one direction:"
                " it cannot be rotated"
            )
        return self._state_layout.rotated(x, angle)

    def rotation_generator(self, x: State) -> State:
        """Return the velocity of a unit rate of rotation; 0 without rotational symmetry."""
        if self.dimension == 3 and self.axisymmetric:
            return self._state_layout.rotation_generator(np.asarray(x))
        return np.zeros(self.size)

    def reflect(self, x: State) -> State:
        """Return the state reflected in the plane x = 0 (x to -x)."""
        return self._state_layout.reflected(x)

    @property
    def continuum_load(self) -> DensityLoad | None:
        """The load of the continuous filament that the links stand for; None without one."""
        return None

    def with_links(self, links: int) -> Self | None:  # noqa: ARG002
        """Return the same body made of another number of links; None if its links are the body."""
        return None

    def with_(self, **changes: Any) -> Self:
        """Return the model with other values of its own fields or of its load's, such as force.

        Raises
        ------
        InputError
            Neither has such a field, or a value is out of its range.
        """
        model: Any = self
        fields = {field.name for field in dataclasses.fields(model)}
        own = {name: value for name, value in changes.items() if name in fields}
        others = {name: value for name, value in changes.items() if name not in fields}
        load = own.get("load", model.load)
        unknown = others.keys() - {field.name for field in dataclasses.fields(load) if field.init}
        if unknown:
            raise InputError(
                f"neither {type(self).__name__} nor {type(load).__name__} has"
                f" {', '.join(sorted(unknown))}; their fields can be changed, such as force"
            )
        if others:
            own["load"] = dataclasses.replace(load, **others)
        changed: Self = dataclasses.replace(model, **own)
        return changed
