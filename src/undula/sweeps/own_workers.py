"""Processes of our own that do pieces of a study: a Dask cluster that nobody else can enter.

Whoever can talk to a scheduler or a worker can have it run any code. Any account of a machine can
connect to its ports, so that ours ask for a key which is made anew each time and kept in memory.
The dashboard, which tells and runs nothing, asks for a word in its address instead.
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
from undula.interrupts import ENDINGS

#: So many workers of our own may die under a piece before it is blamed. Others have their own rule.
DEATHS = 10
#: Dask has its workers give back memory as soon as they can, and arrays of a megabyte then cost
#: more to allocate than to fill: judging a run takes three times as long (docs/notes/sweeps.md).
MEMORY = {"MALLOC_MMAP_THRESHOLD_": 2**26, "MALLOC_TRIM_THRESHOLD_": 2**29}
#: Pieces that the scheduler remembers when they are done: it would keep a hundred.
REMEMBERED = 4
#: Bytes that a worker takes with all kernels and a run of usual length: 250 to 300 MB were seen.
TAKES = 3e8
#: Processes for each processor beyond which more of them only wait for one another.
MOST = 8
#: All listen on this machine only.
_HERE = {"host": "127.0.0.1", "protocol": "tls://"}
#: What Dask says of the deaths of workers is told by what becomes of their pieces.
_NOISY = ("distributed", "distributed.client", "asyncio", "tornado.application")


def workers_that_fit(asked: int | None) -> int:
    """Return the number of processes to be started, by default one for each processor.

    Raises
    ------
    InputError
        So many do not fit into the memory or on the processors.
    """
    if asked is None:
        return max(1, min(CPU_COUNT, int(MEMORY_LIMIT / TAKES)))
    if asked > MOST * CPU_COUNT:
        raise InputError(
            f"--workers {asked} would take {math.ceil(asked / MOST)} processors with {MOST}"
            f" processes on each, and there {'is' if CPU_COUNT == 1 else 'are'} {CPU_COUNT}; give"
            f" at most {MOST * CPU_COUNT}, best {CPU_COUNT}"
        )
    if asked > 1 and asked * TAKES > MEMORY_LIMIT:
        raise InputError(
            f"--workers {asked} would take {asked * TAKES / 1e9:.1f} GB of memory, about"
            f" {TAKES / 1e6:.0f} MB each, and there are {MEMORY_LIMIT / 1e9:.1f} GB; give at most"
            f" {max(1, int(MEMORY_LIMIT / TAKES))}"
        )
    return asked


@contextmanager
def own_workers(count: int) -> Iterator[tuple[Client, Callable[[], None]]]:
    """Yield a client of so many processes, which are still to come, and what starts lost ones anew.

    Raises
    ------
    InputError
        There is no folder for temporary files.
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
            yield client, lambda: loop.add_callback(_start_lost_ones, cluster)


def silence() -> None:
    """Keep what Dask has to say from standard error."""
    for name in _NOISY:
        logging.getLogger(name).setLevel(logging.CRITICAL)


@contextmanager
def closing(thing: Any) -> Iterator[Any]:
    """Yield something of Dask's that is closed at the end, which may well be gone by then."""
    try:
        yield thing
    finally:
        with suppress(Exception):
            thing.close()


def _settings(word: str) -> dict[str, Any]:
    return {
        "distributed.scheduler.allowed-failures": DEATHS,
        "distributed.diagnostics.computations.max-history": REMEMBERED,
        "distributed.dashboard.link": f"{{scheme}}://{{host}}:{{port}}/{word}/status",
        "distributed.worker.http.routes": [],
        # Its record of what has been at work grows for as long as a study takes.
        "distributed.worker.profile.enabled": False,
        # A worker keeps nothing that could be put on disk, and one that pauses never goes on: it
        # ends where memory ends, and another begins.
        "distributed.worker.memory.target": False,
        "distributed.worker.memory.spill": False,
        "distributed.worker.memory.pause": False,
    } | {f"distributed.nanny.pre-spawn-environ.{name}": value for name, value in MEMORY.items()}


class _GuardedScheduler(Scheduler):
    """A scheduler whose pages are found by whoever knows the word in their address."""

    def __init__(self, word: str, **options: Any) -> None:
        self._word = word
        super().__init__(http_prefix=f"/{word}", **options)

    def start_http_server(self, *what: Any, **options: Any) -> None:
        """Refuse every address without the word from the first request on."""
        super().start_http_server(*what, **options)  # type: ignore[no-untyped-call]
        pages: Any = self.http_application
        find = pages.find_handler

        def guarded(request: HTTPServerRequest, **how: Any) -> Any:
            if secrets.compare_digest(request.path.split("/")[1].encode(), self._word.encode()):
                return find(request, **how)
            return pages.get_handler_delegate(request, ErrorHandler, {"status_code": 404})

        pages.find_handler = guarded


def _cluster(count: int, word: str, private: str) -> SpecCluster:
    """Return a scheduler without workers, whose workers will not hear what ends the driver."""
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
    # The process that watches over shared memory outlives signals only if it is begun so.
    before = signal.pthread_sigmask(signal.SIG_BLOCK, ENDINGS)
    multiprocessing.resource_tracker.ensure_running()
    signal.pthread_sigmask(signal.SIG_SETMASK, before)
    cluster = SpecCluster(
        # Any port that is free.
        scheduler={
            "cls": _GuardedScheduler,
            "options": scheduler | {"dashboard_address": "127.0.0.1:0"},
        },
        worker={"cls": Nanny, "options": worker},
        security=security,
        silence_logs=logging.CRITICAL,
    )
    # Ctrl-C in a terminal, and what batch systems send, reach workers too; it is the driver that
    # ends them in order. They inherit what the thread does not hear that starts them.
    cluster.sync(_hear_no_endings)
    return cluster


async def _hear_no_endings() -> None:
    signal.pthread_sigmask(signal.SIG_BLOCK, ENDINGS)


def _start_lost_ones(cluster: SpecCluster) -> None:
    """Start workers in place of those that are given up, in the thread of the cluster."""
    for name, nanny in list(cluster.workers.items()):
        if nanny.status in (Status.closed, Status.failed):
            del cluster.workers[name]
    cluster.scale(len(cluster.worker_spec))
