"""Files that appear whole or not at all, whatever interrupts the writing."""

import errno
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from undula.errors import InputError

_FULL = (errno.ENOSPC, errno.EDQUOT)


def claim_output(path: Path, *, overwrite: bool = False) -> None:
    """Check that a file can be written, before long work is spent on its content.

    Parameters
    ----------
    path
        The file to be written later; missing folders on the way are made.
    overwrite
        Whether an existing file may be replaced.

    Raises
    ------
    InputError
        The file exists and `overwrite` is false, or the folder cannot be made or written.
    """
    _refuse_existing(path, overwrite)
    with folder_trouble_told(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=path.parent) as probe:
            probe.write(b"x")


def write_whole(path: Path, content: bytes, *, overwrite: bool = False) -> None:
    """Write a file under a temporary name beside its place, then move it there in one step.

    Parameters
    ----------
    path
        The file to write; missing folders on the way are made.
    content
        All its bytes.
    overwrite
        Whether an existing file may be replaced.

    Raises
    ------
    InputError
        The file exists and `overwrite` is false, or the folder cannot be written or is full.
        A file that was there before is then left as it was.
    """
    _refuse_existing(path, overwrite)
    temporary = path.with_name(f".{path.name}.{os.getpid()}.part")
    with folder_trouble_told(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        try:
            _write_to_disk(temporary, content)
            os.replace(temporary, path)
        finally:
            temporary.unlink(missing_ok=True)
        _flush_folder(path.parent)


def _refuse_existing(path: Path, overwrite: bool) -> None:
    if path.is_dir():
        raise InputError(f"{path} is a folder; give the name of a file")
    if not overwrite and path.exists():
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
        raise InputError(
            f"cannot write {path.name} in {path.parent} ({reason}); choose a writable folder"
        ) from error


def _write_to_disk(path: Path, content: bytes) -> None:
    with path.open("wb") as file:
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
