"""Workers for the pieces of a study: processes on this machine, or any scheduler's; on Dask."""

import logging
import queue
import signal
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import dask
from dask.system import CPU_COUNT
from distributed import (
    CancelledError,
    Client,
    Future,
    KilledWorker,
    LocalCluster,
    Worker,
    WorkerPlugin,
)
from distributed.comm.core import CommClosedError

from undula.errors import InputError

#: Pieces for each thread that are with the workers or on their way: one to do, one to do next.
AHEAD = 2
#: Seconds between two looks at how many workers there are.
LOOK_EVERY = 1.0
#: So many workers of our own may die under a piece before it is blamed. Others have their own rule.
DEATHS = 10
#: Dask has its workers give back memory as soon as they can, and arrays of a megabyte then cost
#: more to allocate than to fill: judging a run takes three times as long (docs/notes/sweeps.md).
MEMORY = {"MALLOC_MMAP_THRESHOLD_": 2**26, "MALLOC_TRIM_THRESHOLD_": 2**29}
#: Pieces that the scheduler remembers when they are done: it would keep a hundred.
REMEMBERED = 4
#: Times that workers of our own are started if one dies meanwhile.
STARTS = 5
#: Seconds to wait for a scheduler to answer.
PATIENCE = 20.0


class LostError(Exception):
    """The scheduler is gone."""


class DiedError(Exception):
    """Every worker died that a piece was given to."""


class Pool:
    """Workers that are given pieces and give back what they came to, in any order."""

    def __init__(self, client: Client) -> None:
        self._client = client
        self._finished: queue.SimpleQueue[Future[Any]] = queue.SimpleQueue()
        self._pieces: dict[Future[Any], Any] = {}
        self._threads, self._look_due = 0, 0.0

    @property
    def busy(self) -> bool:
        """Whether a piece has been given away and has not come back."""
        return bool(self._pieces)

    @property
    def has_room(self) -> bool:
        """Whether a worker would soon have nothing to do."""
        now = time.monotonic()
        if now >= self._look_due:
            self._threads = sum(self._client.nthreads().values())
            self._look_due = now + LOOK_EVERY
        # Pieces are ready for workers that are still to come.
        return len(self._pieces) < AHEAD * max(1, self._threads)

    def give(self, piece: Any, work: Callable[..., Any], *what: Any) -> None:
        """Send a piece away: what the work on it is to be called with, in plain types."""
        future = self._client.submit(work, *what, pure=False)
        self._pieces[future] = piece
        future.add_done_callback(self._finished.put)

    def come_back(self, patience: float) -> Iterator[tuple[Any, Any]]:
        """Yield pieces that have come back, each with its result, after so many seconds at most.

        A piece under which every worker died comes back with a `DiedError`.

        Raises
        ------
        LostError
            The scheduler is gone.
        InputError
            The workers cannot run undula.
        """
        try:
            ready = [self._finished.get(timeout=patience)]
        except queue.Empty:
            return
        while not self._finished.empty():
            ready.append(self._finished.get())
        for future in ready:
            yield self._pieces.pop(future), _outcome(future)


def _outcome(future: Future[Any]) -> Any:
    try:
        return future.result()
    except KilledWorker as error:
        return DiedError(str(error))
    except (CancelledError, CommClosedError) as error:
        raise LostError from error
    except ImportError as error:
        raise InputError(
            f"the workers cannot import undula ({error}); install the same version there"
        ) from error


class _LetDriverStop(WorkerPlugin):
    """Ctrl-C in a terminal reaches workers too; it is the driver that ends them in order."""

    def setup(self, worker: Worker) -> None:  # noqa: ARG002
        signal.signal(signal.SIGINT, signal.SIG_IGN)


@contextmanager
def pool(workers: int | None, scheduler: str | None, say: Callable[[str], None]) -> Iterator[Pool]:
    """Yield workers, and let go of them at the end.

    Parameters
    ----------
    workers
        Number of processes on this machine; by default one for each processor.
    scheduler
        Address of a running Dask scheduler, whose workers are used instead.
    say
        Called with a sentence on where the dashboard is.

    Raises
    ------
    InputError
        There is no scheduler at the address.
    """
    with _client(workers, scheduler) as client:
        if client.dashboard_link:
            say(f"dashboard: {client.dashboard_link}")
        yield Pool(client)


@contextmanager
def _client(workers: int | None, scheduler: str | None) -> Iterator[Client]:
    # What workers say of their own deaths is told by what becomes of their pieces.
    for name in ("distributed", "distributed.client"):
        logging.getLogger(name).setLevel(logging.CRITICAL)
    if scheduler is not None:
        try:
            client = Client(scheduler, timeout=PATIENCE)
        except (OSError, ValueError) as error:
            raise InputError(
                f"no Dask scheduler answers at --scheduler {scheduler} ({error}); check the address"
            ) from error
        with client:
            yield client
        return
    settings = {
        "distributed.scheduler.allowed-failures": DEATHS,
        "distributed.diagnostics.computations.max-history": REMEMBERED,
    } | {f"distributed.nanny.pre-spawn-environ.{name}": value for name, value in MEMORY.items()}
    with (
        dask.config.set(settings),
        _cluster(workers or CPU_COUNT) as cluster,
        Client(cluster) as client,
    ):
        client.register_plugin(_LetDriverStop())
        yield client


def _cluster(workers: int, starts: int = STARTS) -> LocalCluster:
    try:
        return LocalCluster(
            n_workers=workers,
            threads_per_worker=1,
            processes=True,
            # Any port that is free; the first choice might be taken.
            dashboard_address="127.0.0.1:0",
            silence_logs=logging.CRITICAL,
        )
    except RuntimeError:
        # A worker that dies while it starts ends the start of all.
        if starts == 1:
            raise
    return _cluster(workers, starts - 1)
