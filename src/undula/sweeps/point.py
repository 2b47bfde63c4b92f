"""A point of a study: from its input to its record, a pure function that can run anywhere.

What goes in and what comes out are plain types, so that both travel between processes.
"""

import time
import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict
from functools import cache
from importlib.metadata import version
from typing import Any

from undula.analysis.maps.stability_along_force import solved_record, stability_along_force
from undula.analysis.regimes.verdict import UNDECIDED
from undula.analysis.run_settings import Ending
from undula.analysis.runs.dataset import dataset_of
from undula.analysis.runs.integrate import carry_on
from undula.analysis.runs.last_period import last_path, last_period
from undula.analysis.runs.run import Run
from undula.analysis.runs.simulation import Simulation
from undula.arrays import Nodes, State
from undula.errors import InputError
from undula.inputs.build import build_model, build_schedule, build_start
from undula.inputs.input import RunInput, parse_input
from undula.models.initial_states import from_state, turned
from undula.models.model import Model
from undula.schema.sweep_axes import DONE, FAILED
from undula.schema.sweep_variables import LONGEST_TEXT
from undula.storage.run_file import run_image
from undula.storage.unchecked import StoredWarning
from undula.sweeps.sweep import of_dump

#: Seconds that a piece of work should take: much longer than it is on its way.
PIECE_SECONDS = 1.0
#: Of a point that solved states decide these are the run's, and these the state's.
_ERRORS = ("power_balance_error", "length_error")
_SOLVED = (
    *("frequency", "frequency_error", "energy_min", "energy_max", "energy_mean"),
    *("tip_radius_min", "tip_radius_max", "planarity"),
)
#: The figures of a run hold these under the same names.
_SAME = ("frequency", "frequency_error", "rotation_frequency", "shape_frequency", "planarity")
_RANGES = {
    "energy": ("bending_energy", ("min", "max", "mean")),
    "tip_radius": ("tip_radius", ("min", "max")),
    "tip_height": ("tip_height", ("min", "max")),
}


@cache
def software() -> str:
    """Return the version of undula that is at work here."""
    return version("undula")


def points(study: Mapping[str, Any], numbers: Sequence[int]) -> tuple[str, list[dict[str, Any]]]:
    """Return the version that is at work, and the records of the first of some points of a study.

    The study is one that `Study.dump` gave. At least one point is done, and others as long as
    `PIECE_SECONDS` are not over: of points of unknown length, some far longer than the rest, nobody
    has to wait for all.
    """
    records, end = [], time.perf_counter() + PIECE_SECONDS
    with _without_warnings():
        for number in numbers:
            records.append(point(of_dump(study).job(number)))
            if time.perf_counter() > end:
                break
    return software(), records


def line(study: Mapping[str, Any], numbers: Sequence[int]) -> tuple[str, list[dict[str, Any]]]:
    """Do the same for all points of a line: each run begins with what the one before has come to.

    Solved states are those of branches that are followed once along the force.
    """
    jobs = [of_dump(study).job(number) for number in numbers]
    if jobs[0]["label"] == "solved":
        return software(), _solved_line(jobs)
    records: list[dict[str, Any]] = []
    nodes: Nodes | None = None
    with _without_warnings():
        for job in jobs:
            record = point({**job, "nodes": nodes})
            nodes = record.pop("nodes", nodes)
            records.append(record)
    return software(), records


@contextmanager
def _without_warnings() -> Iterator[None]:
    """Say nothing of a start that carries no checksum: whoever hands out the points has said it."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", StoredWarning)
        yield


def point(job: Mapping[str, Any]) -> dict[str, Any]:
    """Return what a point of a study comes to.

    Parameters
    ----------
    job
        ``tables``, the complete input; ``label``, ``keep`` and, if not to keep it, ``undecided``
        as in the table ``[study]``; and if
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


def _solved_line(jobs: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Return the records of jobs that differ in the force only."""
    began = time.perf_counter()
    try:
        models = [build_model(parse_input(job["tables"])) for job in jobs]
        found = stability_along_force(models[0], [model.load.force for model in models])
        records = [{"status": DONE, **record} for record in found]
    except Exception:
        # What fails is to be known by its point.
        return [point(job) for job in jobs]
    seconds = (time.perf_counter() - began) / len(jobs)
    return [{**record, "seconds": seconds} for record in records]


def _run(job: Mapping[str, Any]) -> dict[str, Any]:
    wanted = parse_input(job["tables"])
    model = build_model(wanted)
    simulation = Simulation.begin(model, _start(job, wanted, model), build_schedule(wanted))
    judged = carry_on(simulation)
    ending = {"ending": simulation.ending.value, "time": simulation.time}
    if simulation.ending is Ending.FAILED:
        return {"status": FAILED, "reason": simulation.cause, **ending}
    run = judged or Run.of(simulation)
    last = {"nodes": run.last_shape} if "kick" in job else {}
    figures = _figures(run)
    if job.get("undecided", "keep") == "solve":
        figures = _decided(figures, model)
    return {"status": DONE, **ending, **figures, **_kept(job["keep"], run, wanted), **last}


def _decided(figures: dict[str, Any], model: Model) -> dict[str, Any]:
    """Return the figures of a run, or those of the one stable state where it does not tell."""
    if figures["verdict"] != UNDECIDED:
        return {**figures, "decided_by": "run"}
    solved = solved_record(model)
    stable = [solved["verdict"], *filter(None, solved["also"].split(", "))]
    if solved["verdict"] == UNDECIDED or len(stable) > 1:
        states = "none of the solved states" if len(stable) == 1 else " and ".join(stable)
        told = f"{figures['reason']}; {states} {'is' if len(stable) == 1 else 'are'} stable here"
        return {**figures, "reason": told, "decided_by": "run"}
    rate = f"its disturbances decay at {-solved['margin']:.4g}/T at least"
    told = f"of the solved states this one alone is stable, {rate}; by its run: {figures['reason']}"
    record = {name: figures[name] for name in _ERRORS} | {"verdict": stable[0], "reason": told}
    quantities = {name: solved[name] for name in _SOLVED if solved[name] == solved[name]}
    return {**record, **quantities, "decided_by": "solved states"}


def _start(job: Mapping[str, Any], wanted: RunInput, model: Model) -> State:
    nodes = job.get("nodes")
    start = build_start(wanted, model) if nodes is None else from_state(model, nodes)
    kick, seed = job.get("kick", (0.0, 0))
    return start if kick == 0.0 else turned(model, model.nodes(start), kick, seed=seed)


def _figures(run: Run) -> dict[str, Any]:
    """Return the figures of a run that every study keeps."""
    told, found, verdict = run.figures(), run.lyapunov, run.verdict
    record = {"verdict": verdict.name, "reason": verdict.reason, "margin": verdict.margin}
    record |= {name: told[name] for name in _SAME}
    # Of its health a study asks for no more, which saves the rest.
    record |= asdict(run.errors)
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
        return {"shape_times": times, "shapes": shapes, "path": last_path(run)}
    if keep == "run":
        dataset = dataset_of(run, inputs=wanted.dump(), load=wanted.load_text)
        return {"image": run_image(dataset, run.checkpoint)}
    return {}
