"""Stored sweeps: one Zarr group for all points, written chunk by chunk.

Each chunk of points has its own files, one for each variable. The file with the status is written
last, and each file replaces an earlier one in one step: whenever the writing is cut short, points
marked as done have all their results. Every file carries a checksum, and points with a damaged or
missing file are computed again.
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
from undula.storage.atomic import folder_errors_explained, write_whole
from undula.storage.checked_zarr import SoundStore
from undula.storage.differences import difference
from undula.storage.name_lock import locked
from undula.storage.result_kinds import Kind
from undula.storage.run_file import read_result
from undula.storage.seal import is_whole
from undula.storage.zarr_metadata import Metadata, mend_metadata, read_metadata
from undula.sweeps.checked_sweep import sound_dataset
from undula.sweeps.chunk_files import ChunkFiles
from undula.sweeps.chunk_grid import ChunkGrid
from undula.sweeps.disk_space import refuse_too_large_a_store
from undula.sweeps.layout import FORMAT, RUNS, ZARR_FORMAT, derived_arrays, lay_out
from undula.sweeps.point import software
from undula.sweeps.sweep import Sweep

Record = Mapping[str, Any]
Arrays = dict[str, np.ndarray[Any, Any]]


class SweepStore:
    """The store of a sweep, to be written by one process.

    Parameters
    ----------
    path
        Folder of the store, which exists.
    sweep
        The sweep that it holds.
    """

    def __init__(self, path: Path, sweep: Sweep) -> None:
        self.path, self.sweep, self._metadata = path, sweep, read_metadata(path)
        store = SoundStore.of(path, self._metadata.files, read_only=False)
        self._columns = columns_of(sweep.label, sweep.keep, sweep.undecided)
        # Empty chunks are written too, so that a missing file always means damage.
        with zarr.config.set({"array.write_empty_chunks": True}):
            self._group: Any = zarr.open_group(store, mode="r+", zarr_format=ZARR_FORMAT)
            self._arrays: dict[str, Any] = {
                column.name: self._group[column.name] for column in self._columns
            }
        self.grid = ChunkGrid(sweep.shape, self._arrays[STATUS.name].chunks)

    def statuses(self) -> np.ndarray[Any, Any]:
        """Return the status of every point, shape (count,)."""
        return np.asarray(self._arrays[STATUS.name][...]).ravel()

    def read(self, chunk: int) -> Arrays:
        """Return the stored content of a chunk, by variable."""
        region = self.grid.region(chunk)
        return {name: np.array(array[region]) for name, array in self._arrays.items()}

    def blank(self, chunk: int) -> Arrays:
        """Return the content of a chunk that has never been written, by variable."""
        region = self.grid.region(chunk)
        inside = tuple(part.stop - part.start for part in region)
        return {
            column.name: np.full(
                (*inside, *self._arrays[column.name].shape[len(inside) :]),
                column.rest,
                column.dtype,
            )
            for column in self._columns
        }

    def write(self, chunk: int, arrays: Arrays) -> None:
        """Write the results of a chunk, the status last.

        Raises
        ------
        InputError
            The folder cannot be written or is full. The earlier content of the chunk is then
            still valid.
        """
        region = self.grid.region(chunk)
        with folder_errors_explained(self.path):
            for name, array in arrays.items():
                if name != STATUS.name:
                    self._arrays[name][region] = array
            self._arrays[STATUS.name][region] = arrays[STATUS.name]

    def forget(self, numbers: Sequence[int]) -> None:
        """Mark points as not done."""
        for chunk in range(len(self.grid)):
            inside = self.grid.numbers(chunk)
            local = [number - inside.start for number in numbers if number in inside]
            if local:
                region = self.grid.region(chunk)
                status = np.array(self._arrays[STATUS.name][region])
                status.reshape(-1)[local] = STATUS.rest
                with folder_errors_explained(self.path):
                    self._arrays[STATUS.name][region] = status

    def mend(self) -> int:
        """Mark damaged points as not done; return their number.

        Arrays that follow from the sweep are written again.

        Raises
        ------
        InputError
            The folder cannot be written or is full.
        """
        mend_metadata(self.path, self._metadata)
        files = ChunkFiles.of(self.path, self._metadata)
        lost = files.with_damaged_status()
        self._remove(files, [(STATUS.name, chunk) for chunk in lost])
        statuses = self.statuses()
        broken = list(files.damaged(statuses, files.names))
        numbers = [
            number
            for chunk in broken
            for number in self.grid.numbers(chunk)
            if statuses[number] != STATUS.rest
        ]
        numbers += [number for number in self._without_run(statuses) if number not in set(numbers)]
        # The status is reset first, so that no point seems done while its files are replaced.
        self.forget(numbers)
        self._remove(files, [(name, chunk) for name in files.names for chunk in (*broken, *lost)])
        self._mend_derived(files)
        return len(numbers) + sum(len(self.grid.numbers(chunk)) for chunk in lost)

    def put(self, arrays: Arrays, local: Sequence[int], records: Iterable[Record]) -> None:
        """Enter records of points into the arrays of their chunk.

        Parameters
        ----------
        arrays
            Content of the chunk, which is changed.
        local
            Places of the points in the chunk.
        records
            Records of the points, as `undula.sweeps.point.point_record` returns them.
        """
        records = list(records)
        dims = len(self.sweep.shape)
        for column in self._columns:
            flat = arrays[column.name].reshape(-1, *arrays[column.name].shape[dims:])
            for place, record in zip(local, records, strict=True):
                flat[place] = record.get(column.name, column.rest)

    def _without_run(self, statuses: np.ndarray[Any, Any]) -> Iterator[int]:
        """Yield the points that are done and whose result file is missing or damaged."""
        if self.sweep.keep == "run":
            for number in np.flatnonzero(statuses == DONE).tolist():
                path = self.path / RUNS / run_name(self.sweep, number)
                try:
                    whole = is_whole(path.read_bytes())
                except OSError:
                    whole = False
                if not whole:
                    yield number

    def _mend_derived(self, files: ChunkFiles) -> None:
        if damaged := files.damaged_derived():
            derived = derived_arrays(self.sweep)
            self._remove(files, [(name, 0) for name in damaged])
            with folder_errors_explained(self.path):
                for name in damaged:
                    self._group[name][...] = derived[name]

    def _remove(self, files: ChunkFiles, chunks: Sequence[tuple[str, int]]) -> None:
        with folder_errors_explained(self.path):
            for name, chunk in chunks:
                (self.path / files.key(name, chunk)).unlink(missing_ok=True)

    def store_run(self, number: int, image: bytes) -> None:
        """Store the result file of a point's run.

        Raises
        ------
        InputError
            The folder cannot be written or is full.
        """
        write_whole(self.path / RUNS / run_name(self.sweep, number), image, overwrite=True)

    @contextmanager
    def alone(self) -> Iterator[None]:
        """Keep other processes from writing the store.

        Raises
        ------
        InputError
            Another process writes it, or the store cannot be written.
        """
        busy = f"another undula sweep is at work on {self.path}; wait for it, or give another --out"
        with locked(self.path, busy, lock=self.path / ".lock"):
            yield


def run_name(sweep: Sweep, number: int) -> str:
    """Return the file name of a point's run: indices along the axes, and of the replicate."""
    return "-".join(map(str, sweep.place(number))) + ".nc"


