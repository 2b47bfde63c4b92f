"""The only reader and writer of result files: one NetCDF4 file for a run.

The root group holds the trajectory, as any NetCDF reader shows it; the group ``checkpoint``
holds the arrays that continue the run, bit for bit. A file appears whole or not at all, and
the same content always gives the same bytes. Other kinds of results are files of a root group
alone. A checksum behind all is held against the bytes before HDF5 sees them; the checkpoint carries
another, since it holds good also in a file that was annotated by other software.
"""

from collections.abc import Mapping
from io import BytesIO
from pathlib import Path
from typing import Any

import dask
import h5py
import numpy as np
import numpy.typing as npt
import xarray as xr

from undula.errors import InputError
from undula.storage.atomic import write_whole
from undula.storage.digests import digest_of_arrays
from undula.storage.result_kinds import (
    RUN,
    Kind,
    check_format,
    damaged,
    refuse_broken_attributes,
)
from undula.storage.seal import Condition, condition, sealed
from undula.storage.unchecked import warn_unchecked
from undula.storage.zarr_metadata import is_store, read_metadata

_ENGINE: Any = "h5netcdf"
_CHECKPOINT = "checkpoint"
# NetCDF hands the dimensions of the root down to the group: an array called "time" there would
# pass for the coordinate of the dimension "time".
_SAVED = "saved_"
_DIGEST = "sha256"
#: What a checkpoint goes on with besides its arrays: attributes of the root.
_GOES_ON_WITH = ("input", "versions", "summary")
_HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"


def write_run(
    path: Path,
    dataset: xr.Dataset,
    checkpoint: Mapping[str, npt.NDArray[Any]],
    *,
    overwrite: bool = False,
) -> None:
    """Write the result of a run, whole or not at all.

    Parameters
    ----------
    path
        The file to write; missing folders on the way are made.
    dataset
        Trajectory, observables and attributes. The attribute ``undula_format`` is added.
    checkpoint
        Name to array of float64, int64 or bool and of any shape, kept bit for bit.
    overwrite
        Whether an existing file may be replaced.

    Raises
    ------
    InputError
        The file exists and `overwrite` is false, or the folder cannot be written or is full.
        A file that was there before is then left as it was.
    """
    write_whole(path, run_image(dataset, checkpoint), overwrite=overwrite)


def run_image(dataset: xr.Dataset, checkpoint: Mapping[str, npt.NDArray[Any]]) -> bytes:
    """Return the bytes of the file that `write_run` writes."""
    return _image(RUN, dataset, checkpoint)


def write_result(path: Path, dataset: xr.Dataset, kind: Kind, *, overwrite: bool = False) -> None:
    """Write a result of another kind, without a checkpoint, as `write_run` does."""
    write_whole(path, _image(kind, dataset), overwrite=overwrite)


def read_result(path: Path, kind: Kind) -> xr.Dataset:
    """Read a result of another kind, as `load_result` does."""
    return _read(path, kind)


def load_result(path: Path | str) -> xr.Dataset:
    """Read the trajectory, observables and attributes of a stored run.

    Parameters
    ----------
    path
        A file written by `write_run`.

    Returns
    -------
    xarray.Dataset
        The root group, in memory; the file is closed again.

    Raises
    ------
    InputError
        The file is missing, unreadable, cut short, or not a result file of undula.
    """
    return _read(Path(path), RUN)


def load_checkpoint(path: Path) -> dict[str, npt.NDArray[Any]]:
    """Read the arrays that continue a stored run.

    Parameters
    ----------
    path
        A file written by `write_run`.

    Returns
    -------
    dict
        Name to array, with the values, types and shapes that were written.

    Raises
    ------
    InputError
        The file is missing, unreadable, cut short, or not a result file of undula.
    """
    stored, root = _read(path, RUN, _CHECKPOINT), _read(path, RUN)
    arrays = {str(name).removeprefix(_SAVED): array.values for name, array in stored.items()}
    # Files of earlier versions have none.
    if stored.attrs.get(_DIGEST, _digest(arrays, root)) != _digest(arrays, root):
        raise InputError(
            f"the checkpoint of {path} is not as undula run wrote it, or is not of this input;"
            " run it again, or resume a copy that is whole"
        )
    return arrays


