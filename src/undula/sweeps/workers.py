"""Workers for the pieces of a study: processes on this machine, or any scheduler's; on Dask."""

import asyncio
import queue
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from distributed import CancelledError, Client, Future, KilledWorker, Security, rpc
from distributed.comm.core import CommClosedError

from undula.errors import InputError
from undula.sweeps.own_workers import closing, own_workers, silence, workers_that_fit

#: Pieces for each thread that are with the workers or on their way: one to do, one to do next.
AHEAD = 2
#: Seconds between two looks at how many workers there are.
LOOK_EVERY = 1.0
#: Seconds to wait for a scheduler to answer at first, and then at each look.
PATIENCE, ANSWERS_IN = 20.0, 2.0
#: Seconds after which the want of workers is told.
TOLD_AFTER = 5.0
#: Seconds without any worker after which a study is left: of our own, which start in some; of a
#: scheduler's, which may have to wait for a machine; and without an answer from a scheduler.
OWN_PATIENCE, FOREIGN_PATIENCE, SILENCE = 60.0, 600.0, 60.0
#: Seconds between two times that workers are started in place of lost ones.
MEND_EVERY = 10.0


class LostError(Exception):
    """There is nobody left to do the pieces; `status` and `told` say who is gone.

    Both are words of an answer, as in "the study was left by its scheduler".
    """

    def __init__(self, status: str, told: str) -> None:
        super().__init__(told)
        self.status, self.told = status, told


class DiedError(Exception):
    """Every worker died that a piece was given to."""


class Pool:
    """Workers that are given pieces and give back what they came to, in any order.

    Parameters
    ----------
    client
        How to reach them.
    say
        Called with a sentence if there are none for a while.
    count
        How many there should be; None if that is not known.
    mend
        Starts others in place of those that are gone.
    """

    def __init__(
        self,
        client: Client,
        say: Callable[[str], None],
        count: int | None = None,
        mend: Callable[[], None] = lambda: None,
    ) -> None:
        self._client, self._say, self._count, self._mend = client, say, count, mend
        self._patience = FOREIGN_PATIENCE if count is None else OWN_PATIENCE
        self._finished: queue.SimpleQueue[Future[Any]] = queue.SimpleQueue()
        self._pieces: dict[Future[Any], Any] = {}
        now = time.monotonic()
        self._threads, self._look_due, self._mend_due = 0, now, now + MEND_EVERY
        self._answered, self._served, self._told = now, now, False

    @property
    def busy(self) -> bool:
        """Whether a piece has been given away and has not come back."""
        return bool(self._pieces)

    @property
    def has_room(self) -> bool:
        """Whether a worker would soon have nothing to do.

        Raises
        ------
        LostError
            The scheduler is gone, or there have been no workers for long.
        """
        self._look()
        # Pieces are ready for workers that are still to come.
        return len(self._pieces) < AHEAD * max(1, self._threads)

    def give(self, piece: Any, work: Callable[..., Any], *what: Any) -> None:
        """Send a piece away: what the work on it is to be called with, in plain types.

        Raises
        ------
        LostError
            The scheduler is gone.
        """
        with self._reached():
            future = self._client.submit(work, *what, pure=False)
        self._pieces[future] = piece
        future.add_done_callback(self._finished.put)

    def come_back(self, patience: float) -> Iterator[tuple[Any, Any]]:
        """Yield pieces that have come back, each with its result, after so many seconds at most.

        A piece under which every worker died comes back with a `DiedError`.

        Raises
        ------
        LostError
            The scheduler is gone, or there have been no workers for long.
        InputError
            The workers cannot run undula.
        """
        self._look()
        try:
            ready = [self._finished.get(timeout=patience)]
        except queue.Empty:
            return
        while not self._finished.empty():
            ready.append(self._finished.get())
        for future in ready:
            yield self._pieces.pop(future), _outcome(future)

    def _look(self) -> None:
        """Count the workers every now and then, and do something about lost ones."""
        now = time.monotonic()
        if now < self._look_due:
            return
        self._count_threads(now)
        now = time.monotonic()
        self._look_due = now + LOOK_EVERY
        if now - self._answered > SILENCE:
            raise _no_scheduler()
        if now - self._served > self._patience:
            raise LostError("no workers", "left without workers")
        if now - self._served > TOLD_AFTER and not self._told and self._count is None:
            self._told = True
            self._say(f"the scheduler has no workers; waiting for {self._patience:g} s for some")
        if self._count is not None and self._threads < self._count and now > self._mend_due:
            self._mend_due = now + MEND_EVERY
            self._mend()

    def _count_threads(self, now: float) -> None:
        try:
            with self._reached():
                scheduler: Any = self._client.scheduler
                # Those that pause have run out of memory and take no more.
                threads = self._client.sync(
                    scheduler.ncores_running, workers=None, callback_timeout=ANSWERS_IN
                )
        except TimeoutError:
            return
        self._answered, self._threads = now, sum(threads.values())
        if self._threads:
            self._served, self._told = now, False

    @contextmanager
    def _reached(self) -> Iterator[None]:
        """Tell whatever a client raises that has lost its scheduler."""
        try:
            yield
        except Exception as error:
            gone = isinstance(error, OSError) and not isinstance(error, TimeoutError)
            if gone or self._client.status != "running":
                raise _no_scheduler() from error
            raise
        if self._client.status != "running":
            # It tries to come back, but whoever was there has forgotten all pieces.
            raise _no_scheduler()


def _no_scheduler() -> LostError:
    return LostError("scheduler lost", "left by its scheduler")


def _outcome(future: Future[Any]) -> Any:
    if future.cancelled():
        raise _no_scheduler()
    try:
        return future.result()
    except KilledWorker as error:
        return DiedError(str(error))
    except (CancelledError, CommClosedError) as error:
        raise _no_scheduler() from error
    except ImportError as error:
        raise InputError(
            f"the workers cannot import undula ({error}); install the same version there"
        ) from error


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
        Called with a sentence on where the dashboard is, and if there are no workers.

    Raises
    ------
    InputError
        There is no scheduler at the address, or so many workers do not fit.
    """
    if scheduler is None:
        count = workers_that_fit(workers)
        with own_workers(count) as (client, mend):
            say(f"dashboard: {client.dashboard_link}")
            yield Pool(client, say, count, mend)
        return
    with closing(_client_of(scheduler)) as client:
        if client.dashboard_link:
            say(f"dashboard: {client.dashboard_link}")
        yield Pool(client, say)


def _client_of(scheduler: str) -> Client:
    silence()
    try:
        # A client waits for ever for a scheduler that takes its call and says nothing.
        asyncio.run(asyncio.wait_for(_call(scheduler), PATIENCE))
        return Client(scheduler, timeout=PATIENCE)
    except (OSError, ValueError) as error:
        raise InputError(
            f"no Dask scheduler answers at --scheduler {scheduler} ({error}); check the address"
        ) from error


async def _call(scheduler: str) -> None:
    arguments = Security().get_connection_args("client")
    async with rpc(scheduler, timeout=PATIENCE, connection_args=arguments) as there:
        await there.identity()
