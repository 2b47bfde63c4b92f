"""Reading of every kind of file and folder that undula writes."""

from collections.abc import Callable
from pathlib import Path

import xarray as xr

from undula.analysis.record import Record
from undula.errors import InputError
from undula.storage.format_of import format_of
from undula.storage.ramp_file import STEPS, load_ramp
from undula.storage.record_file import RECORD, load_record
from undula.storage.result_kinds import RUN
from undula.storage.run_file import load_result
from undula.sweeps.layout import FORMAT
from undula.sweeps.store import load_sweep


def load(path: Path | str) -> xr.Dataset | Record:
    """Read a result that a command or the method `save` of a record has stored.

    Parameters
    ----------
    path : path
        A run, a ramp, a saved record (files), or a sweep (a folder).

    Returns
    -------
    xarray.Dataset or Record
        Runs, ramps and sweeps as labelled datasets; records as they were.

    Raises
    ------
    InputError
        The file is missing, damaged, or of another kind.

    Examples
    --------
    >>> import tempfile
    >>> import undula as un
    >>> onset = un.onset(un.Filament(8, un.TipLoad(75.0)))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     onset.save(f"{folder}/onset.nc")
    ...     again = un.load(f"{folder}/onset.nc")
    >>> again.force == onset.force
    True
    """
    path = Path(path)
    kind = format_of(path)
    readers: dict[str, Callable[[Path], xr.Dataset | Record]] = {
        RUN.format: load_result,
        STEPS.format: load_ramp,
        RECORD.format: load_record,
        FORMAT: load_sweep,
    }
    if kind not in readers:
        raise InputError(
            f"{path} is no result of undula; give a file of a run, a ramp or a record, or the"
            " folder of a sweep"
        )
    return readers[kind](path)
