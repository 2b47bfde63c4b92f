"""The seal of a result file: a last line with a checksum, verified before any library reads it.

The line holds a checksum of all bytes before it. HDF5 ends where its superblock states and removes
the rest when it writes. Other programs therefore open a sealed file without noticing the line, and
a file that one of them has changed is not sealed any more.
"""

import hashlib
from enum import Enum

from undula.storage.trial_reading import is_readable

_WORD = b"\nundula sha256 "
_LENGTH = len(_WORD) + hashlib.sha256().digest_size * 2 + 1
#: Offset of the end of the file in the superblock of HDF5, by its version [bytes].
_END_OFFSETS = {0: 40, 1: 44, 2: 28, 3: 28}
#: Offset of the version in the superblock, and length of the end of the file [bytes].
_VERSION_OFFSET, _END_LENGTH = 8, 8


class Condition(Enum):
    """Result of the check of a result file."""

    WHOLE = "as they were written"
    DAMAGED = "not as they were written"
    UNCHECKED = "readable, without a checksum"


def sealed(content: bytes) -> bytes:
    """Return the bytes of a file with the seal appended."""
    return content + _line(content)


def condition(image: bytes) -> Condition:
    """Check the bytes of an HDF5 file against its seal.

    A file without a seal is readable if it ends where HDF5 states and a trial reading succeeds.
    """
    if is_whole(image):
        return Condition.WHOLE
    if image[-_LENGTH:].startswith(_WORD) or _end(image) != len(image) or not is_readable(image):
        return Condition.DAMAGED
    return Condition.UNCHECKED


def is_whole(image: bytes) -> bool:
    """Return True if the bytes of a file end with their own seal."""
    return image[-_LENGTH:] == _line(image[:-_LENGTH])


def _line(content: bytes) -> bytes:
    return _WORD + hashlib.sha256(content).hexdigest().encode() + b"\n"


def _end(image: bytes) -> int:
    """Return the length of the file according to its superblock, -1 if it states none."""
    offset = _END_OFFSETS.get(image[_VERSION_OFFSET] if len(image) > _VERSION_OFFSET else -1)
    return -1 if offset is None else int.from_bytes(image[offset : offset + _END_LENGTH], "little")
