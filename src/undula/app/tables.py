"""Tables of answers, with which commands answer in comma-separated values."""

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from undula.schema.answer_keys import ANSWERS
from undula.schema.key_kinds import UNITLESS
from undula.schema.sweep_variables import FIGURES, INNER, SOLVED, STATUS, STATUS_WORDS
from undula.terminal.csv_table import csv_text

_KIND = "kind"


def stability_table(answer: Mapping[str, Any]) -> str:
    """Return the rates, or the thresholds, of the straight state along forces and a parameter."""
    name = "points" if "points" in answer else "thresholds"
    return csv_text(answer[name], ANSWERS["stability"][name], answer["units"])


def threshold_table(answer: Mapping[str, Any]) -> str:
    """Return the thresholds along a parameter."""
    keys = ANSWERS["threshold"]["thresholds"]
    return csv_text(answer["thresholds"], keys, answer["units"])


def branch_table(answer: Mapping[str, Any]) -> str:
    """Return the points of one branch, or of several with the kind of each."""
    if "branches" in answer:
        parts = [
            {_KIND: part[_KIND]} | point
            for part in answer["branches"]
            for point in part.get("points", ())
        ]
    else:
        parts = answer.get("points", [])
    keys = {_KIND: UNITLESS, **ANSWERS["follow"]["points"]}
    return csv_text(parts, keys, answer["units"])


def ramp_table(answer: Mapping[str, Any]) -> str:
    """Return the steps of a ramp, with the parameter under its own name."""
    steps = [
        {answer["parameter"]: step["value"]}
        | {name: value for name, value in step.items() if name != "value"}
        for step in answer["steps"]
    ]
    return csv_text(steps, ANSWERS["step"]["steps"], answer["units"])


def sweep_table(stored: xr.Dataset) -> str:
    """Return the points of a stored sweep with their results, one in each line.

    Parameters
    ----------
    stored
        The sweep, as `undula.sweeps.store.load_sweep` opens it, without shapes.
    """
    dims = stored[STATUS.name].dims
    names = [str(name) for name in stored.data_vars if name not in INNER]
    places = np.unravel_index(np.arange(stored[STATUS.name].size), stored[STATUS.name].shape)
    axes = zip(dims, places, strict=True)
    columns = {str(name): stored[name].values[place].tolist() for name, place in axes}
    columns |= {name: stored[name].transpose(*dims).values.ravel().tolist() for name in names}
    columns[STATUS.name] = [STATUS_WORDS[code] for code in columns[STATUS.name]]
    rows = [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]
    quantities = {column.name: column.quantity for column in (*FIGURES, *SOLVED)}
    return csv_text(rows, quantities, json.loads(stored.attrs["units"]))
