"""Files that appear whole or not at all, whatever interrupts the writing."""

import errno
import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from undula.errors import InputError

_FULL = (errno.ENOSPC, errno.EDQUOT)
_CURES = {
    errno.ENAMETOOLONG: "give a shorter name",
    errno.ELOOP: "remove the link in its place",
}


def write_whole(path: Path, content: bytes, *, overwrite: bool = False) -> None:
    """Write a file under a temporary name beside its place, then move it there in one step.

    Parameters
    ----------
    path
        The file to write; missing folders on the way are made.
    content
        All its bytes.
    overwrite
        Whether an existing file may be replaced. Of a link, the link itself is; where it points to
        stays as it is.

    Raises
    ------
    InputError
        The file exists and `overwrite` is false, or the folder cannot be written or is full.
        A file that was there before is then left as it was.
    """
    with folder_trouble_told(path):
        _refuse_existing(path, overwrite)
        path.parent.mkdir(parents=True, exist_ok=True)
        temporary = path.with_name(f".{path.name}.{secrets.token_hex(4)}.part")
        try:
            _write_to_disk(temporary, content)
            os.replace(temporary, path)
        finally:
            temporary.unlink(missing_ok=True)
        _flush_folder(path.parent)


def _refuse_existing(path: Path, overwrite: bool) -> None:
    if path.is_dir():
        raise InputError(f"{path} is a folder; give the name of a file")
    # A link counts as well, also one that leads nowhere.
    if not overwrite and os.path.lexists(path):
        raise InputError(f"{path} exists already; give --overwrite to replace it")


@contextmanager
def folder_trouble_told(path: Path) -> Iterator[None]:
    """Turn errors of writing a file into a sentence for the user.

    Parameters
    ----------
    path
        The file, or a folder that holds many and is told in its place.

    Raises
    ------
    InputError
        Its folder cannot be written or is full.
    """
    try:
        yield
    except OSError as error:
        if error.errno in _FULL:
            raise InputError(
                f"the disk that holds {path.parent} is full; free some space or choose another"
                " folder"
            ) from error
        reason = error.strerror or error
        cure = _CURES.get(error.errno or 0, "choose a writable folder")
        raise InputError(f"cannot write {path.name} in {path.parent} ({reason}); {cure}") from error


def _write_to_disk(path: Path, content: bytes) -> None:
    # Refused where there is anything, a link too: nobody can have us write elsewhere.
    with path.open("xb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())


def _flush_folder(folder: Path) -> None:
    # The new name itself survives a power cut only once its folder is on disk.
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
