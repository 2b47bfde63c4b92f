"""A study on disk: one Zarr group for all its points, written block by block.

A block is one chunk of every variable, so that writing it touches files of its own only. The file
with the status of its points is written last, and each file takes its place in one step: a point
that is said to be done, is, whenever the writing was cut short. Every file carries a checksum, and
points of which one is damaged or missing are done again.
"""

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
import zarr

from undula.errors import InputError
from undula.schema.sweep_axes import DONE
from undula.schema.sweep_variables import STATUS, columns_of
from undula.storage.atomic import folder_trouble_told, write_whole
from undula.storage.checked_zarr import SoundStore
from undula.storage.differences import difference
from undula.storage.name_lock import locked
from undula.storage.result_kinds import Kind
from undula.storage.run_file import read_result
from undula.storage.seal import is_whole
from undula.storage.zarr_metadata import Metadata, mend_metadata, read_metadata
from undula.sweeps.blocks import Blocks
from undula.sweeps.checked_sweep import sound_dataset
from undula.sweeps.chunks import Chunks
from undula.sweeps.disk_space import refuse_too_large_a_store
from undula.sweeps.layout import FORMAT, RUNS, ZARR_FORMAT, known_arrays, lay_out
from undula.sweeps.point import software
from undula.sweeps.sweep import Study

Record = Mapping[str, Any]
Arrays = dict[str, np.ndarray[Any, Any]]


class StudyStore:
    """The store of a study, to be written by one process.

    Parameters
    ----------
    path
        Its folder, as `open_study` has found or made it.
    study
        What it holds.
    """

    def __init__(self, path: Path, study: Study) -> None:
        self.path, self.study, self._metadata = path, study, read_metadata(path)
        store = SoundStore.of(path, self._metadata.files, read_only=False)
        self._columns = columns_of(study.label, study.keep, study.undecided)
        # A chunk is written even if all in it is empty: what is missing is damage.
        with zarr.config.set({"array.write_empty_chunks": True}):
            self._group: Any = zarr.open_group(store, mode="r+", zarr_format=ZARR_FORMAT)
            self._arrays: dict[str, Any] = {
                one.name: self._group[one.name] for one in self._columns
            }
        self.blocks = Blocks(study.shape, self._arrays[STATUS.name].chunks)

    def statuses(self) -> np.ndarray[Any, Any]:
        """Return the status of every point, shape (count,)."""
        return np.asarray(self._arrays[STATUS.name][...]).ravel()

    def read(self, block: int) -> Arrays:
        """Return what the store holds of a block, by variable."""
        region = self.blocks.region(block)
        return {name: np.array(array[region]) for name, array in self._arrays.items()}

    def blank(self, block: int) -> Arrays:
        """Return what the store holds of a block of which nothing has been written."""
        region = self.blocks.region(block)
        inside = tuple(part.stop - part.start for part in region)
        return {
            one.name: np.full(
                (*inside, *self._arrays[one.name].shape[len(inside) :]), one.rest, one.dtype
            )
            for one in self._columns
        }

    def write(self, block: int, arrays: Arrays) -> None:
        """Write what is known of a block, its status last.

        Raises
        ------
        InputError
            The folder cannot be written or is full. What was there before is still there, and
            holds.
        """
        region = self.blocks.region(block)
        with folder_trouble_told(self.path):
            for name, array in arrays.items():
                if name != STATUS.name:
                    self._arrays[name][region] = array
            self._arrays[STATUS.name][region] = arrays[STATUS.name]

    def forget(self, numbers: Sequence[int]) -> None:
        """Mark points as not done."""
        for block in range(len(self.blocks)):
            inside = self.blocks.numbers(block)
            local = [number - inside.start for number in numbers if number in inside]
            if local:
                region = self.blocks.region(block)
                status = np.array(self._arrays[STATUS.name][region])
                status.reshape(-1)[local] = STATUS.rest
                with folder_trouble_told(self.path):
                    self._arrays[STATUS.name][region] = status

    def mend(self) -> int:
        """Mark points as not done of which something is damaged; return how many there were.

        What follows from the study is written anew.

        Raises
        ------
        InputError
            The folder cannot be written or is full.
        """
        mend_metadata(self.path, self._metadata)
        chunks = Chunks.of(self.path, self._metadata)
        lost = chunks.without_status()
        self._remove(chunks, [(STATUS.name, block) for block in lost])
        statuses = self.statuses()
        broken = list(chunks.damaged(statuses, chunks.names))
        numbers = [one for at in broken for one in self.blocks.numbers(at) if statuses[one]]
        numbers += [one for one in self._without_run(statuses) if one not in set(numbers)]
        # Its status comes first: no point may seem done of which something is being replaced.
        self.forget(numbers)
        self._remove(chunks, [(name, block) for name in chunks.names for block in (*broken, *lost)])
        self._mend_known(chunks)
        return len(numbers) + sum(len(self.blocks.numbers(block)) for block in lost)

    def put(self, arrays: Arrays, local: Sequence[int], records: Iterable[Record]) -> None:
        """Enter records of points into the arrays of their block, at their places in it."""
        records = list(records)
        dims = len(self.study.shape)
        for column in self._columns:
            flat = arrays[column.name].reshape(-1, *arrays[column.name].shape[dims:])
            for at, record in zip(local, records, strict=True):
                flat[at] = record.get(column.name, column.rest)

    def _without_run(self, statuses: np.ndarray[Any, Any]) -> Iterator[int]:
        """Yield the points that are done and whose run is to be kept, but is not whole."""
        if self.study.keep == "run":
            for number in np.flatnonzero(statuses == DONE).tolist():
                path = self.path / RUNS / run_name(self.study, number)
                try:
                    whole = is_whole(path.read_bytes())
                except OSError:
                    whole = False
                if not whole:
                    yield number

    def _mend_known(self, chunks: Chunks) -> None:
        if damaged := chunks.damaged_known():
            made = known_arrays(self.study)
            self._remove(chunks, [(name, 0) for name in damaged])
            with folder_trouble_told(self.path):
                for name in damaged:
                    self._group[name][...] = made[name]

    def _remove(self, chunks: Chunks, places: Sequence[tuple[str, int]]) -> None:
        with folder_trouble_told(self.path):
            for name, block in places:
                (self.path / chunks.key(name, block)).unlink(missing_ok=True)

    def keep_run(self, number: int, image: bytes) -> None:
        """Store the result file of a point's run.

        Raises
        ------
        InputError
            The folder cannot be written or is full.
        """
        write_whole(self.path / RUNS / run_name(self.study, number), image, overwrite=True)

    @contextmanager
    def alone(self) -> Iterator[None]:
        """Keep other processes from writing the store.

        Raises
        ------
        InputError
            Another process does, or the store cannot be written.
        """
        busy = f"another undula sweep is at work on {self.path}; wait for it, or give another --out"
        with locked(self.path, busy, lock=self.path / ".lock"):
            yield


