"""The layout of a stored study: which arrays there are, in what chunks, and what they say."""

import errno
import json
import os
import platform
import shutil
from importlib.metadata import version
from pathlib import Path
from typing import Any, Literal

import numpy as np
import zarr
from zarr.registry import get_numcodec

from undula.analysis.runs.last_period import INSTANTS, SHAPES
from undula.inputs.build import build_model
from undula.inputs.input import parse_input
from undula.models.model import Model
from undula.schema.sweep_axes import TRY
from undula.schema.sweep_variables import INNER, SEED, STATUS, STATUS_WORDS, Column, columns_of
from undula.storage.zarr_metadata import seal_of, single_files
from undula.sweeps.blocks import chunk_shape
from undula.sweeps.chunks import CHECKSUM
from undula.sweeps.point import software
from undula.sweeps.sweep import Study

#: What a store is, and the number of its format.
FORMAT = "study 1"
#: Texts of fixed width belong to the second format of Zarr, not yet to the third.
ZARR_FORMAT: Literal[2] = 2
#: The folder of result files in a store.
RUNS = "runs"

_LIBRARIES = ("undula", "numpy", "numba")


def lay_out(path: Path, study: Study) -> None:
    """Make the store of a study without any results, whole or not at all.

    If another process was quicker, what it has made is left as it is.

    Raises
    ------
    OSError
        The folder cannot be written, or is full.
    """
    temporary = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        _fill(temporary, study)
        os.rename(temporary, path)
    except OSError as error:
        if error.errno not in (errno.ENOTEMPTY, errno.EEXIST):
            raise
    finally:
        shutil.rmtree(temporary, ignore_errors=True)


def _fill(path: Path, study: Study) -> None:
    wanted = parse_input(study.tables(0))
    model = build_model(wanted)
    group = zarr.create_group(path, zarr_format=ZARR_FORMAT, attributes=_attributes(study))
    _add_variables(group, study, model)
    seeds = {"dims": _dims(study), "attributes": _told(SEED, model.units.names())}
    for name, values in known_arrays(study).items():
        told = seeds if name == SEED.name else {"dims": (name,)}
        # Known from the beginning and never written again.
        _add(group, name, values.dtype.str, values.shape, values.shape, **told)[...] = values
    group.attrs.update(seal_of(single_files(path)))
    zarr.consolidate_metadata(path, zarr_format=ZARR_FORMAT)


def known_arrays(study: Study) -> dict[str, np.ndarray[Any, Any]]:
    """Return the arrays that follow from the study: its axes, and the seeds."""
    seeds = np.array([study.seed(number) for number in range(study.count)], dtype=SEED.dtype)
    return {**_coordinates(study), SEED.name: seeds.reshape(study.shape)}


def _attributes(study: Study) -> dict[str, str]:
    wanted = parse_input(study.tables(0))
    versions = {"python": platform.python_version()} | {one: version(one) for one in _LIBRARIES}
    return {
        "study": json.dumps(study.dump()),
        "versions": json.dumps(versions),
        "software": software(),
        "units": json.dumps(build_model(wanted).units.names()),
        "load": wanted.tell({axis.key for axis in study.axes}),
        "undula_format": FORMAT,
    }


def _coordinates(study: Study) -> dict[str, np.ndarray[Any, Any]]:
    along = {axis.key: np.array(axis.values) for axis in study.axes}
    along |= {TRY: np.arange(study.shape[-1])}
    if study.keep == "period":
        along |= {"axis": np.array(["x", "y", "z"])}
    return along


def _add_variables(group: zarr.Group, study: Study, model: Model) -> None:
    dims = _dims(study)
    lengths = {"shape": SHAPES, "instant": INSTANTS, "node": model.links + 1, "axis": 3}
    columns = columns_of(study.label, study.keep, study.undecided)
    largest = 8
    if study.keep == "period":
        largest *= SHAPES * lengths["node"] * lengths["axis"]
    chunks = chunk_shape(study.shape, point_bytes=largest, whole_lines=study.whole_lines)
    units = {**model.units.names(), "rate": "1/T"}
    for column in columns:
        further = INNER.get(column.name, ())
        inner = tuple(lengths[name] for name in further)
        _add(
            group,
            column.name,
            column.dtype,
            (*study.shape, *inner),
            (*chunks, *inner),
            dims=(*dims, *further),
            attributes=_told(column, units),
        )


def _dims(study: Study) -> tuple[str, ...]:
    return (*(axis.key for axis in study.axes), TRY)


def _told(column: Column, units: dict[str, str]) -> dict[str, Any]:
    """Return the attributes of a variable."""
    told: dict[str, Any] = {"long_name": column.meaning}
    if column.quantity:
        told["units"] = units[column.quantity]
    if column is STATUS:
        told |= {
            "flag_values": list(range(len(STATUS_WORDS))),
            "flag_meanings": " ".join(STATUS_WORDS),
        }
    return told


def _add(
    group: zarr.Group,
    name: str,
    dtype: str,
    shape: tuple[int, ...],
    chunks: tuple[int, ...],
    *,
    dims: tuple[str, ...],
    attributes: dict[str, Any] | None = None,
) -> Any:
    return group.create_array(
        name,
        shape=shape,
        chunks=chunks,
        dtype=dtype,
        # As filters, for the checksum to be of the compressed bytes: none of them is looked at
        # before it is known to be whole.
        filters=[get_numcodec({"id": "blosc"}), get_numcodec({"id": CHECKSUM})],
        compressors=None,
        # What is missing is damage.
        config={"write_empty_chunks": True},
        # Of numbers and texts without one, 0 and the empty text are read where nothing is written.
        fill_value=np.nan if dtype == "float64" else None,
        attributes={"_ARRAY_DIMENSIONS": list(dims), **(attributes or {})},
    )
