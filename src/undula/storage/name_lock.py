"""Lock on a file name, held by one process until it releases it or ends.

The operating system locks a file next to the name, so that the lock ends with the process in every
case. The lock file carries a mark of undula. It is removed with the lock; one left by a killed
process is used again, and one without the mark is not removed.
"""

import errno
import fcntl
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from undula.errors import InputError
from undula.storage.atomic import folder_errors_explained

_MARK = b"a lock of undula\n"
#: Errors of file systems without locks, where files are written unguarded.
_WITHOUT_LOCKS = (errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP)


@contextmanager
def locked(path: Path, busy: str, *, lock: Path | None = None) -> Iterator[None]:
    """Hold the lock on a name in an existing folder.

    Parameters
    ----------
    path
        The name.
    busy
        Sentence of the error if another process holds the lock.
    lock
        The lock file; by default a hidden file next to the name.

    Raises
    ------
    InputError
        Another process holds the lock, the folder cannot be written or is full, or the lock file is
        a link or not a plain file.
    """
    lock = lock or path.with_name(f".{path.name}.lock")
    with folder_errors_explained(path):
        descriptor = _acquired(lock)
        if descriptor is not None:
            _mark(descriptor)
    if descriptor is None:
        raise InputError(busy)
    try:
        yield
    finally:
        if _holds_mark(descriptor):
            with suppress(OSError):
                os.unlink(lock)
        os.close(descriptor)


def _acquired(lock: Path) -> int | None:
    """Return the descriptor of the locked file; None if another process holds the lock."""
    flags = os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC
    while True:
        if lock.is_symlink():
            raise InputError(f"{lock} is a link; remove it, undula has a file there to lock by")
        descriptor = os.open(lock, flags, 0o666)
        try:
            if not stat.S_ISREG(os.fstat(descriptor).st_mode):
                raise InputError(f"{lock} is no plain file; move it away, undula locks by it")
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(descriptor)
            return None
        except (OSError, InputError) as error:
            if getattr(error, "errno", None) not in _WITHOUT_LOCKS:
                os.close(descriptor)
                raise
        if _is_still_there(descriptor, lock):
            return descriptor
        # The last holder of the lock has removed the file after it was opened here.
        os.close(descriptor)


def _is_still_there(descriptor: int, lock: Path) -> bool:
    """Return True if the name of the lock still belongs to the opened file."""
    try:
        return os.path.samestat(os.fstat(descriptor), os.lstat(lock))
    except FileNotFoundError:
        return False


def _mark(descriptor: int) -> None:
    """Write the mark of undula into a new lock file."""
    if os.fstat(descriptor).st_size == 0:
        os.write(descriptor, _MARK)


def _holds_mark(descriptor: int) -> bool:
    return os.pread(descriptor, len(_MARK) + 1, 0) == _MARK
