"""Chunks of a sweep's arrays: each holds consecutive points that are written at once."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

#: Most points of a chunk: enough to make few files, few enough to be written in milliseconds.
MOST_POINTS_OF_CHUNK = 256
#: Most bytes of one variable in a chunk.
MOST_BYTES_OF_CHUNK = 2**22


def chunk_shape(
    shape: Sequence[int], *, point_bytes: int = 8, whole_rows: bool = False
) -> tuple[int, ...]:
    """Return the shape of chunks of consecutive points.

    Parameters
    ----------
    shape
        Number of values along each axis, and of replicates.
    point_bytes
        Size of the largest variable at a point [bytes].
    whole_rows
        If true, one chunk holds all values of the last axis, even beyond the size limit.
    """
    room = max(1, min(MOST_POINTS_OF_CHUNK, MOST_BYTES_OF_CHUNK // point_bytes))
    chunk: list[int] = []
    for length in reversed(shape):
        whole = whole_rows and len(chunk) <= 1
        chunk.append(length if whole else max(1, min(length, room)))
        # A chunk holds several values of an axis only where it holds all of the axes after it.
        room = room // length if chunk[-1] == length else 1
    return tuple(reversed(chunk))


@dataclass(frozen=True)
class ChunkGrid:
    """Chunks in sequence, over points numbered with the last axis fastest.

    Attributes
    ----------
    shape
        Number of values along each axis, and of replicates.
    chunk
        Shape of a chunk, as `chunk_shape` returns it.
    """

    shape: tuple[int, ...]
    chunk: tuple[int, ...]

    @property
    def counts(self) -> tuple[int, ...]:
        """Number of chunks along each axis."""
        return tuple(
            -(-length // width) for length, width in zip(self.shape, self.chunk, strict=True)
        )

    def __len__(self) -> int:
        """Return the number of chunks."""
        return math.prod(self.counts)

    def region(self, chunk: int) -> tuple[slice, ...]:
        """Return the slices of the sweep's arrays that a chunk covers."""
        corner = np.unravel_index(chunk, self.counts)
        return tuple(
            slice(int(index) * width, min((int(index) + 1) * width, length))
            for index, width, length in zip(corner, self.chunk, self.shape, strict=True)
        )

    def numbers(self, chunk: int) -> range:
        """Return the numbers of the points of a chunk."""
        region = self.region(chunk)
        first = int(np.ravel_multi_index([part.start for part in region], self.shape))
        return range(first, first + math.prod(part.stop - part.start for part in region))
