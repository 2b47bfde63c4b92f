"""The chunks of a stored study, each a file that begins with a checksum of the rest."""

import zlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from undula.schema.sweep_variables import SEED, STATUS
from undula.storage.zarr_metadata import Metadata
from undula.sweeps.blocks import Blocks

#: What puts the checksum there: Zarr's name of the codec.
CHECKSUM = "crc32"
_BYTES = 4


@dataclass(frozen=True)
class Chunks:
    """The files of a study's arrays.

    Attributes
    ----------
    path
        The folder.
    blocks
        The points, in blocks.
    names
        The variables that have a chunk in each block, without the status.
    known
        The arrays of one chunk that follow from the study: the axes and the seeds.
    dims
        The number of dimensions of each of them.
    """

    path: Path
    blocks: Blocks
    names: tuple[str, ...]
    known: tuple[str, ...]
    dims: dict[str, int]

    @classmethod
    def of(cls, path: Path, metadata: Metadata) -> "Chunks":
        """Return the files of a study with these metadata, which have been checked."""
        names = list(metadata.attributes["undula_arrays"])
        dims = {name: metadata.dims(name) for name in names}
        points = dims[STATUS.name]
        status = metadata.array(STATUS.name)
        many = tuple(
            name
            for name in names
            if dims[name][: len(points)] == points and name not in (STATUS.name, SEED.name)
        )
        known = tuple(name for name in names if name not in (*many, STATUS.name))
        blocks = Blocks(tuple(status["shape"]), tuple(status["chunks"]))
        return cls(path, blocks, many, known, {name: len(dims[name]) for name in names})

    def key(self, name: str, block: int = 0) -> str:
        """Return the name of the file of a variable's chunk."""
        place = [int(at) for at in np.unravel_index(block, self.blocks.grid)]
        place = place[: self.dims[name]] + [0] * (self.dims[name] - len(place))
        return f"{name}/{'.'.join(map(str, place))}"

    def without_status(self) -> list[int]:
        """Return the blocks whose status is there and damaged."""
        keys = {block: self.key(STATUS.name, block) for block in range(len(self.blocks))}
        return [block for block, key in keys.items() if self._exists(key) and not self._sound(key)]

    def damaged(self, statuses: np.ndarray[Any, Any], names: Sequence[str]) -> Iterator[int]:
        """Yield the blocks with an answer of which some variable is damaged or missing.

        Parameters
        ----------
        statuses
            Of all points, in order, read before.
        names
            The variables to be looked at.
        """
        for block in range(len(self.blocks)):
            inside = self.blocks.numbers(block)
            answered = statuses[inside.start : inside.stop].any()
            if answered and not all(self._sound(self.key(name, block)) for name in names):
                yield block

    def damaged_known(self) -> list[str]:
        """Return the arrays that follow from the study and are damaged or missing."""
        return [name for name in self.known if not self._sound(self.key(name))]

    def _exists(self, key: str) -> bool:
        return (self.path / key).exists()

    def _sound(self, key: str) -> bool:
        try:
            image = (self.path / key).read_bytes()
        except OSError:
            return False
        checksum = int.from_bytes(image[:_BYTES], "little")
        return len(image) > _BYTES and zlib.crc32(memoryview(image)[_BYTES:]) == checksum