def _image(
    kind: Kind, dataset: xr.Dataset, checkpoint: Mapping[str, npt.NDArray[Any]] | None = None
) -> bytes:
    """Return the bytes of the file: made in memory, a full disk cannot leave HDF5 half open."""
    image = BytesIO()
    _append(image, dataset.assign_attrs(undula_format=kind.format), group=None)
    if checkpoint is not None:
        arrays = {name: np.asarray(kept) for name, kept in checkpoint.items()}
        named = {f"{_SAVED}{name}": _as_variable(name, kept) for name, kept in arrays.items()}
        attributes = {_DIGEST: _digest(arrays, dataset)}
        _append(image, xr.Dataset(named, attrs=attributes), group=_CHECKPOINT)
    return sealed(image.getvalue())


def _digest(arrays: Mapping[str, npt.NDArray[Any]], root: xr.Dataset) -> str:
    """Return the digest of a checkpoint and of what it goes on with."""
    return digest_of_arrays(
        arrays, {name: str(root.attrs[name]) for name in _GOES_ON_WITH if name in root.attrs}
    )


def _as_variable(name: str, values: npt.NDArray[Any]) -> xr.Variable:
    if values.dtype not in (np.float64, np.int64, np.bool_):
        raise TypeError(
            f"checkpoint array {name} has type {values.dtype}, not float64, int64, bool"
        )
    # The dot keeps these names apart from those of other arrays.
    return xr.Variable([f"{_SAVED}{name}.axis{axis}" for axis in range(values.ndim)], values)


def _append(image: BytesIO, content: xr.Dataset, group: str | None) -> None:
    # Encodings left over from a file that was read would change the bytes.
    plain = content.drop_encoding()
    encoding = {name: _encoding(variable) for name, variable in plain.variables.items()}
    mode: Any = "w" if group is None else "a"
    # Inside of a worker xarray would ask the scheduler for a lock of what is in memory here.
    with dask.config.set(scheduler="synchronous"):
        plain.to_netcdf(image, mode=mode, group=group, engine=_ENGINE, encoding=encoding)


def _encoding(variable: xr.Variable) -> dict[str, Any]:
    # No fill value: every number, NaN too, is kept as it is.
    keep = {"_FillValue": None}
    if variable.ndim < 2 or variable.size == 0:
        return keep
    return keep | {"zlib": True, "complevel": 1, "shuffle": True}


def _read(path: Path, kind: Kind, group: str | None = None) -> xr.Dataset:
    if group is None and is_store(path):
        return _read_folder(path, kind)
    content = _read_bytes(path, kind)
    found = condition(content)
    if found is Condition.DAMAGED:
        raise damaged(path, kind)
    try:
        with h5py.File(BytesIO(content), "r") as root:
            check_format(path, kind, root.attrs)
            if group is not None and group not in root:
                raise InputError(
                    f"{path} holds no {group}, since other software has stored it; give the file"
                    f" that {kind.command} wrote"
                )
        with _opened(content, group) as stored:
            dataset = _without_fill(stored.load().drop_encoding())
    except InputError:
        raise
    except Exception as error:
        # The HDF5 stack has no common exception for broken files: nearly any may come.
        raise damaged(path, kind) from error
    if found is Condition.UNCHECKED and group is None:
        refuse_broken_attributes(path, kind, dataset)
        warn_unchecked(path)
    return dataset


def _read_folder(path: Path, kind: Kind) -> xr.Dataset:
    """Return a result that other software has stored again as Zarr."""
    # Zarr is slow to be imported, and hardly any result needs it.
    from undula.storage.zarr_copy import read_copy

    metadata = read_metadata(path)
    check_format(path, kind, metadata.attributes)
    return _without_fill(read_copy(path, metadata).drop_encoding())


def _without_fill(dataset: xr.Dataset) -> xr.Dataset:
    """Return a dataset without the fill values that xarray adds, and would not store again."""
    for variable in dataset.variables.values():
        variable.attrs.pop("_FillValue", None)
    return dataset


def _opened(content: bytes, group: str | None) -> xr.Dataset:
    return xr.open_dataset(
        BytesIO(content),
        engine=_ENGINE,
        group=group,
        phony_dims="sort",
        mask_and_scale=False,
        decode_times=False,
    )


def _read_bytes(path: Path, kind: Kind) -> bytes:
    try:
        with path.open("rb") as file:
            signature = file.read(len(_HDF5_SIGNATURE))
            if signature == _HDF5_SIGNATURE:
                return signature + file.read()
    except FileNotFoundError:
        raise InputError(f"there is no result file {path}; check the name") from None
    except OSError as error:
        reason = error.strerror or error
        raise InputError(
            f"cannot read the result file {path} ({reason}); give a readable result file"
        ) from error
    if signature and _HDF5_SIGNATURE.startswith(signature):
        raise damaged(path, kind)
    raise InputError(f"{path} is not a NetCDF4 file; give a result file written by {kind.command}")
