"""A name on disk that one process has for itself, until it gives it back or ends.

The lock is one of the system on a file beside the name, so that it ends with the process however
that ends. The file holds a mark, by which it is known for ours: it goes with the lock, one that a
killed process has left is taken over, and one that somebody else has made is left as it is.
"""

import errno
import fcntl
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from undula.errors import InputError
from undula.storage.atomic import folder_trouble_told

_MARK = b"a lock of undula\n"
#: File systems without locks: better to write there unguarded than not at all.
_WITHOUT_LOCKS = (errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP)


@contextmanager
def locked(path: Path, busy: str, *, lock: Path | None = None) -> Iterator[None]:
    """Have a name, in a folder that is there, for this process alone.

    Parameters
    ----------
    path
        The name.
    busy
        The sentence if another process has it.
    lock
        The file whose lock stands for the name; by default beside it.

    Raises
    ------
    InputError
        Another process has it, the folder cannot be written or is full, or the place of the lock is
        taken by a link or by something else than a file.
    """
    lock = lock or path.with_name(f".{path.name}.lock")
    with folder_trouble_told(path):
        descriptor = _taken(lock)
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


def _taken(lock: Path) -> int | None:
    """Return the locked file; None if another process has it."""
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
        # Its last holder has removed it after it was opened here.
        os.close(descriptor)


def _is_still_there(descriptor: int, lock: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(descriptor), os.lstat(lock))
    except FileNotFoundError:
        return False


def _mark(descriptor: int) -> None:
    if os.fstat(descriptor).st_size == 0:
        os.write(descriptor, _MARK)


def _holds_mark(descriptor: int) -> bool:
    return os.pread(descriptor, len(_MARK) + 1, 0) == _MARK
