"""The line behind a result file by which damage is told before any library reads a byte.

It holds a checksum of all that is before it. HDF5 ends where its superblock says and cuts off the
rest when it writes: other programs open such a file as if the line were not there, and a file that
one of them has changed carries none.
"""

import hashlib
from enum import Enum

from undula.storage.trial_reading import is_readable

_WORD = b"\nundula sha256 "
_LENGTH = len(_WORD) + hashlib.sha256().digest_size * 2 + 1
#: Where the superblock of HDF5 holds the end of the file, by its version.
_END_AT = {0: 40, 1: 44, 2: 28, 3: 28}
_VERSION_AT, _END_BYTES = 8, 8


class Condition(Enum):
    """What is known of the bytes of a result file."""

    WHOLE = "as they were written"
    DAMAGED = "not as they were written"
    UNCHECKED = "readable, without a checksum"


def sealed(content: bytes) -> bytes:
    """Return the bytes of a file with the line behind them."""
    return content + _line(content)


def condition(image: bytes) -> Condition:
    """Hold the bytes of an HDF5 file against the line behind them.

    Without a line they are readable if they end where HDF5 does and a reading on trial succeeds.
    """
    if is_whole(image):
        return Condition.WHOLE
    if image[-_LENGTH:].startswith(_WORD) or _end(image) != len(image) or not is_readable(image):
        return Condition.DAMAGED
    return Condition.UNCHECKED


def is_whole(image: bytes) -> bool:
    """Tell whether the bytes of a file carry a line, and are those that it was made for."""
    return image[-_LENGTH:] == _line(image[:-_LENGTH])


def _line(content: bytes) -> bytes:
    return _WORD + hashlib.sha256(content).hexdigest().encode() + b"\n"


def _end(image: bytes) -> int:
    """Return where HDF5 says that its file ends, -1 if it does not say."""
    at = _END_AT.get(image[_VERSION_AT] if len(image) > _VERSION_AT else -1)
    return -1 if at is None else int.from_bytes(image[at : at + _END_BYTES], "little")
