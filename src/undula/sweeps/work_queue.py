"""Work queue of a sweep: missing points in tasks of about a second, and results taken back."""

import math
import statistics
import time
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from undula.schema.sweep_axes import FAILED, NOT_DONE
from undula.storage.unchecked import warn_damaged
from undula.sweeps.point import TASK_SECONDS
from undula.sweeps.store import Arrays, SweepStore

#: Points of a task while the time that a point takes is unknown.
FIRST_POINTS = 2
#: Number of recent points whose median time predicts the time of the next one.
REMEMBERED = 101
#: Time after which the results of a chunk are written even if points are missing [s].
SAVE_EVERY = 5.0


@dataclass(frozen=True)
class SweepTask:
    """Points of one chunk that one worker computes together.

    Attributes
    ----------
    chunk
        Number of the chunk.
    numbers
        Numbers of the points.
    deaths
        Number of times that every worker that was given the task has died.
    """

    chunk: int
    numbers: tuple[int, ...]
    deaths: int = 0


@dataclass
class _OpenChunk:
    """Results of a chunk with missing points; `unsaved_since` is infinite if all are written."""

    arrays: Arrays
    missing: set[int]
    unsaved_since: float = math.inf


class SweepWork:
    """The missing points of a sweep, handed out in order and taken back in any order.

    Parameters
    ----------
    store
        The store of the sweep.
    retry_failed
        If true, failed points are computed again.
    """

    def __init__(self, store: SweepStore, *, retry_failed: bool = False) -> None:
        self._store, self._sweep = store, store.sweep
        self._whole_rows = store.sweep.whole_rows
        if damaged := store.mend():
            warn_damaged(store.path, damaged)
        self._statuses = store.statuses()
        if retry_failed:
            store.forget(np.flatnonzero(self._statuses == FAILED).tolist())
            self._statuses[self._statuses == FAILED] = NOT_DONE
        self._counts = np.bincount(self._statuses, minlength=FAILED + 1).tolist()
        self._open: dict[int, _OpenChunk] = {}
        self._again: deque[SweepTask] = deque()
        self._seconds: deque[float] = deque(maxlen=REMEMBERED)
        self._fresh = self._tasks()

    @property
    def total(self) -> int:
        """Number of points of the sweep."""
        return self._sweep.count

    @property
    def left(self) -> int:
        """Number of points without a result."""
        return int(self._counts[NOT_DONE])

    @property
    def failed(self) -> int:
        """Number of points that have failed."""
        return int(self._counts[FAILED])

    def take(self) -> SweepTask | None:
        """Return a task to be computed; None if no task is left."""
        return self._again.popleft() if self._again else next(self._fresh, None)

    def take_back(self, task: SweepTask, records: Sequence[Mapping[str, Any]]) -> None:
        """Enter the results of a task; points without a result are handed out again, in halves.

        Parameters
        ----------
        task
            A task that `take` has returned.
        records
            Records of its first points, in order.
        """
        task, rest = _cut(task, len(records))
        self._again.extend(half for half in _cut(rest, len(rest.numbers) // 2) if half.numbers)
        chunk = self._open[task.chunk]
        first = self._store.grid.numbers(task.chunk).start
        self._store.put(chunk.arrays, [number - first for number in task.numbers], records)
        for number, record in zip(task.numbers, records, strict=True):
            if "image" in record:
                self._store.store_run(number, record["image"])
            self._counts[self._statuses[number]] -= 1
            self._counts[record["status"]] += 1
            self._statuses[number] = record["status"]
            if math.isfinite(record["seconds"]):
                self._seconds.append(record["seconds"])
        chunk.missing.difference_update(task.numbers)
        chunk.unsaved_since = min(chunk.unsaved_since, time.monotonic())

    def died(self, task: SweepTask) -> None:
        """Take back a task whose workers have all died, perhaps because of one of its points."""
        half = len(task.numbers) // 2
        if half and not self._whole_rows:
            self._again.extend(_cut(task, half))
        elif task.deaths == 0:
            self._again.append(SweepTask(task.chunk, task.numbers, deaths=1))
        else:
            reason = "every worker died that it was given to, perhaps for want of memory"
            record = {"status": FAILED, "reason": reason, "seconds": math.nan}
            self.take_back(task, [record] * len(task.numbers))

    def save(self, age: float = 0.0) -> None:
        """Store the complete chunks, and those with results older than `age` [s].

        Raises
        ------
        InputError
            The folder cannot be written or is full.
        """
        now = time.monotonic()
        for number, chunk in list(self._open.items()):
            if not chunk.missing or now - chunk.unsaved_since >= age:
                self._store.write(number, chunk.arrays)
                chunk.unsaved_since = math.inf
            if not chunk.missing:
                del self._open[number]

    def _tasks(self) -> Iterator[SweepTask]:
        for number in range(len(self._store.grid)):
            inside = self._store.grid.numbers(number)
            statuses = self._statuses[inside.start : inside.stop]
            if (statuses != NOT_DONE).all():
                continue
            untouched = (statuses == NOT_DONE).all()
            arrays = self._store.blank(number) if untouched else self._store.read(number)
            groups = self._rows(inside) if self._whole_rows else self._groups(inside)
            missing = {point for point in inside if self._statuses[point] == NOT_DONE}
            self._open[number] = _OpenChunk(arrays, missing)
            yield from (SweepTask(number, group) for group in groups)

    def _groups(self, inside: range) -> Iterator[tuple[int, ...]]:
        """Yield the missing points of a chunk in groups that take about `TASK_SECONDS`."""
        missing = [number for number in inside if self._statuses[number] == NOT_DONE]
        while missing:
            count = FIRST_POINTS
            if self._seconds:
                typical = statistics.median(self._seconds)
                count = max(1, min(len(missing), int(TASK_SECONDS / max(typical, 1e-6))))
            yield tuple(missing[:count])
            missing = missing[count:]

    def _rows(self, inside: range) -> Iterator[tuple[int, ...]]:
        """Yield the rows of a chunk with missing points, in the order of computation."""
        length = self._sweep.shape[-2]
        for start in range(inside.start, inside.stop, length):
            row = tuple(range(start, start + length))
            if any(self._statuses[number] == NOT_DONE for number in row):
                yield row[::-1] if self._sweep.settings.get("direction") == "down" else row


def _cut(task: SweepTask, count: int) -> tuple[SweepTask, SweepTask]:
    """Return the first `count` points of a task and the others, as two tasks."""
    return (
        SweepTask(task.chunk, task.numbers[:count]),
        SweepTask(task.chunk, task.numbers[count:]),
    )
