"""How well a run was computed: the figures that every result carries."""

from dataclasses import dataclass

import numpy as np

from undula.analysis.motion import Motion
from undula.analysis.simulation import Simulation
from undula.arrays import Instants, Shapes
from undula.numerics import memory as names

#: Energy [B/L] that round-off alone puts through: positions to 1e-15 L, under a force of some 1000.
ROUND_OFF = 1e-12


@dataclass(frozen=True)
class Health:
    """Errors and effort of a run.

    Attributes
    ----------
    power_balance_error : float
        Largest |elastic energy gained + dissipated - put in| up to any sample, relative to the
        energy dissipated and put in over the run. Zero for the exact solution, and where no more
        energy went through than round-off makes.
    length_error : float
        Largest relative change of length of a link at any sample; of extensible links, their
        strain.
    smallest_step, largest_step : float
        Of the accepted steps [T].
    steps, rejected, failed : int
        Steps accepted, rejected for their error, and given up because Newton's method failed.
    factorisations, solves : int
        Newton matrices factored, and solves with them.
    frame : str
        The frame in which the run ended, "lab" or "co-rotating".
    frame_changes : int
        How often the frame was changed.
    """

    power_balance_error: float
    length_error: float
    smallest_step: float
    largest_step: float
    steps: int
    rejected: int
    failed: int
    factorisations: int
    solves: int
    frame: str
    frame_changes: int


def health_of(simulation: Simulation, motion: Motion) -> Health:
    """Return the health of a simulation whose samples are `motion`."""
    real, count = simulation.memory.real, simulation.memory.count
    steps = int(count[names.STEPS])
    return Health(
        power_balance_error=power_balance_error(motion),
        length_error=length_error(motion.nodes),
        smallest_step=float(real[names.SMALLEST_STEP]) if steps else 0.0,
        largest_step=float(real[names.LARGEST_STEP]),
        steps=steps,
        rejected=int(count[names.REJECTED]),
        failed=int(count[names.FAILED]),
        factorisations=int(count[names.FACTORISATIONS]),
        solves=int(count[names.SOLVES]),
        frame="co-rotating" if count[names.IN_FRAME] else "lab",
        frame_changes=int(count[names.FRAME_CHANGES]),
    )


def power_balance_error(motion: Motion) -> float:
    """Return the error of the energy balance, relative to the energy that went through."""
    energetics = motion.energetics
    stored: Instants = energetics.bending_energy + energetics.stretching_energy
    imbalance = stored - stored[0] + motion.loss - motion.work
    throughput = float(motion.loss[-1] + abs(motion.work[-1]))
    return float(np.abs(imbalance).max()) / throughput if throughput > ROUND_OFF else 0.0


def length_error(nodes: Shapes) -> float:
    """Return the largest relative deviation of a link's length from 1/N."""
    lengths = np.linalg.norm(np.diff(nodes, axis=1), axis=2)
    return float(np.abs(lengths * lengths.shape[1] - 1.0).max())
