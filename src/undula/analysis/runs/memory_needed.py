"""What a run takes of memory, told before it begins, and what there is."""

import os
import sys
from collections.abc import Iterator
from pathlib import Path

from undula.analysis.run_settings import Schedule
from undula.errors import InputError
from undula.models.model import Model
from undula.numerics.integration.system import RATES

#: Limits of the group of processes, as of a container or of a job of a batch system.
_GROUP_LIMITS = ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes")
_NUMBER = 8
#: So many bytes are there, wherever a run is begun; nearly none takes more.
LITTLE = 100_000_000


def refuse_too_large(model: Model, schedule: Schedule) -> None:
    """Refuse a run whose samples cannot fit in memory.

    Raises
    ------
    InputError
        It would take more than there is.
    """
    needed = needed_memory(model, schedule)
    if needed < LITTLE:
        return
    most = memory()
    if most is not None and needed > most:
        raise InputError(
            f"samples = {schedule.samples} of {model.links + 1} nodes take {told_size(needed)} of"
            f" memory, and {told_size(most)} are there; give fewer samples"
        )


def needed_memory(model: Model, schedule: Schedule) -> int:
    """Return the bytes that the samples of a run take at least."""
    # Rows of the integrator, twice as they are put together, and positions of nodes.
    row = 2 * (model.position_mask.size + RATES) + 3 * (model.links + 1)
    return _NUMBER * row * int(schedule.samples) * (2 if schedule.open_ended else 1)


def memory() -> int | None:
    """Return the bytes of memory that this process may have, None where that is not known."""
    return min(_limits(), default=None)


def _limits() -> Iterator[int]:
    try:
        yield os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        return  # no system that tells
    for path in _GROUP_LIMITS:
        try:
            yield int(Path(path).read_text(encoding="ascii"))
        except (OSError, ValueError):
            continue  # there is no such limit
    if sys.platform != "win32":
        import resource

        soft, _ = resource.getrlimit(resource.RLIMIT_AS)
        if soft != resource.RLIM_INFINITY:
            yield max(0, soft - _taken())


def _taken() -> int:
    """Return the bytes of address space that this process has taken already."""
    try:
        pages = Path("/proc/self/statm").read_text(encoding="ascii").split()[0]
    except OSError:
        return 0
    return int(pages) * os.sysconf("SC_PAGE_SIZE")


def told_size(size: int) -> str:
    """Return a number of bytes in words."""
    for limit, unit in ((1e12, "TB"), (1e9, "GB"), (1e6, "MB")):
        if size >= limit:
            return f"{size / limit:.3g} {unit}"
    return f"{size} bytes"
