"""Files of results by their kind: what a command reads, and the cure where it cannot use one."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import xarray as xr

from undula.errors import InputError
from undula.storage import run_file
from undula.storage.ramp_file import STEPS, load_ramp
from undula.storage.record_file import RECORD, load_record
from undula.storage.result_kinds import OtherKindError
from undula.views import portrait, ramp_diagram

_RAMP = STEPS.format.split()[0]
_SWEEP = "study"
_RECORD = RECORD.format.split()[0]
#: Kinds of results other than runs, in words.
_NAMES = {_RAMP: "a ramp", _SWEEP: "a study of many runs", _RECORD: "a saved record"}
#: Cures for results of other kinds, by the use that is made of a run.
MOVIE = {
    _RAMP: "which has no movie; undula plot draws it",
    _SWEEP: 'which has no movie; undula plot draws it, and study.keep = "run" keeps its runs, below'
    " runs/",
    _RECORD: "which has no movie; undula plot draws it",
}
RESUME = {
    _RAMP: "which the same undula step continues",
    _SWEEP: "which the same undula sweep continues",
    _RECORD: "which is complete; undula.load reads it in Python",
}


def load_run_for(path: Path, cures: Mapping[str, str]) -> xr.Dataset:
    """Read a stored run; refuse other results with what can be done with them.

    Parameters
    ----------
    path
        The file.
    cures
        `MOVIE` or `RESUME`.

    Raises
    ------
    InputError
        The file is no stored run, or cannot be read.
    """
    try:
        return run_file.load_result(path)
    except OtherKindError as error:
        if error.name not in cures:
            raise
        raise InputError(f"{path} is {_NAMES[error.name]}, {cures[error.name]}") from None


def figure_of(path: Path) -> Any:
    """Return the figure of a stored run, a stored ramp or a saved record.

    Raises
    ------
    InputError
        The file is none of these, cannot be read, or is a record without a figure.
    """
    if path.suffix.lower() == ".json" and path.exists():
        raise InputError(
            f"{path} is an answer in numbers, without shapes; give --plot FILE to the command that"
            " answers with it"
        )
    try:
        return portrait(run_file.load_result(path))
    except OtherKindError as error:
        if error.name == _RECORD:
            return load_record(path).plot()
        if error.name != _RAMP:
            raise
    return ramp_diagram([load_ramp(path)])
