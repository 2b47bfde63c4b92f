"""A reading on trial, in a process of its own, of HDF5 files that carry no checksum.

Zeros or flipped bits at the wrong place send HDF5 into an endless loop, make it ask for all memory
or end the process. A process of its own can be ended and can die.
"""

import hashlib
import os
import subprocess
import sys
from functools import cache
from io import BytesIO
from typing import Any

#: Seconds of the processor that the reading may take, and further ones for each byte.
_SECONDS, _SECONDS_A_BYTE = 5, 1e-7
#: The clock may run so many times as long, on a machine with much else to do.
_PATIENCE = 10
#: No compression of HDF5 makes zeros shorter than by this factor; slack for files of few bytes.
_MOST_COMPRESSED, _SLACK = 1100, 2**20


def is_readable(image: bytes) -> bool:
    """Tell whether HDF5 reads everything in a file, in bounded time and memory."""
    digest = hashlib.sha256(image).digest()
    if digest not in _known():
        _known()[digest] = _tried(image)
    return _known()[digest]


@cache
def _known() -> dict[bytes, bool]:
    """Return what is known already, by digest: a file is read several times by some commands."""
    return {}


def _tried(image: bytes) -> bool:
    limit = _SECONDS + int(len(image) * _SECONDS_A_BYTE)
    # Nothing is imported from the working folder, whose files may be anybody's.
    command = [sys.executable, "-P", "-m", __name__, str(limit)]
    # The other process finds the same packages, wherever this one has them from.
    found = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    quiet: Any = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "env": found}
    try:
        tried = subprocess.run(
            command, input=image, timeout=limit * _PATIENCE, check=False, **quiet
        )
    except subprocess.TimeoutExpired:
        return False
    return tried.returncode == 0


def _read_all(image: bytes) -> None:
    """Read every number and attribute of an HDF5 file.

    Raises
    ------
    MemoryError
        It claims to hold more than can be in so few bytes.
    Exception
        It cannot be read: of the HDF5 stack nearly any may come.
    """
    import h5py

    most = len(image) * _MOST_COMPRESSED + _SLACK

    def read(_: str, found: Any) -> None:
        nonlocal most
        dict(found.attrs)
        if isinstance(found, h5py.Dataset):
            most -= found.nbytes
            if most < 0:
                raise MemoryError
            found[()]

    with h5py.File(BytesIO(image), "r") as root:
        dict(root.attrs)
        root.visititems(read)


if __name__ == "__main__":
    import resource

    seconds = int(sys.argv[1])
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    _read_all(sys.stdin.buffer.read())
