"""Stored runs as points of a diagram: a parameter, a frequency and an energy each."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import xarray as xr

from undula.analysis.observables.shapes import Range
from undula.errors import is_number
from undula.views.common.style import UnitNames
from undula.views.run.reading import units_of


@dataclass(frozen=True)
class StoredPoint:
    """The final motion of a run, with its parameter.

    Attributes
    ----------
    value : float
        The parameter.
    frequency : float
        Cycles per T.
    energy : Range
        Bending energy at the end of the run.
    """

    value: float
    frequency: float
    energy: Range


def stored_points(
    runs: Sequence[xr.Dataset], parameter: str, units: UnitNames
) -> list[StoredPoint]:
    """Return the points of the runs whose parameter, frequency and energy can be read.

    Parameters
    ----------
    runs : sequence of xarray.Dataset
        Stored runs, as `undula.load_result` returns them.
    parameter : str
        Name of the parameter, such as "load.force".
    units : mapping of str to str
        Names of the diagram's units.

    Returns
    -------
    list of StoredPoint
        Runs that end straight, have no frequency, lack the parameter or have other units are left
        out.
    """
    points = [_point(run, parameter, units) for run in runs]
    return [point for point in points if point is not None]


def _point(run: xr.Dataset, parameter: str, units: UnitNames) -> StoredPoint | None:
    summary = _mapping(json.loads(run.attrs.get("summary", "{}")))
    if units_of(summary) != units:
        return None
    value = _parameter(_mapping(json.loads(run.attrs.get("input", "{}"))), parameter)
    energy = _mapping(summary.get("bending_energy"))
    numbers = (value, summary.get("frequency"), *(energy.get(k) for k in ("min", "max", "mean")))
    # A motion that decays to straight has a frequency, but is not a state.
    if not all(is_number(number) for number in numbers) or summary.get("verdict") == "straight":
        return None
    value, frequency, *bounds = (float(number) for number in numbers if number is not None)
    return StoredPoint(value, frequency, Range(*bounds))


def _parameter(tables: Mapping[str, Any], parameter: str) -> Any:
    """Return a parameter from an input file's tables, or from a model's fields and its load's."""
    table, _, key = parameter.partition(".")
    inner = _mapping(_mapping(tables.get("model")).get(table))
    return _mapping(tables.get(table)).get(key, inner.get(key))


def _mapping(value: Any) -> Mapping[str, Any]:
    return value if isinstance(value, Mapping) else {}
