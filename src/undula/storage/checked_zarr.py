"""A view of a Zarr store with checked metadata, in which damaged chunks are hidden."""

from collections.abc import Mapping
from pathlib import Path
from typing import Self

from zarr.abc.store import ByteRequest
from zarr.core.buffer import Buffer, BufferPrototype
from zarr.storage import LocalStore, WrapperStore

from undula.storage.zarr_metadata import is_metadata


class SoundStore(WrapperStore[LocalStore]):
    """A store in a folder, with given metadata and with hidden files.

    Parameters
    ----------
    store
        The folder.
    metadata
        All metadata, by the names of their files; those in the folder are ignored.
    hidden
        Names of the hidden files; more may be added at any time.
    """

    def __init__(
        self, store: LocalStore, metadata: Mapping[str, bytes], hidden: set[str] | None = None
    ) -> None:
        super().__init__(store)
        self._metadata = metadata
        self.hidden = set[str]() if hidden is None else hidden

    @classmethod
    def of(cls, path: Path, metadata: Mapping[str, bytes], *, read_only: bool) -> Self:
        """Return the store in a folder, without hidden files.

        Parameters
        ----------
        path
            The folder.
        metadata
            All metadata, by the names of their files.
        read_only
            If true, the store cannot be written.
        """
        return cls(LocalStore(path, read_only=read_only), metadata)

    def _with_store(self, store: LocalStore) -> Self:
        return type(self)(store, self._metadata, self.hidden)

    async def get(
        self,
        key: str,
        prototype: BufferPrototype,
        byte_range: ByteRequest | None = None,
    ) -> Buffer | None:
        """Return the bytes of a file, None if it does not exist or is hidden."""
        if is_metadata(key):
            content = self._metadata.get(key)
            return None if content is None else prototype.buffer.from_bytes(content)
        if key in self.hidden:
            return None
        return await super().get(key, prototype, byte_range)

    async def exists(self, key: str) -> bool:
        """Return True if a file exists and is not hidden."""
        if is_metadata(key):
            return key in self._metadata
        return key not in self.hidden and await super().exists(key)
