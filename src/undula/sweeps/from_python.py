"""Sweeps from Python, as `undula sweep` makes them."""

import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import xarray as xr

from undula.errors import InputError
from undula.sweeps.compute import compute
from undula.sweeps.own_workers import workers_that_fit
from undula.sweeps.store import load_sweep, open_sweep
from undula.sweeps.sweep import read_sweep, sweep_from_tables
from undula.sweeps.work_queue import SweepWork


def sweep(
    tables: Mapping[str, Any] | Path | str,
    store: Path | str,
    *,
    workers: int | None = None,
    retry_failed: bool = False,
    budget: float = float("inf"),
) -> xr.Dataset:
    """Compute the points of a sweep that are missing in its store.

    The same call goes on with a sweep that was interrupted, as the command does. Worker processes
    import the main module of a script: call it below ``if __name__ == "__main__":`` there.

    Parameters
    ----------
    tables : mapping or path
        The tables of the input by name, as in a TOML file, with a table ``study``; or such a file.
    store : path
        Folder of the store, ending in .zarr.
    workers : int, optional
        Number of processes, at least 1; by default one on each processor.
    retry_failed : bool
        True to compute failed points again.
    budget : float
        Largest elapsed time [s].

    Returns
    -------
    xarray.Dataset
        The store, as `undula.load_sweep` reads it; its attribute ``ending`` is "done",
        "interrupted", "out of time" or "no workers".

    Raises
    ------
    InputError
        The input is wrong, or the folder holds something else or cannot be written.

    Examples
    --------
    >>> import undula as un
    >>> tables = {
    ...     "model": {"segments": 8},
    ...     "load": {"profile": "tip"},
    ...     "study": {"axes": [{"key": "load.force", "values": [20.0, 60.0]}]},
    ... }
    >>> stored = un.sweep(tables, "forces.zarr", workers=1)  # doctest: +SKIP
    """
    began = time.monotonic()
    if workers is not None and (isinstance(workers, bool) or workers < 1):
        raise InputError(f"workers = {workers!r} is out of range; give at least 1")
    workers_that_fit(workers)
    checked = (
        read_sweep(Path(tables)) if isinstance(tables, str | Path) else sweep_from_tables(tables)
    )
    opened = open_sweep(Path(store), checked)
    with opened.alone():
        work = SweepWork(opened, retry_failed=retry_failed)
        ending = "done"
        if work.left:
            ending = compute(work, opened.sweep, workers=workers, deadline=began + budget)
    return load_sweep(opened.path).assign_attrs(ending=ending)
