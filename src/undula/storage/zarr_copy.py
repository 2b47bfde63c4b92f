"""Reader of results that other software has stored again as Zarr."""

from collections.abc import Iterable
from pathlib import Path

import xarray as xr

from undula.errors import InputError
from undula.storage.checked_zarr import SoundStore
from undula.storage.unchecked import warn_unchecked
from undula.storage.zarr_metadata import Metadata


def read_copy(path: Path, metadata: Metadata, without: Iterable[str] = ()) -> xr.Dataset:
    """Read a store without checksums at once, and warn that it carries none.

    Parameters
    ----------
    path
        Folder of the store.
    metadata
        Its metadata, as `read_metadata` returns them.
    without
        Names of variables that are not read.

    Raises
    ------
    InputError
        The store cannot be read.
    """
    try:
        stored = opened(SoundStore.of(path, metadata.files, read_only=True), metadata)
        stored = stored.drop_vars(without, errors="ignore").load()
    except Exception as error:
        # Codecs and Zarr have no common exception for damage and may raise almost any.
        raise InputError(
            f"{path} is damaged and carries no checksums to tell where; take it from a copy, or"
            " make it again"
        ) from error
    warn_unchecked(path)
    return stored


def opened(store: SoundStore, metadata: Metadata) -> xr.Dataset:
    """Return the content of a store as a lazily read dataset.

    Parameters
    ----------
    store
        The store.
    metadata
        Its metadata.
    """
    dataset: xr.Dataset = xr.open_zarr(
        store,
        zarr_format=metadata.format,
        chunks=None,
        consolidated=metadata.format == 2 or None,
    )
    return dataset
