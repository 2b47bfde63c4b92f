"""Workers for the tasks of a sweep, on Dask: processes of this machine or of any scheduler."""

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

#: Tasks for each thread that are at the workers or on their way: one in work, one to be next.
AHEAD = 2
#: Time between two counts of the workers [s].
COUNT_EVERY = 1.0
#: Time to wait for a scheduler to answer, at first and at each count of the workers [s].
PATIENCE, ANSWERS_IN = 20.0, 2.0
#: Time without workers after which the user is notified [s].
NOTIFY_AFTER = 5.0
#: Times after which a sweep is stopped [s]: without own workers, which start within seconds;
#: without workers of another scheduler, which may wait for a machine; without its answer.
OWN_PATIENCE, FOREIGN_PATIENCE, SILENCE = 60.0, 600.0, 60.0
#: Time between two replacements of lost workers [s].
REPLACE_EVERY = 10.0


class LostError(Exception):
    """No worker is left for the tasks.

    Attributes
    ----------
    status
        Status of the answer, such as "scheduler lost".
    text
        Words for people, as in "the study was left by its scheduler".
    """

    def __init__(self, status: str, text: str) -> None:
        super().__init__(text)
        self.status, self.text = status, text


class DiedError(Exception):
    """Every worker that was given a task has died."""


class Pool:
    """Workers that take tasks and return their results in any order.

    Parameters
    ----------
    client
        Dask client of their scheduler.
    say
        Called with a sentence if there are no workers for a while.
    count
        Wanted number of workers; None if it is unknown.
    replace_lost
        Starts workers in place of lost ones.
    """

    def __init__(
        self,
        client: Client,
        say: Callable[[str], None],
        count: int | None = None,
        replace_lost: Callable[[], None] = lambda: None,
    ) -> None:
        self._client, self._say, self._count = client, say, count
        self._replace_lost = replace_lost
        self._patience = FOREIGN_PATIENCE if count is None else OWN_PATIENCE
        self._finished: queue.SimpleQueue[Future[Any]] = queue.SimpleQueue()
        self._tasks: dict[Future[Any], Any] = {}
        now = time.monotonic()
        self._threads, self._count_due, self._replace_due = 0, now, now + REPLACE_EVERY
        self._answered, self._served, self._notified = now, now, False

    @property
    def busy(self) -> bool:
        """True while a task is at the workers."""
        return bool(self._tasks)

    @property
    def has_room(self) -> bool:
        """True if a worker would soon be idle.

        Raises
        ------
        LostError
            The scheduler is gone, or there have been no workers for long.
        """
        self._check_workers()
        # One thread is assumed while workers are still starting.
        return len(self._tasks) < AHEAD * max(1, self._threads)

    def give(self, task: Any, function: Callable[..., Any], *arguments: Any) -> None:
        """Send a task to the workers.

        Parameters
        ----------
        task
            Any object; `come_back` yields it with the result.
        function, arguments
            Called by a worker; the arguments are plain types.

        Raises
        ------
        LostError
            The scheduler is gone.
        """
        with self._reached():
            future = self._client.submit(function, *arguments, pure=False)
        self._tasks[future] = task
        future.add_done_callback(self._finished.put)

    def come_back(self, patience: float) -> Iterator[tuple[Any, Any]]:
        """Yield the finished tasks with their results, after at most `patience` seconds.

        The result of a task is a `DiedError` if every worker that was given it has died.

        Raises
        ------
        LostError
            The scheduler is gone, or there have been no workers for long.
        InputError
            The workers cannot run undula.
        """
        self._check_workers()
        try:
            ready = [self._finished.get(timeout=patience)]
        except queue.Empty:
            return
        while not self._finished.empty():
            ready.append(self._finished.get())
        for future in ready:
            yield self._tasks.pop(future), _outcome(future)

    def _check_workers(self) -> None:
        """Count the workers every `COUNT_EVERY` seconds, and replace lost ones."""
        now = time.monotonic()
        if now < self._count_due:
            return
        self._count_threads(now)
        now = time.monotonic()
        self._count_due = now + COUNT_EVERY
        if now - self._answered > SILENCE:
            raise _no_scheduler()
        if now - self._served > self._patience:
            raise LostError("no workers", "left without workers")
        if now - self._served > NOTIFY_AFTER and not self._notified and self._count is None:
            self._notified = True
            self._say(f"the scheduler has no workers; waiting for {self._patience:g} s for some")
        if self._count is not None and self._threads < self._count and now > self._replace_due:
            self._replace_due = now + REPLACE_EVERY
            self._replace_lost()

    def _count_threads(self, now: float) -> None:
        try:
            with self._reached():
                scheduler: Any = self._client.scheduler
                # Paused workers, which have run out of memory and take no tasks, do not count.
                threads = self._client.sync(
                    scheduler.ncores_running, workers=None, callback_timeout=ANSWERS_IN
                )
        except TimeoutError:
            return
        self._answered, self._threads = now, sum(threads.values())
        if self._threads:
            self._served, self._notified = now, False

    @contextmanager
    def _reached(self) -> Iterator[None]:
        """Turn any error of a client that has lost its scheduler into a `LostError`."""
        try:
            yield
        except Exception as error:
            gone = isinstance(error, OSError) and not isinstance(error, TimeoutError)
            if gone or self._client.status != "running":
                raise _no_scheduler() from error
            raise
        if self._client.status != "running":
            # The client tries to reconnect, but a new scheduler does not know the tasks.
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
    """Yield workers that are released at the end.

    Parameters
    ----------
    workers
        Number of processes on this machine; None for one on each processor.
    scheduler
        Address of a running Dask scheduler, whose workers are used instead; None for processes of
        this machine.
    say
        Called with the address of the dashboard, and with a sentence if there are no workers.

    Raises
    ------
    InputError
        No scheduler answers at the address, or the workers do not fit into memory.
    """
    if scheduler is None:
        count = workers_that_fit(workers)
        with own_workers(count) as (client, replace_lost):
            say(f"dashboard: {client.dashboard_link}")
            yield Pool(client, say, count, replace_lost)
        return
    with closing(_client_of(scheduler)) as client:
        if client.dashboard_link:
            say(f"dashboard: {client.dashboard_link}")
        yield Pool(client, say)


def _client_of(scheduler: str) -> Client:
    silence()
    try:
        # A client waits forever for a scheduler that accepts the connection and does not answer.
        asyncio.run(asyncio.wait_for(_call(scheduler), PATIENCE))
        return Client(scheduler, timeout=PATIENCE)
    except (OSError, ValueError) as error:
        raise InputError(
            f"no Dask scheduler answers at --scheduler {scheduler} ({error}); check the address"
        ) from error


async def _call(scheduler: str) -> None:
    arguments = Security().get_connection_args("client")
    async with rpc(scheduler, timeout=PATIENCE, connection_args=arguments) as remote:
        await remote.identity()
