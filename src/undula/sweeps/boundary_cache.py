"""Cache of solved stability boundaries next to a stored sweep.

The cache is one JSON file that is written whole, states what it belongs to and carries a digest.
It is rewritten after every column, so that no solved column is lost.
"""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from undula.analysis.maps.stability_boundaries import StabilityBoundaries, intervals_at
from undula.analysis.maps.stability_intervals import Change, StabilityIntervals
from undula.inputs.build import build_model
from undula.inputs.input import parse_input
from undula.schema.sweep_axes import axes_of
from undula.storage.atomic import write_whole
from undula.storage.digests import sealed_json, unsealed_json
from undula.sweeps.point import software
from undula.sweeps.sweep import sweep_from_dump

#: Name of the file in the folder of a store.
NAME = "borders.json"
_CHANGES = ("fold", "gained", "lost")
#: Keys of the file that differ from the names of the fields.
_KEYS = {"searched_to": "known_to"}

#: Stability intervals of each kind of state at one value of the parameter.
Column = Mapping[str, StabilityIntervals]


def tables_of(store: xr.Dataset) -> dict[str, Any]:
    """Return the input of the first point of a stored sweep, or of a selection of its points."""
    sweep = sweep_from_dump(json.loads(store.attrs["study"]))
    first = [
        int(np.argmax(np.array(axis.values) == store[axis.key].values.flat[0]))
        for axis in sweep.axes
    ]
    number = int(np.ravel_multi_index([*first, 0], sweep.shape))
    return sweep.tables(number)


def solve_columns(requests: Sequence[Mapping[str, Any]]) -> list[Column]:
    """Solve for columns of stability boundaries; called in a worker.

    Parameters
    ----------
    requests
        One mapping for each column, with the ``tables`` of an input, and ``parameter``, ``value``
        and ``up_to`` as for `intervals_at`.
    """
    columns: list[Column] = []
    for request in requests:
        model = build_model(parse_input(request["tables"]))
        columns.append(
            intervals_at(model, request["parameter"], request["value"], request["up_to"])
        )
    return columns


def read_boundaries(path: Path, store: xr.Dataset) -> list[Column | None]:
    """Return the cached columns of a sweep, None for each that is not solved yet.

    The list is empty if the cache belongs to something else, or is missing or damaged.

    Parameters
    ----------
    path
        Folder of the store.
    store
        The selected part of the sweep.
    """
    try:
        content = unsealed_json((path / NAME).read_bytes())
    except OSError:
        return []
    if content is None or content["about"] != _about(store):
        return []
    return [column and _read(column) for column in content["borders"]["columns"]]


def write_boundaries(
    path: Path,
    store: xr.Dataset,
    boundaries: StabilityBoundaries,
    columns: Sequence[Column | None] = (),
) -> None:
    """Write stability boundaries next to a sweep, in place of any earlier ones.

    Parameters
    ----------
    path
        Folder of the store.
    store
        The selected part of the sweep.
    boundaries
        The boundaries.
    columns
        While some columns are missing: all columns, None for each that is not solved yet.

    Raises
    ------
    InputError
        The folder cannot be written or is full.
    """
    content = {"about": _about(store), "borders": as_dict(boundaries, columns)}
    write_whole(path / NAME, sealed_json(content), overwrite=True)


def as_dict(boundaries: StabilityBoundaries, columns: Sequence[Column | None]) -> dict[str, Any]:
    """Return stability boundaries in plain JSON types, null in place of non-finite numbers.

    Parameters
    ----------
    boundaries
        The boundaries.
    columns
        All columns, None for each that is not solved yet; empty for those of `boundaries`.
    """
    plain = {
        "parameter": boundaries.parameter,
        "values": list(boundaries.values),
        "up_to": boundaries.up_to,
        "columns": [
            None if column is None else {kind: _stored(state) for kind, state in column.items()}
            for column in columns or boundaries.columns
        ],
    }
    return _finite(plain)  # type: ignore[no-any-return]


def _about(store: xr.Dataset) -> dict[str, Any]:
    """Return all that boundaries follow from: the sweep, the selected values and the version."""
    selected = {name: store[name].values.tolist() for name in axes_of(store)}
    return {"study": json.loads(store.attrs["study"]), "values": selected, "undula": software()}


def _stored(intervals: StabilityIntervals) -> dict[str, Any]:
    """Return the stability intervals of a state under the keys of the file."""
    return {_KEYS.get(name, name): value for name, value in asdict(intervals).items()}


def _read(column: Mapping[str, Any]) -> Column:
    return {kind: _intervals(state) for kind, state in column.items()}


def _intervals(stored: Mapping[str, Any]) -> StabilityIntervals:
    """Return the stability intervals of a state; null numbers in them always mean infinity."""
    changes = {name: stored[name] and Change(**stored[name]) for name in _CHANGES}
    return StabilityIntervals(
        stored["kind"],
        stored["begins"],
        tuple((low, math.inf if high is None else high) for low, high in stored["stable"]),
        math.inf if stored["known_to"] is None else stored["known_to"],
        reason=stored["reason"],
        **changes,
    )


def _finite(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {name: _finite(part) for name, part in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(part) for part in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
