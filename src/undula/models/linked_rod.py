"""What every linked rod can tell about a state; its kinds differ in their tables only."""

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
from undula.models.rod.link_lengths import admissible, straight
from undula.models.rod.tables import DirectedRod, UnwrappedRod
from undula.models.rod.velocity import observe, rate_of_change
from undula.numerics.integration.system import RATES
from undula.numerics.linalg.banded import to_dense


class LinkedRod(ABC):
    """A model made of links: implements `undula.models.model.Model` on top of its tables."""

    if TYPE_CHECKING:  # a property here would be taken for the default of a kind's own field

        @property
        def links(self) -> int:
            """Number of links N."""

    @cached_property
    @abstractmethod
    def system(self) -> Any:
        """The tables: one of `undula.models.rod.tables.RODS`."""

    @property
    def dimension(self) -> int:
        """Coordinates of a node in a state: 3, or 2 if confined to a plane."""
        return int(self.system.dimension)

    @property
    def _stride(self) -> int:
        return self.equations.stride

    @property
    def unwrapped(self) -> bool:
        """Whether joints wind up beyond pi, instead of folding there."""
        return isinstance(self.system, UnwrappedRod)

    @property
    def axisymmetric(self) -> bool:
        """Whether no direction across the axis is singled out: all motions can be turned."""
        return not isinstance(self.system, DirectedRod)

    @property
    def extensible(self) -> bool:
        """Whether links stretch, instead of keeping their length."""
        return bool(self.system.extensible)

    @property
    def balances(self) -> bool:
        """Whether the equations keep account of all energy: not where twist moments are dropped."""
        return not isinstance(self.system, DirectedRod) or self.system.transmitted != 0.0

    @property
    def size(self) -> int:
        """Number of entries of a state."""
        return self.links * self.dimension

    @cached_property
    def position_mask(self) -> Array:
        """1 at the positions, 0 at the multipliers of the integrator's vector."""
        return np.asarray(self.equations.differential, dtype=float)

    @cached_property
    def equations(self) -> RodFlow:
        """Equations for solvers of states: see `undula.numerics.continuation.problem`."""
        return RodFlow(self.system)

    def positions(self, unknowns: Array) -> State:
        """Return the state in the integrator's vector; further axes in front are kept."""
        by_node = unknowns.reshape(*unknowns.shape[:-1], self.links, self._stride)
        return by_node[..., : self.dimension].reshape(*unknowns.shape[:-1], self.size)

    def unknowns(self, x: State) -> Array:
        """Return the integrator's vector: positions and the multipliers that belong to them."""
        return self.moving(x)[0]

    def admissible(self, x: State) -> State:
        """Return the shape of x with the lengths that its links have to have.

        Rigid links get theirs to round-off; extensible ones the lengths at which stretching and
        tension balance, as a start from any other would begin with a burst of axial relaxation.
        """
        return admissible(self.system, x)

    def rhs(self, x: State) -> State:
        """Return dx/dt."""
        return self.positions(self.rates(x)[:-RATES])

    def rates(self, x: State) -> Array:
        """Return the rates of change of the integrator's vector and of its integrals at x."""
        return self.moving(x)[1]

    def moving(self, x: State) -> tuple[Array, Array]:
        """Return the integrator's vector at x and its rates of change, at once."""
        y = np.zeros((self.links, self._stride))
        y[:, : self.dimension] = np.asarray(x, dtype=float).reshape(self.links, self.dimension)
        unknowns, velocity = y.ravel(), np.zeros(y.size + RATES)
        rate_of_change(self.system, unknowns, velocity)
        return unknowns, velocity

    def jacobian(self, x: State) -> Array:
        """Return d rhs / dx, shape (size, size), from those of R v = f and of the constraint."""
        y, v = self.moving(x)
        v = v[:-RATES]
        d, m = self.dimension, self._stride
        moving = self.equations.differential
        lengths = np.arange(y.size) % m == d
        change, drag = (to_dense(band) for band in self.equations.parts(y, v, 0.0))
        implicit, right = np.where(moving, drag, change), -change[:, moving]
        if not self.system.extensible:
            implicit[np.ix_(lengths, moving)] = change[np.ix_(lengths, moving)]
            right[lengths] = -self._tangent_change(v, d, m)[:, moving]
        return np.asarray(np.linalg.solve(implicit, right)[moving])

    def _tangent_change(self, v: Array, d: int, m: int) -> Array:
        """Return the derivative of e_i . (v_i - v_{i-1}) / h^2 by positions, at fixed v."""
        change = np.zeros((self.links, self.links * m))
        stretching = np.diff(v.reshape(self.links, m)[:, :d], axis=0, prepend=0.0)
        stretching /= self.system.link**2
        for i in range(self.links):
            change[i, m * i : m * i + d] = stretching[i]
            if i > 0:
                change[i, m * (i - 1) : m * (i - 1) + d] = -stretching[i]
        return change

    def linearised(self) -> tuple[Array, Array]:
        """Return stiffness and drag (N, N): small y across the axis obey drag y' = -stiffness y."""
        y = self.straight_unknowns()
        stiffness, drag = self.equations.parts(y, np.zeros(y.size), 0.0)
        m = self._stride
        # Every m-th row and column belongs to the same direction; none else matters to it.
        across = slice(m - 1, None, m)
        return to_dense(stiffness[::m, across]), to_dense(drag[::m, across])

    def joint_angles(self, unknowns: Array) -> Array:
        """Return the angles between neighbouring links (..., N) [rad], the clamp's axis the first.

        They are the angles in the integrator's vector (..., n), with their signs and full turns, if
        joints wind up, and else between 0 and pi.
        """
        by_node = unknowns.reshape(*unknowns.shape[:-1], self.links, self._stride)
        if self.unwrapped:
            return by_node[..., -1]
        # Coordinate by coordinate: an array for each is much faster than one for all.
        along = [np.diff(by_node[..., a], axis=-1, prepend=0.0) for a in range(self.dimension)]
        length = np.sqrt(sum(part * part for part in along))
        apart, together = np.zeros_like(length), np.zeros_like(length)
        for a, part in enumerate(along):
            outer = part / length
            inner = np.empty_like(outer)
            inner[..., 0] = 1.0 if a == self.dimension - 1 else 0.0  # the clamp
            inner[..., 1:] = outer[..., :-1]
            apart += (outer - inner) ** 2
            together += (outer + inner) ** 2
        return np.asarray(2.0 * np.arctan2(np.sqrt(apart), np.sqrt(together)))

    def tangent_distance(self, x: State) -> float:
        """Return the root mean square difference of the tangents from straight [rad]."""
        away = np.reshape(x - self._straight, (self.links, self.dimension))
        away[1:] -= away[:-1].copy()
        return float(np.sqrt(np.vdot(away, away)) * np.sqrt(self.links))

    def energy(self, x: State) -> float:
        """Return the elastic energy."""
        bending, stretching = self.energies(np.atleast_2d(self.unknowns(x)))
        return float(bending[0] + stretching[0])

    def power(self, x: State) -> tuple[float, float]:
        """Return the power put in by the load and the power dissipated."""
        observed = self.observe(np.atleast_2d(self.unknowns(x)))
        return float(observed.active_power[0]), float(observed.dissipation[0])

    def observe(self, unknowns: Array) -> Energetics:
        """Return energies and powers of the rows of `unknowns` (m, n)."""
        return Energetics(*self._observed(unknowns, 4))

    def energies(self, unknowns: Array) -> tuple[Array, Array]:
        """Return energies of bending and of stretching of the rows of `unknowns` (m, n)."""
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
        """Return the integrator's vector in the straight state."""
        return self._straight_unknowns.copy()

    @cached_property
    def _straight_unknowns(self) -> Array:
        return self.unknowns(self._straight)

    def rest(self) -> State:
        """Return the state in which nothing is bent: straight, unless the body is curved."""
        return self.straight()

    def nodes(self, x: State) -> Nodes:
        """Return the positions of all nodes in space, base first; axes in front are kept."""
        x = np.asarray(x).reshape(*np.shape(x)[:-1], self.links, self.dimension)
        nodes = np.zeros((*x.shape[:-2], self.links + 1, 3))
        nodes[..., 1:, self._axes] = x
        return nodes

    def from_nodes(self, nodes: Nodes) -> State:
        """Return the state whose nodes, of shape (N + 1, 3), these are."""
        nodes = np.asarray(nodes, dtype=float)
        if nodes.shape != (self.links + 1, 3) or not np.isfinite(nodes).all():
            raise InputError(
                f"nodes of shape {nodes.shape} are no state of a model of {self.links} links;"
                f" give finite values of shape {(self.links + 1, 3)}"
            )
        return nodes[1:, self._axes].ravel()

    @property
    def _axes(self) -> slice:
        return slice(None, None, 1 if self.dimension == 3 else 2)

    def rotate(self, x: State, angle: float) -> State:
        """Return the state turned about the axis by an angle [rad]; a confined model refuses."""
        if self.dimension == 2:
            raise InputError("a confined model stays in its plane: it cannot be rotated")
        if not self.axisymmetric:
            raise InputError(
                "a naturally curved or anisotropic filament is held by the clamp in one direction:"
                " it cannot be rotated"
            )
        turned = np.array(x, dtype=float).reshape(self.links, 3)
        cosine, sine = np.cos(angle), np.sin(angle)
        turned[:, :2] = turned[:, :2] @ np.array([[cosine, sine], [-sine, cosine]])
        return turned.ravel()

    def rotation_generator(self, x: State) -> State:
        """Return the velocity of a unit rate of rotation about the axis; 0 if it is no symmetry."""
        velocity = np.zeros((self.links, self.dimension))
        if self.dimension == 3 and self.axisymmetric:
            by_node = np.reshape(x, velocity.shape)
            velocity[:, 0], velocity[:, 1] = -by_node[:, 1], by_node[:, 0]
        return velocity.ravel()

    def reflect(self, x: State) -> State:
        """Return the state reflected in a plane through the axis (x to -x)."""
        reflected = np.array(x, dtype=float).reshape(self.links, self.dimension)
        reflected[:, 0] *= -1.0
        return reflected.ravel()

    @property
    def continuum_load(self) -> DensityLoad | None:
        """The load of the continuous filament that the links stand for; None without one."""
        return None

    def with_links(self, links: int) -> Self | None:  # noqa: ARG002
        """Return the same body made of another number of links; None if its links are the body."""
        return None

    def with_(self, **changes: Any) -> Self:
        """Return the model with other values of its own fields or of its load's, such as force."""
        model: Any = self
        own = {field.name for field in dataclasses.fields(model)}
        mine = {name: value for name, value in changes.items() if name in own}
        rest = {name: value for name, value in changes.items() if name not in own}
        load = mine.get("load", model.load)
        unknown = rest.keys() - {field.name for field in dataclasses.fields(load) if field.init}
        if unknown:
            raise InputError(
                f"neither {type(self).__name__} nor {type(load).__name__} has"
                f" {', '.join(sorted(unknown))}; their fields can be changed, such as force"
            )
        if rest:
            mine["load"] = dataclasses.replace(load, **rest)
        changed: Self = dataclasses.replace(model, **mine)
        return changed
