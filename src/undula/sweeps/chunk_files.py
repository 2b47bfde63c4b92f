"""Files of a stored sweep's chunks, each of which begins with a checksum of the rest."""

import zlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from undula.schema.sweep_variables import SEED, STATUS
from undula.storage.zarr_metadata import Metadata
from undula.sweeps.chunk_grid import ChunkGrid

#: Zarr's name of the codec that adds the checksum.
CHECKSUM = "crc32"
#: Length of the checksum [bytes].
_CHECKSUM_LENGTH = 4


@dataclass(frozen=True)
class ChunkFiles:
    """The files of a sweep's arrays.

    Attributes
    ----------
    path
        Folder of the store.
    grid
        The chunks over the points.
    names
        Variables with one file for each chunk of points, without the status.
    derived
        Arrays of one chunk that follow from the sweep: the axes and the seeds.
    dims
        Number of dimensions of each array.
    """

    path: Path
    grid: ChunkGrid
    names: tuple[str, ...]
    derived: tuple[str, ...]
    dims: dict[str, int]

    @classmethod
    def of(cls, path: Path, metadata: Metadata) -> "ChunkFiles":
        """Return the files of a sweep.

        Parameters
        ----------
        path
            Folder of the store.
        metadata
            Its metadata, with digests that have been checked.
        """
        names = list(metadata.attributes["undula_arrays"])
        dims = {name: metadata.dims(name) for name in names}
        points = dims[STATUS.name]
        status = metadata.array(STATUS.name)
        chunked = tuple(
            name
            for name in names
            if dims[name][: len(points)] == points and name not in (STATUS.name, SEED.name)
        )
        derived = tuple(name for name in names if name not in (*chunked, STATUS.name))
        grid = ChunkGrid(tuple(status["shape"]), tuple(status["chunks"]))
        return cls(path, grid, chunked, derived, {name: len(dims[name]) for name in names})

    def key(self, name: str, chunk: int = 0) -> str:
        """Return the name of the file of a variable's chunk.

        Parameters
        ----------
        name
            Name of the variable.
        chunk
            Number of the chunk.
        """
        place = [int(index) for index in np.unravel_index(chunk, self.grid.counts)]
        place = place[: self.dims[name]] + [0] * (self.dims[name] - len(place))
        return f"{name}/{'.'.join(map(str, place))}"

    def with_damaged_status(self) -> list[int]:
        """Return the chunks whose status file exists and is damaged."""
        keys = {chunk: self.key(STATUS.name, chunk) for chunk in range(len(self.grid))}
        return [chunk for chunk, key in keys.items() if self._exists(key) and not self._sound(key)]

    def damaged(self, statuses: np.ndarray[Any, Any], names: Sequence[str]) -> Iterator[int]:
        """Yield the chunks with results of which a variable is damaged or missing.

        Parameters
        ----------
        statuses
            Status of every point in order, read before the variables are checked.
        names
            Variables to be checked.
        """
        for chunk in range(len(self.grid)):
            numbers = self.grid.numbers(chunk)
            answered = statuses[numbers.start : numbers.stop].any()
            if answered and not all(self._sound(self.key(name, chunk)) for name in names):
                yield chunk

    def damaged_derived(self) -> list[str]:
        """Return the arrays that follow from the sweep and are damaged or missing."""
        return [name for name in self.derived if not self._sound(self.key(name))]

    def _exists(self, key: str) -> bool:
        return (self.path / key).exists()

    def _sound(self, key: str) -> bool:
        try:
            image = (self.path / key).read_bytes()
        except OSError:
            return False
        checksum = int.from_bytes(image[:_CHECKSUM_LENGTH], "little")
        content = memoryview(image)[_CHECKSUM_LENGTH:]
        return len(content) > 0 and zlib.crc32(content) == checksum
