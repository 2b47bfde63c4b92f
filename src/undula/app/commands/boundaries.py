"""Stability boundaries of a stored sweep, read from its cache or solved for by workers."""

from collections import deque
from pathlib import Path
from typing import Any

import xarray as xr

from undula.analysis.maps.stability_boundaries import StabilityBoundaries
from undula.analysis.parameters import FORCE
from undula.errors import InputError
from undula.interrupts import interruptible
from undula.schema.sweep_axes import axes_of, varied
from undula.storage.name_lock import locked
from undula.sweeps.boundary_cache import (
    NAME,
    Column,
    read_boundaries,
    solve_columns,
    tables_of,
    write_boundaries,
)
from undula.sweeps.workers import DiedError, LostError, pool
from undula.terminal.output import notice
from undula.terminal.progress import swept

#: Time to wait for a column before Ctrl-C is checked again [s].
_PATIENCE = 0.2


def boundaries_of(path: Path, store: xr.Dataset) -> StabilityBoundaries | None:
    """Return the stability boundaries of a sweep; None if some are missing, as after Ctrl-C.

    Parameters
    ----------
    path
        Folder of the sweep, in which every column is cached as soon as it is solved.
    store
        The selected part of the sweep.

    Raises
    ------
    InputError
        The sweep does not vary the force, or its folder cannot be written.
    """
    if FORCE not in axes_of(store):
        raise InputError(
            f"--borders are values of {FORCE}, which {path} does not vary; leave them out"
        )
    parameter = next((name for name in varied(store) if _changes_the_model(name)), None)
    values = (float("nan"),) if parameter is None else tuple(store[parameter].values.tolist())
    up_to = float(store[FORCE].values.max())
    columns = read_boundaries(path, store) or [None] * len(values)
    cause = "interrupted"
    if None in columns:
        request = {"tables": tables_of(store), "parameter": parameter, "up_to": up_to}
        empty = StabilityBoundaries(parameter, values, up_to, ())
        busy = f"another undula solves for the borders of {path}; wait for it"
        try:
            with locked(path / NAME, busy):
                _solve(path, store, empty, request, columns)
        except LostError as lost:
            cause = lost.text
    solved = [column for column in columns if column is not None]
    if len(solved) == len(columns):
        return StabilityBoundaries(parameter, values, up_to, tuple(solved))
    notice(
        f"{cause} with {len(columns) - len(solved)} of {len(columns)} columns of borders to go;"
        f" those so far are in {path}, the same command goes on"
    )
    return None


def _solve(
    path: Path,
    store: xr.Dataset,
    empty: StabilityBoundaries,
    request: dict[str, Any],
    columns: list[Column | None],
) -> None:
    """Fill in and cache the missing columns, until Ctrl-C."""
    missing = deque(index for index, column in enumerate(columns) if column is None)
    count = len(missing)
    with (
        interruptible() as interrupted,
        pool(None, None, notice) as workers,
        swept("solving for borders", len(columns), count, "columns") as show,
    ):
        while missing or workers.busy:
            if interrupted():
                return
            while missing and workers.has_room:
                index = missing.popleft()
                workers.give(index, solve_columns, [request | {"value": empty.values[index]}])
            for index, outcome in workers.come_back(_PATIENCE):
                if isinstance(outcome, DiedError):
                    raise InputError(
                        f"every worker died over the borders at {empty.parameter} ="
                        f" {empty.values[index]:g}, perhaps for want of memory; free some"
                    )
                (columns[index],) = outcome
                write_boundaries(path, store, empty, columns)
                show(columns.count(None), 0)


def _changes_the_model(name: str) -> bool:
    """Return True for an axis of model or load; starts and times do not move the boundaries."""
    return name != FORCE and name.split(".")[0] in ("model", "load")
