"""Atomic writing of files: each appears whole or not at all, whatever interrupts the writing."""

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
    """Write a file under a temporary name in the same folder, then rename it in one step.

    Parameters
    ----------
    path
        The file; missing folders are made.
    content
        All its bytes.
    overwrite
        If true, an existing file is replaced. A link is replaced itself, not the file that it
        points to.

    Raises
    ------
    InputError
        The file exists and `overwrite` is false, or the folder cannot be written or is full.
        An existing file then stays as it is.
    """
    with folder_errors_explained(path):
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
    # Links count as existing, broken ones too.
    if not overwrite and os.path.lexists(path):
        raise InputError(f"{path} exists already; give --overwrite to replace it")


@contextmanager
def folder_errors_explained(path: Path) -> Iterator[None]:
    """Turn errors of writing a file into a sentence for the user.

    Parameters
    ----------
    path
        The file, or a folder of many files that the sentence names instead.

    Raises
    ------
    InputError
        The folder of the file cannot be written or is full.
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
    # Mode "x" refuses existing names, links included, so that no link diverts the writing.
    with path.open("xb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())


def _flush_folder(folder: Path) -> None:
    # The new name survives a power cut only after its folder is flushed to disk.
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
