"""Own worker processes of a sweep: a Dask cluster that other accounts cannot enter.

A scheduler or a worker runs any code for its clients, and any account of a machine can connect to
its ports. The processes here therefore require a key, which is new each time and kept in memory.
The dashboard, which only displays and runs nothing, requires a secret word in its address instead.
"""

import logging
import math
import multiprocessing.resource_tracker
import secrets
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from tempfile import TemporaryDirectory
from typing import Any

import dask
from dask.system import CPU_COUNT
from distributed import Client, Nanny, Scheduler, Security, SpecCluster, Status
from distributed.system import MEMORY_LIMIT
from tornado.httputil import HTTPServerRequest
from tornado.web import ErrorHandler

from undula.errors import InputError
from undula.interrupts import END_SIGNALS

#: Number of workers that may die over a task before the task is blamed; other schedulers have
#: their own limit.
DEATHS = 10
#: Thresholds of memory allocation [bytes]. Dask makes its workers return memory at once, and
#: arrays of a megabyte then cost more to allocate than to fill: classifying a run takes three times
#: as long (docs/notes/sweeps.md).
MEMORY = {"MALLOC_MMAP_THRESHOLD_": 2**26, "MALLOC_TRIM_THRESHOLD_": 2**29}
#: Finished tasks that the scheduler remembers, instead of a hundred by default.
REMEMBERED = 4
#: Memory of a worker with all kernels and a run of usual length [bytes]; 250 to 300 MB measured.
MEMORY_OF_WORKER = 3e8
#: Most processes for each processor; more would only wait for one another.
MOST_PER_PROCESSOR = 8
#: Scheduler and workers listen on this machine only.
_HERE = {"host": "127.0.0.1", "protocol": "tls://"}
#: Loggers of Dask that report deaths of workers, which the results of their tasks show as well.
_NOISY = ("distributed", "distributed.client", "asyncio", "tornado.application")


def workers_that_fit(wanted: int | None) -> int:
    """Return the number of processes to be started.

    Parameters
    ----------
    wanted
        The number that the user asks for; None for one on each processor.

    Raises
    ------
    InputError
        The processes do not fit into the memory or on the processors.
    """
    if wanted is None:
        return max(1, min(CPU_COUNT, int(MEMORY_LIMIT / MEMORY_OF_WORKER)))
    if wanted > MOST_PER_PROCESSOR * CPU_COUNT:
        raise InputError(
            f"--workers {wanted} would take {math.ceil(wanted / MOST_PER_PROCESSOR)} processors"
            f" with {MOST_PER_PROCESSOR} processes on each, and there"
            f" {'is' if CPU_COUNT == 1 else 'are'} {CPU_COUNT}; give at most"
            f" {MOST_PER_PROCESSOR * CPU_COUNT}, best {CPU_COUNT}"
        )
    if wanted > 1 and wanted * MEMORY_OF_WORKER > MEMORY_LIMIT:
        raise InputError(
            f"--workers {wanted} would take {wanted * MEMORY_OF_WORKER / 1e9:.1f} GB of memory,"
            f" about {MEMORY_OF_WORKER / 1e6:.0f} MB each, and there are"
            f" {MEMORY_LIMIT / 1e9:.1f} GB; give at most"
            f" {max(1, int(MEMORY_LIMIT / MEMORY_OF_WORKER))}"
        )
    return wanted


@contextmanager
def own_workers(count: int) -> Iterator[tuple[Client, Callable[[], None]]]:
    """Start worker processes that end with the context.

    Parameters
    ----------
    count
        Number of processes.

    Yields
    ------
    Client
        Client of their scheduler; the processes may still be starting.
    callable
        Starts processes in place of lost ones.

    Raises
    ------
    InputError
        No folder for temporary files can be written.
    """
    silence()
    word = secrets.token_urlsafe(24)
    try:
        folder = TemporaryDirectory(prefix="undula-", ignore_cleanup_errors=True)
    except OSError as error:
        raise InputError(
            f"no folder for temporary files can be written ({error}); name one in TMPDIR"
        ) from error
    with folder as private, dask.config.set(_settings(word)):
        cluster = _cluster(count, word, private)
        with closing(cluster), closing(Client(cluster)) as client:
            cluster.scale(count)
            loop: Any = cluster.loop
            yield client, lambda: loop.add_callback(_replace_lost, cluster)


