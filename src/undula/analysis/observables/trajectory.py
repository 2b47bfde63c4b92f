"""A trajectory at equally spaced times: nodes, rotation, energies and powers."""

from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np

from undula.analysis.observables.shape_sums import gather
from undula.arrays import Array, Instants, Shapes
from undula.models.model import Energetics, Model
from undula.numerics.integration.system import RATES


@dataclass(frozen=True)
class Observed:
    """Energies and powers of rows of a simulation, each (m,).

    The powers take a solution for the velocities at every sample, which is ten times what the
    energies cost. Few ask for them; so they are computed when somebody does.
    """

    model: Model
    unknowns: Array
    bending_energy: Array
    stretching_energy: Array

    @classmethod
    def of(cls, model: Model, unknowns: Array) -> Self:
        """Return those of unknowns (m, n)."""
        return cls(model, unknowns, *model.energies(unknowns))

    @cached_property
    def _all(self) -> Energetics:
        return self.model.observe(self.unknowns)

    @property
    def active_power(self) -> Array:
        """Rate of work of the load."""
        return self._all.active_power

    @property
    def dissipation(self) -> Array:
        """Rate of work against drag."""
        return self._all.dissipation

    def part(self, chosen: slice) -> Self:
        """Return those of some of the samples."""
        return type(self)(
            self.model,
            self.unknowns[chosen],
            self.bending_energy[chosen],
            self.stretching_energy[chosen],
        )


@dataclass(frozen=True)
class Motion:
    """A trajectory at equally spaced times.

    Attributes
    ----------
    time : ndarray, shape (m,)
        Times [T].
    nodes : ndarray, shape (m, N + 1, 3)
        Positions of all nodes in the lab, base first [L].
    rotation_angle : ndarray, shape (m,)
        Integral of the rate of turning about the axis [rad].
    work, loss : ndarray, shape (m,)
        Energy put in by the load and dissipated by drag since the start [B/L].
    energetics : Energetics or Observed
        Energies and powers, each (m,).
    """

    time: Instants
    nodes: Shapes
    rotation_angle: Instants
    work: Instants
    loss: Instants
    energetics: Energetics | Observed

    @classmethod
    def of(cls, model: Model, time: Instants, states: Array) -> Self:
        """Return what rows of a simulation (m, n + RATES) say about the model."""
        unknowns, integrals = states[:, :-RATES], states[:, -RATES:]
        angle, work, loss = integrals.T
        nodes = _nodes(model, states)
        return cls(time, nodes, angle, work, loss, Observed.of(model, unknowns))

    def late(self, start: float) -> Self:
        """Return the part of the motion from a time on, whatever round-off says about its edge."""
        part = slice(int(np.searchsorted(self.time, start - 1e-9 * abs(start))), None)
        return type(self)(
            self.time[part],
            self.nodes[part],
            self.rotation_angle[part],
            self.work[part],
            self.loss[part],
            self.energetics.part(part),
        )


def _nodes(model: Model, states: Array) -> Shapes:
    """Return the nodes of rows of a simulation (m, n + RATES), at once."""
    # The nodes of a vector that counts tell which unknown each coordinate is; 0 is none.
    counted = np.arange(1.0, states.shape[1] - RATES + 1.0)
    places = model.nodes(model.positions(counted)).astype(np.int64) - 1
    nodes = np.empty((len(states), *places.shape))
    gather(states, places, nodes)
    return nodes
