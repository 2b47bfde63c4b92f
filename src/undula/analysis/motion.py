"""A trajectory at equally spaced times: nodes, rotation, energies and powers."""

from dataclasses import dataclass, fields
from typing import Self

from undula.arrays import Array, Instants, Shapes
from undula.models.model import Energetics, Model
from undula.numerics.system import RATES


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
    energetics : Energetics
        Energies and powers, each (m,).
    """

    time: Instants
    nodes: Shapes
    rotation_angle: Instants
    work: Instants
    loss: Instants
    energetics: Energetics

    @classmethod
    def of(cls, model: Model, time: Instants, states: Array) -> Self:
        """Return what rows of a simulation (m, n + RATES) say about the model."""
        unknowns, integrals = states[:, :-RATES], states[:, -RATES:]
        nodes = model.nodes(model.positions(unknowns))
        angle, work, loss = integrals.T
        return cls(time, nodes, angle, work, loss, model.observe(unknowns))

    def late(self, start: float) -> Self:
        """Return the part of the motion from a time on, whatever round-off says about its edge."""
        part = self.time >= start - 1e-9 * abs(start)
        energetics = (getattr(self.energetics, field.name)[part] for field in fields(Energetics))
        return type(self)(
            self.time[part],
            self.nodes[part],
            self.rotation_angle[part],
            self.work[part],
            self.loss[part],
            Energetics(*energetics),
        )
