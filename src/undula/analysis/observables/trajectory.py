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
    """Energies and powers at the samples of a simulation.

    The powers need the velocities at every sample, which costs ten times as much as the energies;
    they are computed on first use.

    Attributes
    ----------
    model : Model
    unknowns : ndarray, shape (m, n)
        Unknowns in the lab frame.
    bending_energy, stretching_energy : ndarray, shape (m,)
        Energies [B/L].
    """

    model: Model
    unknowns: Array
    bending_energy: Array
    stretching_energy: Array

    @classmethod
    def of(cls, model: Model, unknowns: Array) -> Self:
        """Return the energies and powers of samples.

        Parameters
        ----------
        model : Model
            Model of the filament or chain.
        unknowns : ndarray, shape (m, n)
            Unknowns in the lab frame.

        Returns
        -------
        Observed
        """
        return cls(model, unknowns, *model.energies(unknowns))

    @cached_property
    def _with_powers(self) -> Energetics:
        return self.model.observe(self.unknowns)

    @property
    def active_power(self) -> Array:
        """Power put in by the load [B/(L T)], shape (m,)."""
        return self._with_powers.active_power

    @property
    def dissipation(self) -> Array:
        """Power dissipated by drag [B/(L T)], shape (m,)."""
        return self._with_powers.dissipation

    def part(self, chosen: slice) -> Self:
        """Return the energies and powers of some of the samples.

        Parameters
        ----------
        chosen : slice
            Indices of the samples.

        Returns
        -------
        Observed
        """
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
        Integral of the rate of rotation about the axis [rad].
    work, loss : ndarray, shape (m,)
        Energy put in by the load and dissipated by drag since the start [B/L].
    energetics : Energetics or Observed
        Energies [B/L] and powers [B/(L T)], each of shape (m,).
    """

    time: Instants
    nodes: Shapes
    rotation_angle: Instants
    work: Instants
    loss: Instants
    energetics: Energetics | Observed

    @classmethod
    def of(cls, model: Model, time: Instants, states: Array) -> Self:
        """Return the trajectory of a model from samples of a simulation.

        Parameters
        ----------
        model : Model
            Model of the filament or chain.
        time : ndarray, shape (m,)
            Equally spaced times [T].
        states : ndarray, shape (m, n + RATES)
            Unknowns at these times, then the integrals: rotation angle, work and loss.

        Returns
        -------
        Motion
        """
        unknowns, integrals = states[:, :-RATES], states[:, -RATES:]
        angle, work, loss = integrals.T
        nodes = _nodes(model, states)
        return cls(time, nodes, angle, work, loss, Observed.of(model, unknowns))

    def late(self, start: float) -> Self:
        """Return the part of the motion from a time on.

        Parameters
        ----------
        start : float
            First time [T]; a sample that precedes it by round-off alone is included.

        Returns
        -------
        Motion
        """
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
    """Return the nodes (m, N + 1, 3) of samples (m, n + RATES)."""
    # The nodes of the vector 1, 2, 3, ... are the indices of their coordinates plus 1, and 0 for
    # coordinates that are fixed at 0: `gather` reads a negative index as 0.
    numbered = np.arange(1.0, states.shape[1] - RATES + 1.0)
    columns = model.nodes(model.positions(numbered)).astype(np.int64) - 1
    nodes = np.empty((len(states), *columns.shape))
    gather(states, columns, nodes)
    return nodes
