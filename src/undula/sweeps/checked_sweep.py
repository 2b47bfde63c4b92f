"""Stored sweeps as datasets that contain only undamaged numbers.

Points of a chunk with a damaged or missing file are shown as not done. Only the requested variables
are checked: shapes are nearly all of a large store.
"""

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from undula.schema.sweep_variables import INNER, STATUS
from undula.storage.checked_zarr import SoundStore
from undula.storage.unchecked import warn_damaged
from undula.storage.zarr_copy import opened, read_copy
from undula.storage.zarr_metadata import ARRAYS, DIGEST, Metadata
from undula.sweeps.chunk_files import ChunkFiles
from undula.sweeps.layout import derived_arrays
from undula.sweeps.sweep import sweep_from_dump


def sound_dataset(path: Path, metadata: Metadata, *, shapes: bool) -> xr.Dataset:
    """Return the undamaged part of a stored sweep as a lazily read dataset.

    A sweep without checksums is read at once.

    Parameters
    ----------
    path
        Folder of the store.
    metadata
        Its metadata, as `read_metadata` returns them.
    shapes
        If true, the variables include the shapes of last periods.

    Raises
    ------
    InputError
        A sweep without checksums cannot be read.
    """
    without = () if shapes else tuple(INNER)
    read = _sound if metadata.checked else read_copy
    stored = read(path, metadata, without)
    seal = (ARRAYS, DIGEST)
    attributes = {name: value for name, value in stored.attrs.items() if name not in seal}
    # With the encodings of this store, xarray could not store the dataset again.
    return _with_attributes(stored.drop_encoding(), attributes)


def _sound(path: Path, metadata: Metadata, without: Iterable[str]) -> xr.Dataset:
    files = ChunkFiles.of(path, metadata)
    store = SoundStore.of(path, metadata.files, read_only=True)
    damaged, not_done = files.damaged_derived(), files.with_damaged_status()
    store.hidden |= {files.key(name) for name in damaged}
    store.hidden |= {files.key(STATUS.name, chunk) for chunk in not_done}
    stored = opened(store, metadata).drop_vars(without, errors="ignore")
    # A chunk's status is written last: variables that are checked after it exist.
    statuses = np.array(stored[STATUS.name].values)
    names = [name for name in files.names if name in stored]
    points = sum(len(files.grid.numbers(chunk)) for chunk in not_done)
    for chunk in files.damaged(statuses.ravel(), names):
        region = files.grid.region(chunk)
        points += int((statuses[region] != STATUS.rest).sum())
        statuses[region] = STATUS.rest
        not_done.append(chunk)
    store.hidden |= {files.key(name, chunk) for name in names for chunk in not_done}
    if points:
        warn_damaged(path, points)
    stored[STATUS.name] = stored[STATUS.name].copy(data=statuses)
    return _with_derived(stored, damaged)


def _with_derived(stored: xr.Dataset, names: list[str]) -> xr.Dataset:
    """Return a sweep with the named arrays computed again from its definition."""
    if names:
        derived = derived_arrays(sweep_from_dump(json.loads(stored.attrs["study"])))
        for name in names:
            stored[name] = (stored[name].dims, derived[name], stored[name].attrs)
    return stored


def _with_attributes(stored: xr.Dataset, attributes: dict[str, Any]) -> xr.Dataset:
    stored.attrs = attributes
    return stored
