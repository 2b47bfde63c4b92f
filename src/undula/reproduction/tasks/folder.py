"""The folder of a report: known by a mark, for one process alone, and nothing of others in it."""

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from undula.errors import InputError
from undula.storage.atomic import folder_trouble_told, write_whole
from undula.storage.marks import carries_mark
from undula.storage.outputs import claimed

PAGE, CLAIMS = "index.html", "claims.json"
#: The file that makes a folder one of ours.
MARK = ".undula-report"
_TEXT = b"This folder is a report of undula reproduce, which replaces what it made in it.\n"
#: Files in the folder of a task besides those that its command makes.
KEY, ANSWER = "key", "answer.json"
#: Files of a store that tell what it holds.
_OF_STORES = (".zattrs", ".zmetadata")
#: What a process that was killed leaves of a file it was about to write, or of a lock.
_LEFTOVERS = (".part", ".part.mp4", ".lock")


@contextmanager
def report_claimed(folder: Path) -> Iterator[None]:
    """Have the folder of a report for this process alone; it is made if there is none.

    Raises
    ------
    InputError
        It is no folder, holds something else than a report of ours, belongs to another process
        now, or cannot be written.
    """
    with folder_trouble_told(folder / PAGE):
        _refuse_other(folder)
        folder.mkdir(parents=True, exist_ok=True)
    files = [folder / PAGE, folder / CLAIMS]
    with claimed(*files, continued=files):
        _refuse_other(folder)
        if not (folder / MARK).is_file():
            write_whole(folder / MARK, _TEXT)
        yield


def refuse_foreign(task: Path) -> None:
    """Refuse the folder of a task in which there is something that undula has not made.

    Raises
    ------
    InputError
        There is, or it is no folder.
    """
    with folder_trouble_told(task):
        if task.is_symlink() or (task.exists() and not task.is_dir()):
            raise InputError(f"{task} is no folder of undula; move it away")
        for path in sorted(task.iterdir()) if task.exists() else ():
            if not _is_ours(path):
                raise InputError(f"{path} was not made by undula; move it out of the report")


def clear(task: Path) -> None:
    """Remove the folder of a task with what undula has made in it.

    Raises
    ------
    InputError
        There is something else in it, or it cannot be written.
    """
    refuse_foreign(task)
    with folder_trouble_told(task):
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


def _is_ours(path: Path) -> bool:
    if path.name.startswith(".") and path.name.endswith(_LEFTOVERS):
        return True
    if path.is_symlink():
        return False
    if path.is_dir():
        return _is_study(path)
    return path.name in (KEY, ANSWER) or carries_mark(path)


def _is_study(folder: Path) -> bool:
    """Tell whether a folder is the store of a study, also one that is damaged."""
    for name in _OF_STORES:
        with suppress(OSError):
            if b"undula_format" in (folder / name).read_bytes():
                return True
    return False
