"""Stored results that other software has stored again as Zarr, read at once as they are."""

from collections.abc import Iterable
from pathlib import Path

import xarray as xr

from undula.errors import InputError
from undula.storage.checked_zarr import SoundStore
from undula.storage.unchecked import warn_unchecked
from undula.storage.zarr_metadata import Metadata


def read_copy(path: Path, metadata: Metadata, without: Iterable[str] = ()) -> xr.Dataset:
    """Return what a store without checksums holds, with a warning that it carries none.

    Parameters
    ----------
    path
        Its folder.
    metadata
        As `read_metadata` gives them.
    without
        Names of variables that are not read.

    Raises
    ------
    InputError
        It cannot be read.
    """
    try:
        stored = opened(SoundStore.of(path, metadata.files, read_only=True), metadata)
        stored = stored.drop_vars(without, errors="ignore").load()
    except Exception as error:
        # Codecs and Zarr have no common exception for what is broken: nearly any may come.
        raise InputError(
            f"{path} is damaged and carries no checksums to tell where; take it from a copy, or"
            " make it again"
        ) from error
    warn_unchecked(path)
    return stored


def opened(store: SoundStore, metadata: Metadata) -> xr.Dataset:
    """Return what a store holds, read when it is asked for."""
    found: xr.Dataset = xr.open_zarr(
        store,
        zarr_format=metadata.format,
        chunks=None,
        consolidated=metadata.format == 2 or None,
    )
    return found
