"""Runs with their input and result file: begun from an input, or resumed from a file."""

import json
import math
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import xarray as xr

from undula.analysis.run_settings import Ending
from undula.analysis.runs.checkpoint import resume
from undula.analysis.runs.simulation import Simulation
from undula.errors import InputError
from undula.inputs.build import build_model, build_schedule, build_start
from undula.inputs.file_names import file_name
from undula.inputs.input import RunInput, parse_input
from undula.storage.run_file import load_checkpoint, load_result

#: Endings after which a resumed run ends where it was to end before.
_STOPPED_EARLY = tuple(
    ending.value for ending in (Ending.RUNNING, Ending.INTERRUPTED, Ending.OUT_OF_TIME)
)


@dataclass(frozen=True)
class RunJob:
    """A simulation with its complete input and the file of its result."""

    wanted: RunInput
    simulation: Simulation
    result: Path


def reads_of(file: Path | None, wanted: RunInput) -> list[Path]:
    """Return the files that an input is read from: its own, and that of its start.

    Raises
    ------
    InputError
        The start names a file with an invalid name.
    """
    named = wanted.start.file
    return [*([] if file is None else [file]), *([] if named is None else [file_name(named)])]


def begin(wanted: RunInput, result: Path) -> RunJob:
    """Return the run of an input, at time 0.

    Raises
    ------
    InputError
        The start is invalid.
    """
    model = build_model(wanted)
    start = build_start(wanted, model)
    simulation = Simulation.begin(model, start, build_schedule(wanted))
    return RunJob(wanted, simulation, result)


def resumed(result: Path, until: float | None) -> RunJob:
    """Return the run of a result file at its last time.

    Parameters
    ----------
    result
        A file written by ``undula run``.
    until
        New end time [T]; None for the end time of a run that was stopped early.

    Raises
    ------
    InputError
        The file cannot be read or resumed, or the run has reached its end.
    """
    # In a file that other software has stored, the checkpoint names what is missing.
    saved, stored = load_checkpoint(result), load_result(result)
    wanted = _stored_input(result, stored)
    _refuse_finished(result, stored, until)
    if until is not None:
        wanted = _until(wanted, until, float(saved["interval"]))
    simulation = resume(build_model(wanted), build_schedule(wanted), saved)
    return RunJob(wanted, simulation, result)


def _stored_input(result: Path, stored: xr.Dataset) -> RunInput:
    """Return the input of a result; refuse one of another version of undula."""
    writer, reader = json.loads(stored.attrs["versions"])["undula"], version("undula")
    if writer != reader:
        raise InputError(
            f"{result} was written by undula {writer} and cannot be resumed by undula {reader};"
            " resume it with the version that wrote it"
        )
    try:
        return parse_input(json.loads(stored.attrs["input"]))
    except InputError as error:
        raise InputError(f"{result} holds no input of undula run: {error}") from error


def _refuse_finished(result: Path, stored: xr.Dataset, until: float | None) -> None:
    """Refuse to resume a run that has failed or reached its end."""
    status = json.loads(stored.attrs["summary"])["status"]
    reached = float(stored["time"][-1])
    if status == Ending.FAILED.value:
        raise InputError(
            f"{result} failed at t = {reached:.6g} and would fail there again; run it anew with"
            " a smaller time.rtol or more segments"
        )
    if until is None and status not in _STOPPED_EARLY:
        raise InputError(
            f"{result} has come to its end ({status} at t = {reached:.6g}); give --until T with a"
            " later time"
        )
    if until is not None and until <= reached * (1.0 + 1e-9):
        raise InputError(
            f"--until {until:g} is not beyond t = {reached:.6g}, which {result} has reached; give"
            " a later time"
        )


def _until(wanted: RunInput, end: float, interval: float) -> RunInput:
    """Return an input with another end time and the sampling interval of the stored run."""
    tables: dict[str, Any] = wanted.dump()
    tables["time"].pop("limit", None)
    tables["time"]["until"] = end
    if math.isfinite(end):
        tables["time"]["samples"] = max(2, math.ceil(end / interval - 1e-9) + 1)
    return parse_input(tables)
