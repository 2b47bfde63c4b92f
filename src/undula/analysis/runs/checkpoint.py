"""Checkpoints: arrays from which a run is resumed exactly."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from undula.analysis.run_settings import Schedule
from undula.analysis.runs.memory_needed import refuse_too_large
from undula.analysis.runs.simulation import Simulation
from undula.arrays import Array
from undula.models.model import Model
from undula.numerics.integration.stepper_state import StepperState

_DETECTOR = ("seen", "paces", "return_times", "return_nodes")


def checkpoint(simulation: Simulation) -> dict[str, Array]:
    """Return the arrays that `resume` needs, copied so that the run may continue.

    Parameters
    ----------
    simulation : Simulation
        Run in progress.

    Returns
    -------
    dict of str to ndarray
    """
    saved: dict[str, Any] = {
        "states": simulation.states,
        "interval": np.float64(simulation.interval),
        # The name is that of the stored format.
        "shown_until": np.float64(simulation.observe_until),
    }
    if simulation.tight_from is not None:
        saved["tight"] = np.array([simulation.tight_from, simulation.schedule.rtol])
    saved |= {f"watch_{name}": array for name, array in simulation.detector.to_arrays().items()}
    for prefix, memory in (("memory", simulation.memory), ("mark", simulation.marks[0])):
        for name, array in memory._asdict().items():
            saved[f"{prefix}_{name}"] = np.array(array)
    return saved


def resume(model: Model, schedule: Schedule, saved: Mapping[str, Array]) -> Simulation:
    """Return the run of a checkpoint, ready to continue to the end of a schedule.

    Parameters
    ----------
    model : Model
        The model of the run.
    schedule : Schedule
        Its end may be later than that of the run.
    saved : mapping of str to ndarray
        From `checkpoint`.

    Returns
    -------
    Simulation

    Raises
    ------
    InputError
        The samples do not fit in memory.
    """
    memory, mark = (
        StepperState(*(np.array(saved[f"{prefix}_{name}"]) for name in StepperState._fields))
        for prefix in ("memory", "mark")
    )
    refuse_too_large(model, schedule)
    since, rtol = saved.get("tight", (None, schedule.rtol))
    schedule = replace(schedule, rtol=float(rtol))
    simulation = Simulation(
        model, schedule, memory, float(saved["interval"]), [np.array(saved["states"])]
    )
    simulation.tight_from = None if since is None else float(since)
    simulation.observe_until = float(saved["shown_until"])
    simulation.marks.appendleft(mark)
    simulation.detector.note_arrays({name: saved[f"watch_{name}"] for name in _DETECTOR})
    return simulation