def silence() -> None:
    """Keep messages of Dask from standard error."""
    for name in _NOISY:
        logging.getLogger(name).setLevel(logging.CRITICAL)


@contextmanager
def closing(resource: Any) -> Iterator[Any]:
    """Yield a client or a cluster of Dask and close it at the end, ignoring errors of closing."""
    try:
        yield resource
    finally:
        with suppress(Exception):
            resource.close()


def _settings(word: str) -> dict[str, Any]:
    return {
        "distributed.scheduler.allowed-failures": DEATHS,
        "distributed.diagnostics.computations.max-history": REMEMBERED,
        "distributed.dashboard.link": f"{{scheme}}://{{host}}:{{port}}/{word}/status",
        "distributed.worker.http.routes": [],
        # The profile of a worker grows for as long as a sweep runs.
        "distributed.worker.profile.enabled": False,
        # A worker holds no data that could be spilled to disk, and a paused one would never
        # continue: it ends when memory runs out, and another one starts.
        "distributed.worker.memory.target": False,
        "distributed.worker.memory.spill": False,
        "distributed.worker.memory.pause": False,
    } | {f"distributed.nanny.pre-spawn-environ.{name}": value for name, value in MEMORY.items()}


class _GuardedScheduler(Scheduler):
    """A scheduler whose web pages require a secret word in their address."""

    def __init__(self, word: str, **options: Any) -> None:
        self._word = word
        super().__init__(http_prefix=f"/{word}", **options)

    def start_http_server(self, *arguments: Any, **options: Any) -> None:
        """Start the web server; it refuses every address without the word."""
        super().start_http_server(*arguments, **options)  # type: ignore[no-untyped-call]
        pages: Any = self.http_application
        find = pages.find_handler

        def guarded(request: HTTPServerRequest, **settings: Any) -> Any:
            if secrets.compare_digest(request.path.split("/")[1].encode(), self._word.encode()):
                return find(request, **settings)
            return pages.get_handler_delegate(request, ErrorHandler, {"status_code": 404})

        pages.find_handler = guarded


def _cluster(count: int, word: str, private: str) -> SpecCluster:
    """Return a scheduler without workers, whose workers ignore signals that end the driver."""
    security = Security.temporary()
    scheduler = {"word": word, "security": security, "dashboard": True, **_HERE}
    worker = {
        **_HERE,
        "nthreads": 1,
        "security": security,
        "dashboard": False,
        "silence_logs": logging.CRITICAL,
        "memory_limit": int(MEMORY_LIMIT / count),
        "local_directory": private,
    }
    # Started with blocked signals, the process that tracks shared memory survives them.
    before = signal.pthread_sigmask(signal.SIG_BLOCK, END_SIGNALS)
    multiprocessing.resource_tracker.ensure_running()
    signal.pthread_sigmask(signal.SIG_SETMASK, before)
    cluster = SpecCluster(
        # Port 0 stands for any free port.
        scheduler={
            "cls": _GuardedScheduler,
            "options": scheduler | {"dashboard_address": "127.0.0.1:0"},
        },
        worker={"cls": Nanny, "options": worker},
        security=security,
        silence_logs=logging.CRITICAL,
    )
    # Ctrl-C in a terminal and signals of batch systems reach the workers too, but the driver ends
    # them in order. They inherit the blocked signals of the thread that starts them.
    cluster.sync(_block_endings)
    return cluster


async def _block_endings() -> None:
    signal.pthread_sigmask(signal.SIG_BLOCK, END_SIGNALS)


def _replace_lost(cluster: SpecCluster) -> None:
    """Start workers in place of lost ones, in the thread of the cluster."""
    for name, nanny in list(cluster.workers.items()):
        if nanny.status in (Status.closed, Status.failed):
            del cluster.workers[name]
    cluster.scale(len(cluster.worker_spec))
