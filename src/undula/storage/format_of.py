"""The kind of a stored file, from the format that it carries."""

from io import BytesIO
from pathlib import Path

import h5py

from undula.schema.formats import RUN_FORMAT
from undula.storage.hdf5_bytes import hdf5_bytes
from undula.storage.result_kinds import Kind, damaged
from undula.storage.seal import Condition, condition
from undula.storage.zarr_metadata import is_store, read_metadata

_ANY = Kind(RUN_FORMAT, "a command of undula")


def format_of(path: Path) -> str:
    """Return the format of a result file or store; empty for one of other software.

    Raises
    ------
    InputError
        The file is missing, cannot be read, is damaged, or is no NetCDF-4 file.
    """
    if is_store(path):
        return str(read_metadata(path).attributes.get("undula_format", ""))
    content = hdf5_bytes(path, _ANY)
    if condition(content) is Condition.DAMAGED:
        raise damaged(path, _ANY)
    try:
        with h5py.File(BytesIO(content), "r") as root:
            return str(root.attrs.get("undula_format", ""))
    except Exception as error:
        # The HDF5 stack has no common exception for broken files and may raise almost any.
        raise damaged(path, _ANY) from error
