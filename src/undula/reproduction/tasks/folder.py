"""Folder of a report: recognised by a mark, locked by one process, without foreign files."""

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from undula.errors import InputError
from undula.storage.atomic import folder_errors_explained, write_whole
from undula.storage.marks import carries_mark
from undula.storage.outputs import claimed

#: Names of the page of a report and of its claims.
PAGE, CLAIMS = "index.html", "claims.json"
#: File that marks the folder of a report.
MARK = ".undula-report"
_TEXT = b"This folder is a report of undula reproduce, which replaces what it made in it.\n"
#: Files in the folder of a task that its command does not write.
KEY, ANSWER = "key", "answer.json"
#: Files of a store that contain its format.
_STORE_FILES = (".zattrs", ".zmetadata")
#: Endings of unfinished files and locks of a killed process.
_LEFTOVERS = (".part", ".part.mp4", ".lock")


@contextmanager
def locked_report(folder: Path) -> Iterator[None]:
    """Lock the folder of a report, which is made if it does not exist.

    Raises
    ------
    InputError
        The folder is a file, holds something else than a report, is locked by another process, or
        cannot be written.
    """
    with folder_errors_explained(folder / PAGE):
        _refuse_other(folder)
        folder.mkdir(parents=True, exist_ok=True)
    files = [folder / PAGE, folder / CLAIMS]
    with claimed(*files, continued=files):
        _refuse_other(folder)
        if not (folder / MARK).is_file():
            write_whole(folder / MARK, _TEXT)
        yield


def refuse_foreign(task: Path) -> None:
    """Refuse the folder of a task that holds a file that undula has not made.

    Raises
    ------
    InputError
        It holds such a file, or is not a folder.
    """
    with folder_errors_explained(task):
        if task.is_symlink() or (task.exists() and not task.is_dir()):
            raise InputError(f"{task} is no folder of undula; move it away")
        for path in sorted(task.iterdir()) if task.exists() else ():
            if not _is_own(path):
                raise InputError(f"{path} was not made by undula; move it out of the report")


def clear(task: Path) -> None:
    """Remove the folder of a task with the files that undula has made.

    Raises
    ------
    InputError
        It holds other files, or cannot be written.
    """
    refuse_foreign(task)
    with folder_errors_explained(task):
        if task.exists():
            shutil.rmtree(task)


def _refuse_other(folder: Path) -> None:
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder} is a file; give a folder for the report")
    if not folder.exists() or (folder / MARK).is_file():
        if os.path.lexists(folder / PAGE) and not carries_mark(folder / PAGE):
            raise InputError(f"{folder / PAGE} was not made by undula; move it away")
        return
    if any(not path.name.endswith(_LEFTOVERS) for path in folder.iterdir()):
        raise InputError(
            f"{folder} holds something else than a report of undula reproduce (there is no {MARK}"
            " in it); give another folder"
        )


def _is_own(path: Path) -> bool:
    if path.name.startswith(".") and path.name.endswith(_LEFTOVERS):
        return True
    if path.is_symlink():
        return False
    if path.is_dir():
        return _is_sweep(path)
    return path.name in (KEY, ANSWER) or carries_mark(path)


def _is_sweep(folder: Path) -> bool:
    """Return True if a folder is the store of a sweep, even a damaged one."""
    for name in _STORE_FILES:
        with suppress(OSError):
            if b"undula_format" in (folder / name).read_bytes():
                return True
    return False
