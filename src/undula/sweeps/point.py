"""Points of a sweep: each turns an input into a record, by a pure function that can run anywhere.

Input and record are plain types, so that both travel between processes.
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
from undula.models.initial_states import from_state
from undula.models.model import Model
from undula.models.perturbation import perturbed
from undula.schema.sweep_axes import DONE, FAILED
from undula.schema.sweep_variables import LONGEST_TEXT
from undula.storage.physical_attributes import with_physical_attributes
from undula.storage.run_file import run_image
from undula.storage.unchecked import StoredWarning
from undula.sweeps.sweep import sweep_from_dump

#: Time that a task should take [s]: much longer than it travels.
TASK_SECONDS = 1.0
#: Quantities of a point decided by solved states: these are the run's, and these the state's.
_ERRORS = ("power_balance_error", "length_error")
_SOLVED = (
    *("frequency", "frequency_error", "energy_min", "energy_max", "energy_mean"),
    *("tip_radius_min", "tip_radius_max", "planarity"),
)
#: Quantities that a run has under the names of the stored variables.
_SAME = ("frequency", "frequency_error", "rotation_frequency", "shape_frequency", "planarity")
_RANGES = {
    "energy": ("bending_energy", ("min", "max", "mean")),
    "tip_radius": ("tip_radius", ("min", "max")),
    "tip_height": ("tip_height", ("min", "max")),
}

Request = Mapping[str, Any]
Record = dict[str, Any]


@cache
def software() -> str:
    """Return the version of undula that runs here."""
    return version("undula")


def point_records(dump: Mapping[str, Any], numbers: Sequence[int]) -> tuple[str, list[Record]]:
    """Compute points of a sweep, one after the other, for about `TASK_SECONDS`.

    At least one point is computed. Points after the time is over are left to other tasks, since
    some points take far longer than the rest.

    Parameters
    ----------
    dump
        The sweep, as `Sweep.dump` returns it.
    numbers
        Numbers of the points.

    Returns
    -------
    str
        Version of undula in this process.
    list of dict
        Records of the first points, as `point_record` returns them.
    """
    records, end = [], time.perf_counter() + TASK_SECONDS
    with _without_warnings():
        for number in numbers:
            records.append(point_record(sweep_from_dump(dump).request(number)))
            if time.perf_counter() > end:
                break
    return software(), records


def row_records(dump: Mapping[str, Any], numbers: Sequence[int]) -> tuple[str, list[Record]]:
    """Compute all points of a row in their order; arguments and result as for `point_records`.

    Each run begins with the last shape of the run before it. Solved states are followed once along
    the force.
    """
    requests = [sweep_from_dump(dump).request(number) for number in numbers]
    if requests[0]["label"] == "solved":
        return software(), _solved_row(requests)
    records: list[Record] = []
    nodes: Nodes | None = None
    with _without_warnings():
        for request in requests:
            record = point_record({**request, "nodes": nodes})
            nodes = record.pop("nodes", nodes)
            records.append(record)
    return software(), records


@contextmanager
def _without_warnings() -> Iterator[None]:
    """Suppress the warning on a start without a checksum, which the driver has given already."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", StoredWarning)
        yield


def point_record(request: Request) -> Record:
    """Return the record of a point.

    Parameters
    ----------
    request
        ``tables``, the complete input; ``label``, ``keep`` and optionally ``undecided`` as in the
        table ``[study]``. For a run that begins with a neighbour's last shape also ``nodes``, its
        nodes (None for the start of the input), and ``kick``, size [rad] and seed of a random turn.

    Returns
    -------
    dict
        ``status``, 1 done or 2 failed with a ``reason``; ``seconds`` of wall time; and the results
        by the names of the variables of a stored sweep. The record of a neighbour holds its last
        ``nodes``, the record of a stored run the ``image`` of its file.
    """
    began = time.perf_counter()
    try:
        record = _solved(request) if request["label"] == "solved" else _run(request)
    except InputError as error:
        record = {"status": FAILED, "reason": str(error)}
    except Exception as error:  # a sweep of thousands of points survives the failure of any
        record = {"status": FAILED, "reason": f"{type(error).__name__}: {error}"}
    if "reason" in record:
        record = {**record, "reason": _in_one_line(record["reason"])}
    return {**record, "seconds": time.perf_counter() - began}


