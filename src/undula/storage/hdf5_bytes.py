"""Bytes of an HDF5 file, recognised by its signature before the rest is read."""

from pathlib import Path

from undula.errors import InputError
from undula.storage.result_kinds import Kind, damaged

_SIGNATURE = b"\x89HDF\r\n\x1a\n"


def hdf5_bytes(path: Path, kind: Kind) -> bytes:
    """Return the content of a file.

    Parameters
    ----------
    path
        The file.
    kind
        The expected kind of result, for messages.

    Raises
    ------
    InputError
        The file is missing, cannot be read, or does not begin as an HDF5 file does.
    """
    try:
        with path.open("rb") as file:
            signature = file.read(len(_SIGNATURE))
            if signature == _SIGNATURE:
                return signature + file.read()
    except FileNotFoundError:
        raise InputError(f"there is no result file {path}; check the name") from None
    except OSError as error:
        reason = error.strerror or error
        raise InputError(
            f"cannot read the result file {path} ({reason}); give a readable result file"
        ) from error
    if signature and _SIGNATURE.startswith(signature):
        raise damaged(path, kind)
    raise InputError(f"{path} is not a NetCDF4 file; give a result file written by {kind.command}")
