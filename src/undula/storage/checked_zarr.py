"""A store as Zarr may see it: with metadata that were checked, and without chunks that are not."""

from collections.abc import Mapping
from pathlib import Path
from typing import Self

from zarr.abc.store import ByteRequest
from zarr.core.buffer import Buffer, BufferPrototype
from zarr.storage import LocalStore, WrapperStore

from undula.storage.zarr_metadata import is_metadata


class SoundStore(WrapperStore[LocalStore]):
    """A folder with metadata from elsewhere, of which some files cannot be seen.

    Parameters
    ----------
    store
        The folder.
    metadata
        All metadata, by the names of their files.
    hidden
        Names of the files that cannot be seen; more may be added at any time.
    """

    def __init__(
        self, store: LocalStore, metadata: Mapping[str, bytes], hidden: set[str] | None = None
    ) -> None:
        super().__init__(store)
        self._metadata = metadata
        self.hidden = set[str]() if hidden is None else hidden

    @classmethod
    def of(cls, path: Path, metadata: Mapping[str, bytes], *, read_only: bool) -> Self:
        """Return the store in a folder."""
        return cls(LocalStore(path, read_only=read_only), metadata)

    def _with_store(self, store: LocalStore) -> Self:
        return type(self)(store, self._metadata, self.hidden)

    async def get(
        self,
        key: str,
        prototype: BufferPrototype,
        byte_range: ByteRequest | None = None,
    ) -> Buffer | None:
        """Return the bytes of a file, None if there is none to be seen."""
        if is_metadata(key):
            told = self._metadata.get(key)
            return None if told is None else prototype.buffer.from_bytes(told)
        if key in self.hidden:
            return None
        return await super().get(key, prototype, byte_range)

    async def exists(self, key: str) -> bool:
        """Tell whether there is a file to be seen."""
        if is_metadata(key):
            return key in self._metadata
        return key not in self.hidden and await super().exists(key)
