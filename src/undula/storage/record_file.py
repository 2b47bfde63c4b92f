"""Files of records: any result of a question, stored by its fields and read back as it was.

A file is NetCDF-4. Its variables are the record's labelled dataset, for other tools, and the arrays
of its fields; the attribute `record` holds the fields in JSON. Only the classes of `record_types`
are written and made again.
"""

import json
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from undula.analysis.record import Record
from undula.analysis.runs.dataset import dataset_of
from undula.analysis.runs.run import Run
from undula.errors import InputError
from undula.schema.formats import RECORD_FORMAT
from undula.storage.record_fields import decoded, encoded
from undula.storage.result_kinds import Kind
from undula.storage.run_file import read_result, write_result, write_run

RECORD = Kind(RECORD_FORMAT, "the method save of a result, or the option --save of a command")
_PREFIX = "field_"


def save_record(path: Path, record: Record, *, overwrite: bool = False) -> None:
    """Store a record, whole or not at all.

    Parameters
    ----------
    path : path
        Name of the file; missing folders are made.
    record : Record
        The record.
    overwrite : bool
        True to replace an earlier file.

    Raises
    ------
    InputError
        The file exists or cannot be written, or a field cannot be stored.
    """
    _check_name(path, overwrite=overwrite)
    arrays: list[Any] = []
    fields = encoded(record, arrays)
    stored = {f"{_PREFIX}{number}": _variable(number, a) for number, a in enumerate(arrays)}
    dataset = record.to_xarray().assign(stored)
    dataset.attrs |= {"record": json.dumps(fields), "undula_format": RECORD_FORMAT}
    write_result(path, dataset, RECORD, overwrite=overwrite)


def save_run(path: Path, run: Run, *, overwrite: bool = False) -> None:
    """Write a run that was made from Python, from its model and its schedule.

    Parameters
    ----------
    path
        The file, which ends in .nc; missing folders are made.
    run
        The run.
    overwrite
        If true, an existing file is replaced.

    Raises
    ------
    InputError
        As of `write_run`.
    """
    _check_name(path, overwrite=overwrite)
    write_run(path, dataset_of(run), run.checkpoint, overwrite=overwrite)


def _check_name(path: Path, *, overwrite: bool) -> None:
    """Refuse a name that is none of a NetCDF file, or is taken, before anything is made."""
    if path.suffix != ".nc":
        raise InputError(f"{path} has to end in .nc, as the file is NetCDF; give such a name")
    if path.exists() and not overwrite:
        raise InputError(f"{path} exists already; give overwrite=True to replace it")


def load_record(path: Path) -> Record:
    """Read a stored record.

    Raises
    ------
    InputError
        The file is missing, damaged, or holds no record.
    """
    stored = read_result(path, RECORD)
    try:
        fields = json.loads(stored.attrs["record"])
        record = decoded(fields, lambda number: _array(stored, number))
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(
            f"{path} holds no record that this version knows ({error}); save it again"
        ) from error
    if not isinstance(record, Record):
        raise InputError(f"{path} holds no record; give a file that was saved from one")
    return record


def _variable(number: int, values: Any) -> xr.Variable:
    """Return an array as a variable; complex numbers have a last dimension of two parts."""
    parts = values
    dims = [f"{_PREFIX}{number}_{axis}" for axis in range(values.ndim)]
    if np.iscomplexobj(values):
        parts = np.stack([values.real, values.imag], axis=-1)
        dims.append("parts")
    return xr.Variable(dims, parts, {"complex": int(np.iscomplexobj(values))})


def _array(stored: xr.Dataset, number: int) -> Any:
    variable = stored[f"{_PREFIX}{number}"]
    values = variable.values
    if variable.attrs["complex"]:
        return values[..., 0] + 1j * values[..., 1]
    return values
