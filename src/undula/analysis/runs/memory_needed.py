"""Memory that the samples of a run need, and memory that the process may use."""

import os
import sys
from collections.abc import Iterator
from pathlib import Path

from undula.analysis.run_settings import Schedule
from undula.errors import InputError
from undula.models.model import Model
from undula.numerics.integration.system import RATES

#: Files with the memory limit of a control group, such as a container or a batch job [bytes].
_GROUP_LIMITS = ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes")
_BYTES_PER_NUMBER = 8
#: Memory that every machine has [bytes]; hardly any run needs more.
ALWAYS_AVAILABLE = 100_000_000


def refuse_too_large(model: Model, schedule: Schedule) -> None:
    """Refuse a run whose samples do not fit in memory.

    Parameters
    ----------
    model : Model
        Model of the filament or chain.
    schedule : Schedule
        Settings of the run.

    Raises
    ------
    InputError
        The samples need more memory than the process may use.
    """
    needed = needed_memory(model, schedule)
    if needed < ALWAYS_AVAILABLE:
        return
    most = memory()
    if most is not None and needed > most:
        raise InputError(
            f"samples = {schedule.samples} of {model.links + 1} nodes take {size_text(needed)} of"
            f" memory, and {size_text(most)} are there; give fewer samples"
        )


def needed_memory(model: Model, schedule: Schedule) -> int:
    """Return the least memory that the samples of a run need.

    Parameters
    ----------
    model : Model
        Model of the filament or chain.
    schedule : Schedule
        Settings of the run.

    Returns
    -------
    int
        [bytes]
    """
    # Rows of the integrator, twice while they are concatenated, and positions of nodes.
    row = 2 * (model.position_mask.size + RATES) + 3 * (model.links + 1)
    return _BYTES_PER_NUMBER * row * int(schedule.samples) * (2 if schedule.open_ended else 1)


def memory() -> int | None:
    """Return the memory that this process may use [bytes], None if it is unknown."""
    return min(_limits(), default=None)


def _limits() -> Iterator[int]:
    try:
        yield os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        return  # this system does not report its memory
    for path in _GROUP_LIMITS:
        try:
            yield int(Path(path).read_text(encoding="ascii"))
        except (OSError, ValueError):
            continue  # this system has no such limit
    if sys.platform != "win32":
        import resource

        soft, _ = resource.getrlimit(resource.RLIMIT_AS)
        if soft != resource.RLIM_INFINITY:
            yield max(0, soft - _used_address_space())


def _used_address_space() -> int:
    """Return the address space that this process uses already [bytes]."""
    try:
        pages = Path("/proc/self/statm").read_text(encoding="ascii").split()[0]
    except OSError:
        return 0
    return int(pages) * os.sysconf("SC_PAGE_SIZE")


def size_text(size: int) -> str:
    """Return a number of bytes with a unit, as text.

    Parameters
    ----------
    size : int
        [bytes], at least 0.
    """
    for limit, unit in ((1e12, "TB"), (1e9, "GB"), (1e6, "MB")):
        if size >= limit:
            return f"{size / limit:.3g} {unit}"
    return f"{size} bytes"
