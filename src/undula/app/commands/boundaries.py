"""Borders of a stored study: those that are kept beside it, the others solved for by workers."""

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
    columns_of,
    keep_borders,
    kept_columns,
    tables_of,
)
from undula.sweeps.workers import DiedError, LostError, pool
from undula.terminal.output import notice
from undula.terminal.progress import swept

#: Seconds to wait for a column before looking at Ctrl-C again.
_PATIENCE = 0.2


def borders_of(path: Path, store: xr.Dataset) -> StabilityBoundaries | None:
    """Return the borders of a study; None if not all of them are there, as after Ctrl-C.

    Parameters
    ----------
    path
        The study's folder, in which every column is kept as soon as it is there.
    store
        What was chosen of the study.

    Raises
    ------
    InputError
        The study does not vary the force, or its folder cannot be written.
    """
    if FORCE not in axes_of(store):
        raise InputError(
            f"--borders are values of {FORCE}, which {path} does not vary; leave them out"
        )
    parameter = next((name for name in varied(store) if _is_of_the_model(name)), None)
    values = (float("nan"),) if parameter is None else tuple(store[parameter].values.tolist())
    up_to = float(store[FORCE].values.max())
    columns = kept_columns(path, store) or [None] * len(values)
    why = "interrupted"
    if None in columns:
        job = {"tables": tables_of(store), "parameter": parameter, "up_to": up_to}
        busy = f"another undula solves for the borders of {path}; wait for it"
        try:
            with locked(path / NAME, busy):
                _solve(path, store, StabilityBoundaries(parameter, values, up_to, ()), job, columns)
        except LostError as lost:
            why = lost.told
    done = [column for column in columns if column is not None]
    if len(done) == len(columns):
        return StabilityBoundaries(parameter, values, up_to, tuple(done))
    notice(
        f"{why} with {len(columns) - len(done)} of {len(columns)} columns of borders to go;"
        f" those so far are in {path}, the same command goes on"
    )
    return None


def _solve(
    path: Path,
    store: xr.Dataset,
    empty: StabilityBoundaries,
    job: dict[str, Any],
    columns: list[Column | None],
) -> None:
    """Fill in the columns that are missing, until Ctrl-C, and keep each."""
    missing = deque(index for index, column in enumerate(columns) if column is None)
    count = len(missing)
    with (
        interruptible() as interrupted,
        pool(None, None, notice) as workers,
        swept("solving for borders", len(columns), count, "columns") as tell,
    ):
        while missing or workers.busy:
            if interrupted():
                return
            while missing and workers.has_room:
                index = missing.popleft()
                workers.give(index, columns_of, [job | {"value": empty.values[index]}])
            for index, outcome in workers.come_back(_PATIENCE):
                if isinstance(outcome, DiedError):
                    raise InputError(
                        f"every worker died over the borders at {empty.parameter} ="
                        f" {empty.values[index]:g}, perhaps for want of memory; free some"
                    )
                (columns[index],) = outcome
                keep_borders(path, store, empty, columns)
                tell(columns.count(None), 0)


def _is_of_the_model(name: str) -> bool:
    """Tell whether an axis changes the model: starts and times do not move its borders."""
    return name != FORCE and name.split(".")[0] in ("model", "load")
