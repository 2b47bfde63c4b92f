"""Solved borders kept beside a stored study, to be used again as long as they are of the same one.

They are one file of JSON, whole or not at all, that says what it is about.
"""

import json
import math
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from undula.analysis.borders import Borders
from undula.analysis.stable_stretches import Change, Stretches
from undula.analysis.sweep_points import axes_of
from undula.models.model import Model
from undula.studies.build import build_model
from undula.studies.point import software
from undula.studies.spec import parse_input
from undula.studies.study import of_dump
from undula.studies.whole_file import write_whole

#: The file in the folder of a store.
NAME = "borders.json"
_CHANGES = ("fold", "gained", "lost")


def model_of(store: xr.Dataset) -> Model:
    """Return the model of the first point of a stored study, or of what was chosen of it."""
    study = of_dump(json.loads(store.attrs["study"]))
    first = [
        int(np.argmax(np.array(axis.values) == store[axis.key].values.flat[0]))
        for axis in study.axes
    ]
    number = int(np.ravel_multi_index([*first, 0], study.shape))
    return build_model(parse_input(study.tables(number)))


def kept_borders(path: Path, store: xr.Dataset) -> Borders | None:
    """Return the borders that are kept beside a study, None if they are of something else."""
    try:
        kept = json.loads((path / NAME).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    if not isinstance(kept, dict) or kept.get("about") != _about(store):
        return None
    return _read(kept["borders"])


def keep_borders(path: Path, store: xr.Dataset, borders: Borders) -> None:
    """Write borders beside a study, in place of any earlier ones.

    Raises
    ------
    InputError
        The folder cannot be written or is full.
    """
    content = {"about": _about(store), "borders": told(borders)}
    image = json.dumps(content, indent=1, allow_nan=False).encode()
    write_whole(path / NAME, image, overwrite=True)


def told(borders: Borders) -> dict[str, Any]:
    """Return borders in plain JSON types, null in place of what is not finite."""
    plain = {
        "parameter": borders.parameter,
        "values": list(borders.values),
        "up_to": borders.up_to,
        "columns": [
            {kind: asdict(state) for kind, state in column.items()} for column in borders.columns
        ],
    }
    return _finite(plain)  # type: ignore[no-any-return]


def _about(store: xr.Dataset) -> dict[str, Any]:
    """Return all that borders follow from: the study, what was chosen of it, and the version."""
    chosen = {name: store[name].values.tolist() for name in axes_of(store)}
    return {"study": json.loads(store.attrs["study"]), "values": chosen, "undula": software()}


def _read(kept: Mapping[str, Any]) -> Borders:
    return Borders(
        kept["parameter"],
        tuple(math.nan if value is None else value for value in kept["values"]),
        kept["up_to"],
        tuple(
            {kind: _stretches(state) for kind, state in column.items()}
            for column in kept["columns"]
        ),
    )


def _stretches(kept: Mapping[str, Any]) -> Stretches:
    """Return what is known of a state; what is not finite in it is always infinite."""
    changes = {name: kept[name] and Change(**kept[name]) for name in _CHANGES}
    return Stretches(
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
