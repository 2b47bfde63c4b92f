"""Names that a command is going to write: claimed before its work, held by a lock until its end.

Every command that writes files asks for their names here. What exists already is replaced if the
user says so, or if it carries our mark and the command is there to renew it; what a command reads
is never replaced, and nothing is written through a link.
"""

import os
import stat
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from itertools import combinations, product
from pathlib import Path

from undula.errors import InputError
from undula.storage.atomic import folder_trouble_told, write_whole
from undula.storage.marks import carries_mark
from undula.storage.name_lock import locked

#: Bytes that a name grows by while its file is written.
_GROWTH, _LONGEST = 25, 255


@dataclass(frozen=True)
class Claim:
    """What may be done to the names that a command has claimed.

    Attributes
    ----------
    renewed
        Names under which there may be a file already, if it carries our mark.
    continued
        Names of files that the command goes on with, whose content it checks itself.
    overwrite
        Whether any file may be replaced.
    """

    renewed: frozenset[Path] = frozenset()
    continued: frozenset[Path] = frozenset()
    overwrite: bool = False

    def check(self, path: Path) -> None:
        """Refuse to write a file where there is something that is not to be replaced.

        Raises
        ------
        InputError
            There is.
        """
        with folder_trouble_told(path):
            found = _kind(path)
        if found is None:
            return
        if stat.S_ISDIR(found) or path.is_dir():
            raise InputError(f"{path} is a folder; give the name of a file")
        if not stat.S_ISREG(found) and not stat.S_ISLNK(found):
            raise InputError(f"{path} is no plain file; give another name")
        if self.overwrite:
            return
        if path in self.renewed | self.continued and stat.S_ISLNK(found):
            raise InputError(
                f"{path} is a link; give the name of the file itself, or --overwrite to replace the"
                " link"
            )
        if path in self.continued or (path in self.renewed and carries_mark(path)):
            return
        if path in self.renewed:
            raise InputError(
                f"{path} does not carry the mark of undula and may be yours; move it away, or give"
                " --overwrite to replace it"
            )
        raise InputError(f"{path} exists already; give --overwrite to replace it")

    def write(self, path: Path, content: bytes) -> None:
        """Write a file, whole or not at all.

        Raises
        ------
        InputError
            There is something that is not to be replaced, also if it has come since the name was
            claimed; or the folder cannot be written or is full.
        """
        self.check(path)
        write_whole(path, content, overwrite=True)


def discard(path: Path) -> None:
    """Remove a file, if it is one of ours: what is not stays, whatever was asked for."""
    if carries_mark(path):
        path.unlink(missing_ok=True)


def renewing(path: Path) -> Claim:
    """Return the claim on a file in a folder that is ours: what carries our mark is renewed."""
    return Claim(renewed=frozenset([path]))


@contextmanager
def claimed(
    *names: Path,
    renewed: Sequence[Path] = (),
    continued: Sequence[Path] = (),
    overwrite: bool = False,
    reads: Sequence[Path] = (),
) -> Iterator[Claim]:
    """Have names for this process alone.

    Missing folders on the way are made, and those in which nothing was written removed again.

    Parameters
    ----------
    names
        Of the files to be written.
    renewed
        Those of them that may be there already, if they carry our mark.
    continued
        Those of them that the command goes on with: it reads them itself, once they are its own.
    overwrite
        Whether any file may be replaced.
    reads
        Files that the command reads, which is none of these under any name.

    Raises
    ------
    InputError
        Another process has one of the names, there is something that is not to be replaced, the
        command reads it, or a folder cannot be written or is full.
    """
    claim = Claim(frozenset(renewed), frozenset(continued), overwrite)
    _refuse_what_is_read(names, reads)
    with ExitStack() as held:
        for path in names:
            _refuse_long(path)
            held.enter_context(_folder_made(path))
            busy = f"another undula is at work on {path}; wait for it, or give another name"
            held.enter_context(locked(path, busy))
        for path in names:
            claim.check(path)
        yield claim


@contextmanager
def _folder_made(path: Path) -> Iterator[None]:
    folders = (path.parent, *path.parent.parents)
    with folder_trouble_told(path):
        missing = [folder for folder in folders if not os.path.lexists(folder)]
        path.parent.mkdir(parents=True, exist_ok=True)
    try:
        yield
    finally:
        with suppress(OSError):  # which ends at the first one that is not empty
            for folder in missing:
                folder.rmdir()


def _refuse_what_is_read(names: Sequence[Path], reads: Sequence[Path]) -> None:
    """Refuse an output that is an input or another output, under this name or another one."""
    pairs = [*product(names, reads), *combinations(names, 2)]
    for written, other in pairs:
        if written == other or _same(written, other):
            raise InputError(
                f"{written} is a file that this command reads or writes already; give what it"
                " writes another name, or rename what it reads"
            )


def _same(one: Path, other: Path) -> bool:
    try:
        return one.samefile(other)
    except OSError:
        return False


def _refuse_long(path: Path) -> None:
    if len(os.fsencode(path.name)) > _LONGEST - _GROWTH:
        raise InputError(f"{path.name[:40]}... is too long a name; give a shorter one")


def _kind(path: Path) -> int | None:
    """Return the mode of what is there, of a link that of itself; None if there is nothing."""
    try:
        return os.lstat(path).st_mode
    except FileNotFoundError:
        return None
