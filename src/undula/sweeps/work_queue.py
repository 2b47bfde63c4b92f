"""What is left to do of a study, cut into pieces of about a second, and what has come back."""

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
from undula.sweeps.point import PIECE_SECONDS
from undula.sweeps.store import Arrays, StudyStore

#: Points of a piece as long as nobody knows how long they take.
FIRST_POINTS = 2
#: What the last points took, the median of so many, tells how long the next will take.
REMEMBERED = 101
#: Seconds after which what is known of a block is written even if points are missing.
SAVE_EVERY = 5.0


@dataclass(frozen=True)
class Piece:
    """Points of one block that are done together; `deaths` times all workers died under them."""

    block: int
    numbers: tuple[int, ...]
    deaths: int = 0


@dataclass
class _Open:
    """What is known of a block of which points are missing."""

    arrays: Arrays
    missing: set[int]
    unsaved_since: float = math.inf


class SweepWork:
    """The work that is left of a study, handed out in order and taken back in any.

    Parameters
    ----------
    store
        Where the results go.
    retry_failed
        Whether points that have failed are left to do.
    """

    def __init__(self, store: StudyStore, *, retry_failed: bool = False) -> None:
        self._store, self._study = store, store.study
        self._whole_lines = store.study.whole_lines
        if damaged := store.mend():
            warn_damaged(store.path, damaged)
        self._statuses = store.statuses()
        if retry_failed:
            store.forget(np.flatnonzero(self._statuses == FAILED).tolist())
            self._statuses[self._statuses == FAILED] = NOT_DONE
        self._counts = np.bincount(self._statuses, minlength=FAILED + 1).tolist()
        self._open: dict[int, _Open] = {}
        self._again: deque[Piece] = deque()
        self._seconds: deque[float] = deque(maxlen=REMEMBERED)
        self._left = self._pieces()

    @property
    def total(self) -> int:
        """Number of points of the study."""
        return self._study.count

    @property
    def left(self) -> int:
        """Number of points that have not come back."""
        return int(self._counts[NOT_DONE])

    @property
    def failed(self) -> int:
        """Number of points that have failed."""
        return int(self._counts[FAILED])

    def take(self) -> Piece | None:
        """Return a piece to be done; None if there is no more."""
        return self._again.popleft() if self._again else next(self._left, None)

    def take_back(self, piece: Piece, records: Sequence[Mapping[str, Any]]) -> None:
        """Enter the records of a piece; what it was too long for is handed out again, in halves."""
        piece, rest = _cut(piece, len(records))
        self._again.extend(part for part in _cut(rest, len(rest.numbers) // 2) if part.numbers)
        block = self._open[piece.block]
        first = self._store.blocks.numbers(piece.block).start
        self._store.put(block.arrays, [number - first for number in piece.numbers], records)
        for number, record in zip(piece.numbers, records, strict=True):
            if "image" in record:
                self._store.keep_run(number, record["image"])
            self._counts[self._statuses[number]] -= 1
            self._counts[record["status"]] += 1
            self._statuses[number] = record["status"]
            if math.isfinite(record["seconds"]):
                self._seconds.append(record["seconds"])
        block.missing.difference_update(piece.numbers)
        block.unsaved_since = min(block.unsaved_since, time.monotonic())

    def died(self, piece: Piece) -> None:
        """Take back a piece under which every worker died: one of its points may be to blame."""
        half = len(piece.numbers) // 2
        if half and not self._whole_lines:
            self._again.extend(_cut(piece, half))
        elif piece.deaths == 0:
            self._again.append(Piece(piece.block, piece.numbers, deaths=1))
        else:
            reason = "every worker died that it was given to, perhaps for want of memory"
            record = {"status": FAILED, "reason": reason, "seconds": math.nan}
            self.take_back(piece, [record] * len(piece.numbers))

    def save(self, age: float = 0.0) -> None:
        """Store the blocks that are complete, and those that have waited for so many seconds.

        Raises
        ------
        InputError
            The folder cannot be written or is full.
        """
        now = time.monotonic()
        for number, block in list(self._open.items()):
            if not block.missing or now - block.unsaved_since >= age:
                self._store.write(number, block.arrays)
                block.unsaved_since = math.inf
            if not block.missing:
                del self._open[number]

    def _pieces(self) -> Iterator[Piece]:
        for number in range(len(self._store.blocks)):
            inside = self._store.blocks.numbers(number)
            statuses = self._statuses[inside.start : inside.stop]
            if (statuses != NOT_DONE).all():
                continue
            fresh = (statuses == NOT_DONE).all()
            arrays = self._store.blank(number) if fresh else self._store.read(number)
            pieces = self._lines(inside) if self._whole_lines else self._runs_of(inside)
            missing = {point for point in inside if self._statuses[point] == NOT_DONE}
            self._open[number] = _Open(arrays, missing)
            yield from (Piece(number, part) for part in pieces)

    def _runs_of(self, inside: range) -> Iterator[tuple[int, ...]]:
        """Yield the points that are left of a block, as many at a time as a piece should have."""
        left = [number for number in inside if self._statuses[number] == NOT_DONE]
        while left:
            count = FIRST_POINTS
            if self._seconds:
                pace = statistics.median(self._seconds)
                count = max(1, min(len(left), int(PIECE_SECONDS / max(pace, 1e-6))))
            yield tuple(left[:count])
            left = left[count:]

    def _lines(self, inside: range) -> Iterator[tuple[int, ...]]:
        """Yield the lines of a block in which points are left, in the order of their points."""
        length = self._study.shape[-2]
        for start in range(inside.start, inside.stop, length):
            line = tuple(range(start, start + length))
            if any(self._statuses[number] == NOT_DONE for number in line):
                yield line[::-1] if self._study.settings.get("direction") == "down" else line


def _cut(piece: Piece, count: int) -> tuple[Piece, Piece]:
    """Return the first points of a piece, and the others."""
    return Piece(piece.block, piece.numbers[:count]), Piece(piece.block, piece.numbers[count:])
