"""A stored study as a dataset in which every number is as it was written.

A block of points of which a chunk is damaged or missing is shown as not done. Only what is asked
for is looked at: shapes are nearly all of a large store.
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
from undula.sweeps.chunks import Chunks
from undula.sweeps.layout import known_arrays
from undula.sweeps.sweep import of_dump


def sound_dataset(path: Path, metadata: Metadata, *, shapes: bool) -> xr.Dataset:
    """Return what is whole of a study, read when it is asked for.

    A study that carries no checksums is read at once.

    Parameters
    ----------
    path
        Its folder.
    metadata
        As `read_metadata` gives them.
    shapes
        Whether the shapes of last periods are among the variables.

    Raises
    ------
    InputError
        A study without checksums cannot be read.
    """
    without = () if shapes else tuple(INNER)
    read = _sound if metadata.checked else read_copy
    stored = read(path, metadata, without)
    seal = (ARRAYS, DIGEST)
    kept = {name: told for name, told in stored.attrs.items() if name not in seal}
    # Encodings of this store would be in the way of storing it again.
    return _with_attributes(stored.drop_encoding(), kept)


def _sound(path: Path, metadata: Metadata, without: Iterable[str]) -> xr.Dataset:
    chunks = Chunks.of(path, metadata)
    store = SoundStore.of(path, metadata.files, read_only=True)
    known, undone = chunks.damaged_known(), chunks.without_status()
    store.hidden |= {chunks.key(name) for name in known}
    store.hidden |= {chunks.key(STATUS.name, block) for block in undone}
    stored = opened(store, metadata).drop_vars(without, errors="ignore")
    # A block's status is written last: what is looked at after it is there.
    statuses = np.array(stored[STATUS.name].values)
    names = [name for name in chunks.names if name in stored]
    points = sum(len(chunks.blocks.numbers(block)) for block in undone)
    for block in chunks.damaged(statuses.ravel(), names):
        region = chunks.blocks.region(block)
        points += int((statuses[region] != STATUS.rest).sum())
        statuses[region] = STATUS.rest
        undone.append(block)
    store.hidden |= {chunks.key(name, block) for name in names for block in undone}
    if points:
        warn_damaged(path, points)
    stored[STATUS.name] = stored[STATUS.name].copy(data=statuses)
    return _replaced(stored, known)


def _replaced(stored: xr.Dataset, known: list[str]) -> xr.Dataset:
    """Return a study with those of its arrays made anew that follow from it."""
    if known:
        made = known_arrays(of_dump(json.loads(stored.attrs["study"])))
        for name in known:
            stored[name] = (stored[name].dims, made[name], stored[name].attrs)
    return stored


def _with_attributes(stored: xr.Dataset, attributes: dict[str, Any]) -> xr.Dataset:
    stored.attrs = attributes
    return stored
