"""The fields that all solved states have.

`exponents` are the growth rates and angular frequencies [1/T] of small disturbances of a state, by
falling real part, without those that belong to its symmetries (a shift in time, a turn about the
axis). The latter are exactly 0 and kept apart as `trivial`: their distance from 0 measures how well
the state was solved for.
"""

import warnings
from abc import ABC, abstractmethod
from dataclasses import asdict
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import numpy as np
import xarray as xr

from undula.analysis.observables.shapes import Range, tip_height, tip_radius
from undula.analysis.record import Fact, Record
from undula.arrays import Array, ComplexArray, Nodes
from undula.models.model import Model


class State(Record, ABC):
    """A state that was solved for.

    Attributes
    ----------
    kind : {"spinning", "flapping", "equilibrium", "periodic"}
        Name of the kind of state.
    steady : bool
        True if the shape is constant, so that all ranges have equal ends.
    model : Model
    unknowns : ndarray of shape (n,), or (m, n)
        Positions and multipliers of a constant shape, or at m equally spaced instants of a period.
    period : float
        Time of a cycle [T]: a turn, a beat, or a repetition of the shape up to a turn; infinite at
        rest.
    residual : float
        Remainder of the equations at the solution; each kind states its unit.
    exponents : ndarray of shape (k,)
        Growth rates and angular frequencies of disturbances [1/T], by falling real part, without
        the trivial ones.
    error : float or None
        Estimated error of the frequency against the body that the links stand for, of links and
        solver together [cycles per T]; None if it was not asked for.
    """

    kind: ClassVar[str]
    steady: ClassVar[bool] = False
    _figure: ClassVar[str] = "undula.views.records.states:state_figure"

    if TYPE_CHECKING:  # a property here would be taken for the default of a kind's own field

        @property
        def model(self) -> Model:
            """The model at its own parameters."""

        @property
        def unknowns(self) -> Array:
            """Positions and multipliers, (n,) or (m, n)."""

        @property
        def period(self) -> float:
            """Time of a cycle [T]."""

        @property
        def residual(self) -> float:
            """Remainder of the equations at the solution."""

        @property
        def exponents(self) -> ComplexArray:
            """Exponents of disturbances (k,) [1/T]."""

        @property
        def error(self) -> float | None:
            """Estimated error of the frequency [cycles per T]."""

    @property
    def force(self) -> float:
        """Total follower force [B/L^2]."""
        return self.model.load.force

    @property
    @abstractmethod
    def nodes(self) -> Nodes:
        """Positions of the nodes (N + 1, 3), or (m, N + 1, 3) over the period [L]."""

    @property
    @abstractmethod
    def frequency(self) -> float:
        """Cycles per T, 0 at rest."""

    @property
    @abstractmethod
    def solver_error(self) -> float:
        """Estimated error of the frequency on these links [cycles per T]."""

    @cached_property
    @abstractmethod
    def bending_energy(self) -> Range:
        """Bending energy over a period [B/L]."""

    @cached_property
    @abstractmethod
    def tip_radius(self) -> Range:
        """Distance of the tip from the axis over a period [L]."""

    @cached_property
    @abstractmethod
    def tip_height(self) -> Range:
        """Height of the tip above the clamp over a period [L]."""

    @cached_property
    @abstractmethod
    def power_balance_error(self) -> float:
        """Difference of active power and dissipation over a period, relative to the former."""

    @property
    def leading_rate(self) -> float:
        """Largest growth rate of a disturbance [1/T]."""
        return float(self.exponents[0].real)

    @property
    def stable(self) -> bool:
        """True if all disturbances decay."""
        return self.leading_rate < 0.0

    def facts(self) -> dict[str, Fact]:
        """Return kind, stability, frequency, energy and extents by name."""
        units = self.model.units
        shared = {
            "kind": Fact(self.kind),
            "stable": Fact(self.stable),
            "force": Fact(self.force, units.force),
            "links": Fact(self.model.links),
            "frequency": Fact(self.frequency, "cycles per T", self.error),
            "leading_rate": Fact(self.leading_rate, "1/T"),
        }
        extents = {
            "bending_energy": (self.bending_energy, units.energy),
            "tip_radius": (self.tip_radius, "L"),
            "tip_height": (self.tip_height, "L"),
        }
        for name, (own, unit) in extents.items():
            parts = {"": own.mean} if self.steady else {f"_{k}": v for k, v in asdict(own).items()}
            shared |= {f"{name}{part}": Fact(value, unit) for part, value in parts.items()}
        return shared

    def to_xarray(self) -> xr.Dataset:
        """Return the facts, and the nodes of the shape, or over the period, as a dataset."""
        dims = ("node", "axis") if self.steady else ("instant", "node", "axis")
        nodes = xr.Variable(dims, self.nodes, {"units": "L"})
        return super().to_xarray().assign(nodes=nodes).assign_coords(axis=["x", "y", "z"])

    @property
    def _accuracy(self) -> str:
        """The number of links and how exactly the state is solved on them, or its whole error."""
        if self.error is not None:
            return f"± {self.error:.1g}"
        return f"({self.model.links} links, solved to {self.solver_error:.1g})"

    @property
    def energy(self) -> Range:
        """Former name of `bending_energy`."""
        message = f"{type(self).__name__}.energy is now bending_energy; the old name goes"
        warnings.warn(f"{message} with the next release", DeprecationWarning, stacklevel=2)
        return self.bending_energy


class FixedShape(State):
    """A state whose shape is constant: it turns at a constant rate, or rests."""

    steady: ClassVar[bool] = True

    @property
    def x(self) -> Array:
        """The state of the model, shape (size,)."""
        return self.model.positions(self.unknowns)

    @property
    def nodes(self) -> Nodes:
        """Positions of the nodes (N + 1, 3) [L]."""
        return self.model.nodes(self.x)

    @cached_property
    def bending_energy(self) -> Range:
        """Bending energy [B/L], constant."""
        return _constant(float(self.model.observe(self.unknowns[None, :]).bending_energy[0]))

    @cached_property
    def tip_radius(self) -> Range:
        """Distance of the tip from the axis [L], constant."""
        return _constant(float(tip_radius(self.nodes)))

    @cached_property
    def tip_height(self) -> Range:
        """Height of the tip above the clamp [L], constant."""
        return _constant(float(tip_height(self.nodes)))


def _constant(value: float) -> Range:
    return Range(value, value, value)


def by_falling_real_part(exponents: ComplexArray) -> ComplexArray:
    """Return exponents (k,) in the order of states: by falling real, then imaginary part."""
    return exponents[np.lexsort((-exponents.imag, -exponents.real))]
