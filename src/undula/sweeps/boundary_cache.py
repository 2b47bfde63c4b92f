"""Solved borders kept beside a stored study, to be used again as long as they are of the same one.

They are one file of JSON, whole or not at all, that says what it is about and carries its digest.
It is written anew with every column, so that what was solved for is never lost.
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
from undula.sweeps.sweep import of_dump

#: The file in the folder of a store.
NAME = "borders.json"
_CHANGES = ("fold", "gained", "lost")

#: What is known of each kind of state at one value of the parameter.
Column = Mapping[str, StabilityIntervals]


def tables_of(store: xr.Dataset) -> dict[str, Any]:
    """Return the input of the first point of a stored study, or of what was chosen of it."""
    study = of_dump(json.loads(store.attrs["study"]))
    first = [
        int(np.argmax(np.array(axis.values) == store[axis.key].values.flat[0]))
        for axis in study.axes
    ]
    number = int(np.ravel_multi_index([*first, 0], study.shape))
    return study.tables(number)


def columns_of(jobs: Sequence[Mapping[str, Any]]) -> list[Column]:
    """Return columns of borders, solved for by a worker.

    Each job holds the `tables` of an input, and `parameter`, `value` and `up_to`.
    """
    columns: list[Column] = []
    for job in jobs:
        model = build_model(parse_input(job["tables"]))
        columns.append(intervals_at(model, job["parameter"], job["value"], job["up_to"]))
    return columns


def kept_columns(path: Path, store: xr.Dataset) -> list[Column | None]:
    """Return the columns that are kept beside a study, None for those still to be solved for.

    There are none at all if what is kept is of something else, or damaged.
    """
    try:
        kept = unsealed_json((path / NAME).read_bytes())
    except OSError:
        return []
    if kept is None or kept["about"] != _about(store):
        return []
    return [column and _read(column) for column in kept["borders"]["columns"]]


def keep_borders(
    path: Path,
    store: xr.Dataset,
    borders: StabilityBoundaries,
    columns: Sequence[Column | None] = (),
) -> None:
    """Write borders beside a study, in place of any earlier ones.

    Where not all of them are there yet, `columns` are given apart, None for what is missing.

    Raises
    ------
    InputError
        The folder cannot be written or is full.
    """
    content = {"about": _about(store), "borders": told(borders, columns)}
    write_whole(path / NAME, sealed_json(content), overwrite=True)


def told(borders: StabilityBoundaries, columns: Sequence[Column | None]) -> dict[str, Any]:
    """Return borders in plain JSON types, null in place of what is not finite."""
    plain = {
        "parameter": borders.parameter,
        "values": list(borders.values),
        "up_to": borders.up_to,
        "columns": [
            None if column is None else {kind: asdict(state) for kind, state in column.items()}
            for column in columns or borders.columns
        ],
    }
    return _finite(plain)  # type: ignore[no-any-return]


def _about(store: xr.Dataset) -> dict[str, Any]:
    """Return all that borders follow from: the study, what was chosen of it, and the version."""
    chosen = {name: store[name].values.tolist() for name in axes_of(store)}
    return {"study": json.loads(store.attrs["study"]), "values": chosen, "undula": software()}


def _read(column: Mapping[str, Any]) -> Column:
    return {kind: _stretches(state) for kind, state in column.items()}


def _stretches(kept: Mapping[str, Any]) -> StabilityIntervals:
    """Return what is known of a state; what is not finite in it is always infinite."""
    changes = {name: kept[name] and Change(**kept[name]) for name in _CHANGES}
    return StabilityIntervals(
        kept["kind"],
        kept["begins"],
        tuple((low, math.inf if high is None else high) for low, high in kept["stable"]),
        math.inf if kept["known_to"] is None else kept["known_to"],
        reason=kept["reason"],
        **changes,
    )


def _finite(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {name: _finite(part) for name, part in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(part) for part in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