def run_name(study: Study, number: int) -> str:
    """Return the name of the file of a point's run: its indices along the axes, and of its try."""
    return "-".join(map(str, study.place(number))) + ".nc"


def open_study(path: Path, study: Study) -> StudyStore:
    """Return the store of a study, which is made if there is none.

    Raises
    ------
    InputError
        It could not fit on the disk; there is something else in its place, or it holds another
        study or was made by another version; or the folder cannot be written.
    """
    if not path.exists():
        refuse_too_large_a_store(path, study)
        with folder_trouble_told(path):
            lay_out(path, study)
    metadata = _metadata_of(path)
    told = metadata.attributes
    if told["software"] != software():
        raise InputError(
            f"{path} was made by undula {told['software']} and cannot be gone on with by"
            f" undula {software()}; go on with that version, or give another --out"
        )
    # Both have to have been through JSON, for lists to be alike.
    wanted = json.loads(json.dumps(study.dump()))
    differs = difference(json.loads(told["study"]), wanted)
    if differs is not None:
        raise InputError(f"{path} holds another study, with {differs}; give another --out")
    if not metadata.checked:
        raise InputError(
            f"{path} carries no checksums, since other software or an earlier version stored it,"
            " and can be drawn but not gone on with; give another --out"
        )
    return StudyStore(path, study)


def load_sweep(path: Path | str, *, shapes: bool = True) -> xr.Dataset:
    """Open a stored study; its variables are read when they are asked for.

    Points of which something is damaged are shown as not done, and a warning says how many.

    Parameters
    ----------
    path
        A store that ``undula sweep`` made, also while it is still at work on it.
    shapes
        Whether the shapes of last periods are among the variables. They are nearly all of a store,
        and looking for damage in them takes as long as reading them.

    Raises
    ------
    InputError
        There is no such store, or what it says of itself is damaged.
    """
    path = Path(path)
    if path.is_file():
        # Other software may have stored it again in one file.
        return read_result(path, Kind(FORMAT, "undula sweep"))
    return sound_dataset(path, _metadata_of(path), shapes=shapes)


def _metadata_of(path: Path) -> Metadata:
    """Return what a stored study says of itself."""
    if not path.exists():
        raise InputError(f"there is no study {path}; check the name")
    metadata = read_metadata(path)
    found = metadata.attributes.get("undula_format")
    if found != FORMAT:
        raise InputError(
            f"{path} has the format {found!r}, not {FORMAT!r}; give a folder that this version of"
            " undula sweep made"
        )
    return metadata
