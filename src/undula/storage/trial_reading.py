"""Trial reading, in a separate process, of HDF5 files without a checksum.

Zeros or flipped bits at some places send HDF5 into an endless loop, make it allocate all memory or
end the process. A separate process may be ended or die without harm.
"""

import hashlib
import os
import subprocess
import sys
from functools import cache
from io import BytesIO
from typing import Any

#: Processor time that the reading may take [s], and further time for each byte [s].
_SECONDS, _SECONDS_A_BYTE = 5, 1e-7
#: Longest wall time over processor time, on a busy machine.
_PATIENCE = 10
#: Bound on the compression of zeros by HDF5, and allowance for small files [bytes].
_MOST_COMPRESSED, _ALLOWANCE = 1100, 2**20


def is_readable(image: bytes) -> bool:
    """Return True if HDF5 reads all content of a file in bounded time and memory."""
    digest = hashlib.sha256(image).digest()
    if digest not in _results():
        _results()[digest] = _succeeds(image)
    return _results()[digest]


@cache
def _results() -> dict[bytes, bool]:
    """Return earlier results by digest, since some commands read a file several times."""
    return {}


def _succeeds(image: bytes) -> bool:
    limit = _SECONDS + int(len(image) * _SECONDS_A_BYTE)
    # With -P nothing is imported from the working folder, whose files may not be trusted.
    command = [sys.executable, "-P", "-m", __name__, str(limit)]
    # The process finds the same packages as this one.
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    quiet: Any = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "env": environment}
    try:
        completed = subprocess.run(
            command, input=image, timeout=limit * _PATIENCE, check=False, **quiet
        )
    except subprocess.TimeoutExpired:
        return False
    return completed.returncode == 0


def _read_all(image: bytes) -> None:
    """Read every number and attribute of an HDF5 file.

    Raises
    ------
    MemoryError
        The file claims to hold more than its bytes can.
    Exception
        The file cannot be read; the HDF5 stack may raise almost any exception.
    """
    import h5py

    most = len(image) * _MOST_COMPRESSED + _ALLOWANCE

    def read(_: str, node: Any) -> None:
        nonlocal most
        dict(node.attrs)
        if isinstance(node, h5py.Dataset):
            most -= node.nbytes
            if most < 0:
                raise MemoryError
            node[()]

    with h5py.File(BytesIO(image), "r") as root:
        dict(root.attrs)
        root.visititems(read)


if __name__ == "__main__":
    import resource

    seconds = int(sys.argv[1])
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    _read_all(sys.stdin.buffer.read())
