"""Layout of a stored sweep: its arrays, their chunks and their attributes."""

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
from undula.inputs.units_table import scales_of
from undula.models.model import Model
from undula.models.scales import Scales
from undula.schema.sweep_axes import REPLICATE
from undula.schema.sweep_variables import INNER, SEED, STATUS, STATUS_WORDS, Column, columns_of
from undula.storage.physical_attributes import (
    coordinate_attributes,
    physical_attributes,
    scales_attributes,
)
from undula.storage.zarr_metadata import seal_of, single_files
from undula.sweeps.chunk_files import CHECKSUM
from undula.sweeps.chunk_grid import chunk_shape
from undula.sweeps.point import software
from undula.sweeps.sweep import Sweep

#: Name and number of the format of a store.
FORMAT = "study 1"
#: Texts of fixed width belong to the second format of Zarr, not yet to the third.
ZARR_FORMAT: Literal[2] = 2
#: The folder of result files in a store.
RUNS = "runs"

_LIBRARIES = ("undula", "numpy", "numba")


def lay_out(path: Path, sweep: Sweep) -> None:
    """Make the store of a sweep without any results, whole or not at all.

    If another process was quicker, the store that it has made stays.

    Parameters
    ----------
    path
        Folder of the store.
    sweep
        The sweep.

    Raises
    ------
    OSError
        The folder cannot be written, or is full.
    """
    temporary = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        _fill(temporary, sweep)
        os.rename(temporary, path)
    except OSError as error:
        if error.errno not in (errno.ENOTEMPTY, errno.EEXIST):
            raise
    finally:
        shutil.rmtree(temporary, ignore_errors=True)


def _fill(path: Path, sweep: Sweep) -> None:
    """Make a folder with the metadata, the axes and the seeds of a sweep, and without results."""
    wanted = parse_input(sweep.tables(0))
    model = build_model(wanted)
    group = zarr.create_group(path, zarr_format=ZARR_FORMAT, attributes=_attributes(sweep))
    _add_variables(group, sweep, model)
    units = model.units.names()
    seeds = {"dims": _dims(sweep), "attributes": _attributes_of(SEED, units, None)}
    for name, values in derived_arrays(sweep).items():
        described = coordinate_attributes(scales_of(sweep.shared), name, units)
        options: dict[str, Any] = (
            seeds if name == SEED.name else {"dims": (name,), "attributes": described}
        )
        # These follow from the sweep and are never written again.
        _add(group, name, values.dtype.str, values.shape, values.shape, **options)[...] = values
    group.attrs.update(seal_of(single_files(path)))
    zarr.consolidate_metadata(path, zarr_format=ZARR_FORMAT)


def derived_arrays(sweep: Sweep) -> dict[str, np.ndarray[Any, Any]]:
    """Return the arrays that follow from the sweep: its axes, and the seeds."""
    seeds = np.array([sweep.seed(number) for number in range(sweep.count)], dtype=SEED.dtype)
    return {**_coordinates(sweep), SEED.name: seeds.reshape(sweep.shape)}


def _attributes(sweep: Sweep) -> dict[str, str]:
    wanted = parse_input(sweep.tables(0))
    versions = {name: version(name) for name in _LIBRARIES}
    versions = {"python": platform.python_version()} | versions
    return {
        "study": json.dumps(sweep.dump()),
        "versions": json.dumps(versions),
        "software": software(),
        "units": json.dumps(build_model(wanted).units.names()),
        "load": wanted.describe({axis.key for axis in sweep.axes}),
        "undula_format": FORMAT,
        **scales_attributes(scales_of(sweep.shared)),
    }


def _coordinates(sweep: Sweep) -> dict[str, np.ndarray[Any, Any]]:
    coordinates = {axis.key: np.array(axis.values) for axis in sweep.axes}
    coordinates |= {REPLICATE: np.arange(sweep.shape[-1])}
    if sweep.keep == "period":
        coordinates |= {"axis": np.array(["x", "y", "z"])}
    return coordinates


def _add_variables(group: zarr.Group, sweep: Sweep, model: Model) -> None:
    dims = _dims(sweep)
    lengths = {"shape": SHAPES, "instant": INSTANTS, "node": model.links + 1, "axis": 3}
    columns = columns_of(sweep.label, sweep.keep, sweep.undecided)
    point_bytes = 8
    if sweep.keep == "period":
        point_bytes *= SHAPES * lengths["node"] * lengths["axis"]
    chunk = chunk_shape(sweep.shape, point_bytes=point_bytes, whole_rows=sweep.whole_rows)
    units = {**model.units.names(), "rate": "1/T"}
    for column in columns:
        inner_dims = INNER.get(column.name, ())
        inner = tuple(lengths[name] for name in inner_dims)
        _add(
            group,
            column.name,
            column.dtype,
            (*sweep.shape, *inner),
            (*chunk, *inner),
            dims=(*dims, *inner_dims),
            attributes=_attributes_of(column, units, scales_of(sweep.shared)),
        )


def _dims(sweep: Sweep) -> tuple[str, ...]:
    return (*(axis.key for axis in sweep.axes), REPLICATE)


def _attributes_of(column: Column, units: dict[str, str], scales: Scales | None) -> dict[str, Any]:
    """Return the attributes of a variable."""
    attributes: dict[str, Any] = {"long_name": column.meaning}
    if column.quantity:
        attributes["units"] = units[column.quantity]
        attributes |= physical_attributes(scales, column.quantity)
    if column is STATUS:
        attributes |= {
            "flag_values": list(range(len(STATUS_WORDS))),
            "flag_meanings": " ".join(STATUS_WORDS),
        }
    return attributes


def _add(
    group: zarr.Group,
    name: str,
    dtype: str,
    shape: tuple[int, ...],
    chunk: tuple[int, ...],
    *,
    dims: tuple[str, ...],
    attributes: dict[str, Any] | None = None,
) -> Any:
    return group.create_array(
        name,
        shape=shape,
        chunks=chunk,
        dtype=dtype,
        # As filters the checksum covers the compressed bytes, which are checked before any of
        # them is decoded.
        filters=[get_numcodec({"id": "blosc"}), get_numcodec({"id": CHECKSUM})],
        compressors=None,
        # Empty chunks are written too, so that a missing file always means damage.
        config={"write_empty_chunks": True},
        # Without a fill value, unwritten numbers read as 0 and unwritten texts as empty.
        fill_value=np.nan if dtype == "float64" else None,
        attributes={"_ARRAY_DIMENSIONS": list(dims), **(attributes or {})},
    )
