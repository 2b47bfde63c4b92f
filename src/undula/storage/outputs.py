"""Claims on the output files of a command: checked and locked before its work, until its end.

Every command that writes files claims their names here. An existing file is replaced if the user
allows it, or if it carries the mark of undula and the command renews it. Files that the command
reads are never replaced, and nothing is written through a link.
"""

import os
import stat
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from itertools import combinations, product
from pathlib import Path

from undula.errors import InputError
from undula.storage.atomic import folder_errors_explained, write_whole
from undula.storage.marks import carries_mark
from undula.storage.name_lock import locked

#: Growth of a name while its file is written, and the longest name [bytes].
_GROWTH, _LONGEST = 25, 255


@dataclass(frozen=True)
class Claim:
    """Permissions to write the files that a command has claimed.

    Attributes
    ----------
    renewed
        Files that may be replaced if they carry the mark of undula.
    continued
        Files that the command continues, whose content it checks itself.
    overwrite
        If true, any file may be replaced.
    """

    renewed: frozenset[Path] = frozenset()
    continued: frozenset[Path] = frozenset()
    overwrite: bool = False

    def check_writable(self, path: Path) -> None:
        """Refuse a name that the claim does not allow to write.

        Raises
        ------
        InputError
            The name belongs to a folder, a special file, or a file that must not be replaced.
        """
        with folder_errors_explained(path):
            mode = _mode(path)
        if mode is None:
            return
        if stat.S_ISDIR(mode) or path.is_dir():
            raise InputError(f"{path} is a folder; give the name of a file")
        if not stat.S_ISREG(mode) and not stat.S_ISLNK(mode):
            raise InputError(f"{path} is no plain file; give another name")
        if self.overwrite:
            return
        if path in self.renewed | self.continued and stat.S_ISLNK(mode):
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

        Parameters
        ----------
        path
            The file.
        content
            All its bytes.

        Raises
        ------
        InputError
            A file that must not be replaced exists, which may be newer than the claim; or the
            folder cannot be written or is full.
        """
        self.check_writable(path)
        write_whole(path, content, overwrite=True)


def discard(path: Path) -> None:
    """Remove a file if it carries the mark of undula; leave any other file."""
    if carries_mark(path):
        path.unlink(missing_ok=True)


def renewing(path: Path) -> Claim:
    """Return a claim without a lock on a file that is renewed, in a folder that undula manages."""
    return Claim(renewed=frozenset([path]))


@contextmanager
def claimed(
    *names: Path,
    renewed: Sequence[Path] = (),
    continued: Sequence[Path] = (),
    overwrite: bool = False,
    reads: Sequence[Path] = (),
) -> Iterator[Claim]:
    """Claim and lock the output files of a command.

    Missing folders are made; those in which nothing was written are removed at the end.

    Parameters
    ----------
    names
        All files to be written.
    renewed
        Those of them that may exist if they carry the mark of undula.
    continued
        Those of them that the command continues: it reads them itself while it holds the lock.
    overwrite
        If true, any file may be replaced.
    reads
        Files that the command reads; none of them may be an output, under any name.

    Raises
    ------
    InputError
        Another process has locked a name, a file exists that must not be replaced or that the
        command reads, or a folder cannot be written or is full.
    """
    claim = Claim(frozenset(renewed), frozenset(continued), overwrite)
    _refuse_what_is_read(names, reads)
    with ExitStack() as locks:
        for path in names:
            _refuse_long(path)
            locks.enter_context(_folder_made(path))
            busy = f"another undula is at work on {path}; wait for it, or give another name"
            locks.enter_context(locked(path, busy))
        for path in names:
            claim.check_writable(path)
        yield claim


@contextmanager
def _folder_made(path: Path) -> Iterator[None]:
    folders = (path.parent, *path.parent.parents)
    with folder_errors_explained(path):
        missing = [folder for folder in folders if not os.path.lexists(folder)]
        path.parent.mkdir(parents=True, exist_ok=True)
    try:
        yield
    finally:
        with suppress(OSError):  # ends at the first folder that is not empty
            for folder in missing:
                folder.rmdir()


def _refuse_what_is_read(names: Sequence[Path], reads: Sequence[Path]) -> None:
    """Refuse an output that is an input or another output, under the same or another name."""
    pairs = [*product(names, reads), *combinations(names, 2)]
    for written, other in pairs:
        if written == other or _same(written, other):
            raise InputError(
                f"{written} is a file that this command reads or writes already; give what it"
                " writes another name, or rename what it reads"
            )


def _same(left: Path, right: Path) -> bool:
    try:
        return left.samefile(right)
    except OSError:
        return False


def _refuse_long(path: Path) -> None:
    if len(os.fsencode(path.name)) > _LONGEST - _GROWTH:
        raise InputError(f"{path.name[:40]}... is too long a name; give a shorter one")


def _mode(path: Path) -> int | None:
    """Return the mode of a file, of a link its own; None if nothing has the name."""
    try:
        return os.lstat(path).st_mode
    except FileNotFoundError:
        return None
