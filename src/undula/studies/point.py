"""A point of a study: from its input to its record, a pure function that can run anywhere.

What goes in and what comes out are plain types, so that both travel between processes.
"""

import time
from collections.abc import Mapping, Sequence
from functools import cache
from importlib.metadata import version
from typing import Any

from undula.analysis.integrate import carry_on
from undula.analysis.last_period import last_period
from undula.analysis.record import dataset_of
from undula.analysis.run import Run
from undula.analysis.schedule import Ending
from undula.analysis.simulation import Simulation
from undula.analysis.solved_points import solved_record
from undula.analysis.sweep_points import DONE, FAILED
from undula.arrays import Nodes, State
from undula.errors import InputError
from undula.models.model import Model
from undula.models.starts import from_state, turned
from undula.studies.build import build_model, build_schedule, build_start
from undula.studies.spec import RunInput, parse_input
from undula.studies.store import run_image
from undula.studies.study_columns import LONGEST_TEXT

#: The summary of a run holds these under the same names.
_SAME = (
    *("verdict", "reason", "margin", "frequency", "frequency_error", "rotation_frequency"),
    *("shape_frequency", "planarity", "power_balance_error", "length_error", "time"),
)
_RANGES = {
    "energy": ("bending_energy", ("min", "max", "mean")),
    "tip_radius": ("tip_radius", ("min", "max")),
    "tip_height": ("tip_height", ("min", "max")),
}


@cache
def software() -> str:
    """Return the version of undula that is at work here."""
    return version("undula")


def points(jobs: Sequence[Mapping[str, Any]]) -> tuple[str, list[dict[str, Any]]]:
    """Return the version that is at work, and the record of each job; see `point`."""
    return software(), [point(job) for job in jobs]


def line(jobs: Sequence[Mapping[str, Any]]) -> tuple[str, list[dict[str, Any]]]:
    """Do the same for jobs each of which begins with what the one before has come to."""
    records: list[dict[str, Any]] = []
    nodes: Nodes | None = None
    for job in jobs:
        record = point({**job, "nodes": nodes})
        nodes = record.pop("nodes", nodes)
        records.append(record)
    return software(), records


def point(job: Mapping[str, Any]) -> dict[str, Any]:
    """Return what a point of a study comes to.

    Parameters
    ----------
    job
        ``tables``, the complete input; ``label`` and ``keep`` as in the table ``[study]``; and if
        the run begins with a neighbour's last shape: ``nodes``, its nodes (None for the start of
        the input), and ``kick``, the size [rad] and the seed of a random turn.

    Returns
    -------
    dict
        ``status``, 1 done or 2 failed with a ``reason``; ``seconds`` that it took; and what was
        found, by the names of the variables of a stored study. A neighbour's record holds its last
        ``nodes``, one that keeps its run the ``image`` of its file.
    """
    began = time.perf_counter()
    try:
        record = _solved(job) if job["label"] == "solved" else _run(job)
    except InputError as error:
        record = {"status": FAILED, "reason": str(error)}
    except Exception as error:  # a study of thousands of points outlives any of them
        record = {"status": FAILED, "reason": f"{type(error).__name__}: {error}"}
    told = {"reason": _in_a_line(record["reason"])} if "reason" in record else {}
    return {**record, **told, "seconds": time.perf_counter() - began}


def _in_a_line(text: str) -> str:
    """Return a text in one line, cut off where it is longer than a store keeps."""
    line = " ".join(text.split())
    return line if len(line) <= LONGEST_TEXT else f"{line[: LONGEST_TEXT - 3]}..."


def _solved(job: Mapping[str, Any]) -> dict[str, Any]:
    return {"status": DONE, **solved_record(build_model(parse_input(job["tables"])))}


def _run(job: Mapping[str, Any]) -> dict[str, Any]:
    wanted = parse_input(job["tables"])
    model = build_model(wanted)
    simulation = Simulation.begin(model, _start(job, wanted, model), build_schedule(wanted))
    carry_on(simulation)
    ending = {"ending": simulation.ending.value, "time": simulation.time}
    if simulation.ending is Ending.FAILED:
        return {"status": FAILED, "reason": simulation.cause, **ending}
    run = Run.of(simulation)
    last = {"nodes": run.motion.nodes[-1]} if "kick" in job else {}
    return {"status": DONE, **ending, **_figures(run), **_kept(job["keep"], run, wanted), **last}


def _start(job: Mapping[str, Any], wanted: RunInput, model: Model) -> State:
    nodes = job.get("nodes")
    start = build_start(wanted, model) if nodes is None else from_state(model, nodes)
    kick, seed = job.get("kick", (0.0, 0))
    return start if kick == 0.0 else turned(model, model.nodes(start), kick, seed=seed)


def _figures(run: Run) -> dict[str, Any]:
    """Return the figures of a run that every study keeps."""
    told, found = run.summary(), run.lyapunov
    record = {name: told[name] for name in _SAME}
    for name, (full, bounds) in _RANGES.items():
        record |= {f"{name}_{bound}": told[full][bound] for bound in bounds}
    if found is not None:
        record |= {"lyapunov": found.value, "lyapunov_error": found.error}
    # A figure that a motion does not have is none, not null.
    return {name: value for name, value in record.items() if value is not None}


def _kept(keep: str, run: Run, wanted: RunInput) -> dict[str, Any]:
    """Return what is kept of a run besides its figures."""
    if keep == "period":
        times, shapes = last_period(run)
        return {"shape_times": times, "shapes": shapes}
    if keep == "run":
        dataset = dataset_of(run, inputs=wanted.dump(), load=wanted.load_text)
        return {"image": run_image(dataset, run.checkpoint)}
    return {}
