"""undula on the same windows: in the lab frame, in the co-rotating frame, and as one calls it."""

from collections.abc import Callable

import numpy as np

import undula as un
from undula.analysis.run_settings import Schedule
from undula.analysis.runs.simulation import Simulation
from undula.arrays import Array
from undula.numerics.integration.system import RATES
from undula.numerics.integration.time_loop import advance

_NEVER = np.iinfo(np.int64).max
Ours = Callable[[un.Filament, Array, Array, float], tuple[Array, Array]]


def stepped(*, turning: bool) -> Ours:
    """Return how the integrator runs in the lab frame, or in the one that turns along.

    What is timed includes the set-up of a run, and no naming, report or record of it.
    """

    def run(model: un.Filament, x: Array, times: Array, rtol: float) -> tuple[Array, Array]:
        begun = Simulation.begin(model, x, Schedule(rtol=rtol))
        memory, options = begun.memory, begun.options._replace(frame=int(turning))
        states = np.empty((times.size, memory.differences.shape[1]))
        sections = np.empty((0, 1 + states.shape[1]))
        advance(model.system, memory, options, times, states, sections, _NEVER)
        return times, model.positions(states[:, :-RATES])

    return run


def called(model: un.Filament, x: Array, times: Array, rtol: float) -> tuple[Array, Array]:
    """Run `undula.integrate` as it comes, with 4000 samples, their energies and their record."""
    run = un.integrate(model, x, until=float(times[-1]), rtol=rtol)
    return run.motion.time, run.motion.nodes[:, 1:].reshape(run.motion.time.size, -1)
