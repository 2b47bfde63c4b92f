"""The points of a study in blocks that are written at once: chunks of its arrays."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

#: Most points of a block: enough to make few files, few enough to be written in milliseconds.
MOST = 256
#: Most bytes of a variable in a block.
MOST_BYTES = 2**22


def chunk_shape(
    shape: Sequence[int], *, point_bytes: int = 8, whole_lines: bool = False
) -> tuple[int, ...]:
    """Return the shape of blocks of consecutive points.

    Parameters
    ----------
    shape
        Number of values along each axis, and of tries.
    point_bytes
        Size of the largest variable at a point.
    whole_lines
        Whether all values of the last axis have to be in one block, however many they are.
    """
    room = max(1, min(MOST, MOST_BYTES // point_bytes))
    chunks: list[int] = []
    for length in reversed(shape):
        whole = whole_lines and len(chunks) <= 1
        chunks.append(length if whole else max(1, min(length, room)))
        # Only where all values of an axis are in the block, it may hold several of the one before.
        room = room // length if chunks[-1] == length else 1
    return tuple(reversed(chunks))


@dataclass(frozen=True)
class Blocks:
    """Points numbered through, the last axis fastest, in blocks that follow one another.

    Attributes
    ----------
    shape
        Number of values along each axis, and of tries.
    chunks
        Of a block, as `chunk_shape` gives it.
    """

    shape: tuple[int, ...]
    chunks: tuple[int, ...]

    @property
    def grid(self) -> tuple[int, ...]:
        """Number of blocks along each axis."""
        return tuple(-(-n // of) for n, of in zip(self.shape, self.chunks, strict=True))

    def __len__(self) -> int:
        """Return the number of blocks."""
        return math.prod(self.grid)

    def region(self, block: int) -> tuple[slice, ...]:
        """Return where a block is in the arrays of the study."""
        corner = np.unravel_index(block, self.grid)
        return tuple(
            slice(int(at) * of, min((int(at) + 1) * of, n))
            for at, of, n in zip(corner, self.chunks, self.shape, strict=True)
        )

    def numbers(self, block: int) -> range:
        """Return the points of a block."""
        region = self.region(block)
        first = int(np.ravel_multi_index([part.start for part in region], self.shape))
        return range(first, first + math.prod(part.stop - part.start for part in region))