def open_sweep(path: Path, sweep: Sweep) -> SweepStore:
    """Return the store of a sweep in a folder, which is made if it does not exist.

    Raises
    ------
    InputError
        The sweep could not fit on the disk; the folder holds something else, another sweep or one
        of another version of undula; or it cannot be written.
    """
    if not path.exists():
        refuse_too_large_a_store(path, sweep)
        with folder_errors_explained(path):
            lay_out(path, sweep)
    metadata = _metadata_of(path)
    attributes = metadata.attributes
    if attributes["software"] != software():
        raise InputError(
            f"{path} was made by undula {attributes['software']} and cannot be gone on with by"
            f" undula {software()}; go on with that version, or give another --out"
        )
    # Both pass through JSON, which turns tuples into lists.
    wanted = json.loads(json.dumps(sweep.dump()))
    differs = difference(json.loads(attributes["study"]), wanted)
    if differs is not None:
        raise InputError(f"{path} holds another study, with {differs}; give another --out")
    if not metadata.checked:
        raise InputError(
            f"{path} carries no checksums, since other software or an earlier version stored it,"
            " and can be drawn but not gone on with; give another --out"
        )
    return SweepStore(path, sweep)


def load_sweep(path: Path | str, *, shapes: bool = True) -> xr.Dataset:
    """Open a stored sweep; its variables are read when they are used.

    Damaged points are shown as not done, with a warning that states their number.

    Parameters
    ----------
    path : Path or str
        A store written by ``undula sweep``, which may still be running.
    shapes : bool
        If true, the variables include the shapes of last periods, which are nearly all of a store.

    Returns
    -------
    xarray.Dataset
        The variables over the axes, named as "load.force", and the replicates, named "try".

    Raises
    ------
    InputError
        There is no such store, or its metadata are damaged.

    Examples
    --------
    >>> import undula
    >>> stored = undula.load("results/point-loads.zarr")
    >>> stored["verdict"].sel({"load.force": 75.0}).dims
    ('load.position', 'try')
    """
    path = Path(path)
    if path.is_file():
        # Other software may have stored the sweep again as one file.
        return read_result(path, Kind(FORMAT, "undula sweep"))
    return sound_dataset(path, _metadata_of(path), shapes=shapes)


def _metadata_of(path: Path) -> Metadata:
    """Return the metadata of a stored sweep."""
    if not path.exists():
        raise InputError(f"there is no study {path}; check the name")
    metadata = read_metadata(path)
    written = metadata.attributes.get("undula_format")
    if written != FORMAT:
        raise InputError(
            f"{path} has the format {written!r}, not {FORMAT!r}; give a folder that this version of"
            " undula sweep made"
        )
    return metadata