def _in_one_line(text: str) -> str:
    """Return a text in one line, cut off at the longest text that a store keeps."""
    line = " ".join(text.split())
    return line if len(line) <= LONGEST_TEXT else f"{line[: LONGEST_TEXT - 3]}..."


def _solved(request: Request) -> Record:
    return {"status": DONE, **solved_record(build_model(parse_input(request["tables"])))}


def _solved_row(requests: Sequence[Request]) -> list[Record]:
    """Return the records of points that differ in the force only."""
    began = time.perf_counter()
    try:
        models = [build_model(parse_input(request["tables"])) for request in requests]
        solved = stability_along_force(models[0], [model.load.force for model in models])
        records = [{"status": DONE, **record} for record in solved]
    except Exception:
        # Point by point, the failure is recorded where it occurs.
        return [point_record(request) for request in requests]
    seconds = (time.perf_counter() - began) / len(requests)
    return [{**record, "seconds": seconds} for record in records]


def _run(request: Request) -> Record:
    wanted = parse_input(request["tables"])
    model = build_model(wanted)
    simulation = Simulation.begin(model, _start(request, wanted, model), build_schedule(wanted))
    judged = carry_on(simulation)
    ending = {"ending": simulation.ending.value, "time": simulation.time}
    if simulation.ending is Ending.FAILED:
        return {"status": FAILED, "reason": simulation.cause, **ending}
    run = judged or Run.of(simulation)
    last = {"nodes": run.last_shape} if "kick" in request else {}
    figures = _figures(run)
    if request.get("undecided", "keep") == "solve":
        figures = _decided(figures, model)
    return {"status": DONE, **ending, **figures, **_stored(request["keep"], run, wanted), **last}


def _decided(figures: Record, model: Model) -> Record:
    """Return the results of a run; of an undecided one those of the only stable solved state."""
    if figures["verdict"] != UNDECIDED:
        return {**figures, "decided_by": "run"}
    solved = solved_record(model)
    stable = [solved["verdict"], *filter(None, solved["also"].split(", "))]
    if solved["verdict"] == UNDECIDED or len(stable) > 1:
        states = "none of the solved states" if len(stable) == 1 else " and ".join(stable)
        reason = f"{figures['reason']}; {states} {'is' if len(stable) == 1 else 'are'} stable here"
        return {**figures, "reason": reason, "decided_by": "run"}
    rate = f"its disturbances decay at {-solved['margin']:.4g}/T at least"
    reason = (
        f"of the solved states this one alone is stable, {rate}; by its run: {figures['reason']}"
    )
    record = {name: figures[name] for name in _ERRORS} | {"verdict": stable[0], "reason": reason}
    # A number that is not equal to itself is NaN: the solved state does not have it.
    quantities = {name: solved[name] for name in _SOLVED if solved[name] == solved[name]}
    return {**record, **quantities, "decided_by": "solved states"}


def _start(request: Request, wanted: RunInput, model: Model) -> State:
    nodes = request.get("nodes")
    start = build_start(wanted, model) if nodes is None else from_state(model, nodes)
    kick, seed = request.get("kick", (0.0, 0))
    return start if kick == 0.0 else perturbed(model, model.nodes(start), kick, seed=seed)


def _figures(run: Run) -> Record:
    """Return the results of a run that every sweep keeps."""
    figures, exponent, verdict = run.figures(), run.lyapunov, run.verdict
    record = {"verdict": verdict.name, "reason": verdict.reason, "margin": verdict.margin}
    record |= {name: figures[name] for name in _SAME}
    # Other numbers on the accuracy of a run are not computed for a sweep, which saves time.
    record |= asdict(run.errors)
    for name, (full_name, bounds) in _RANGES.items():
        record |= {f"{name}_{bound}": figures[full_name][bound] for bound in bounds}
    if exponent is not None:
        record |= {"lyapunov": exponent.value, "lyapunov_error": exponent.error}
    # A quantity that a motion does not have is left out.
    return {name: value for name, value in record.items() if value is not None}


def _stored(keep: str, run: Run, wanted: RunInput) -> Record:
    """Return the part of a run's motion that is stored."""
    if keep == "period":
        times, shapes = last_period(run)
        return {"shape_times": times, "shapes": shapes, "path": last_path(run)}
    if keep == "run":
        dataset = dataset_of(run, inputs=wanted.dump(), load=wanted.load_text)
        names = run.model.units.names()
        dataset = with_physical_attributes(dataset, wanted.scales, names)
        return {"image": run_image(dataset, run.checkpoint)}
    return {}
