"""Physical values of dimensionless units in the labels of a figure.

The style of a figure is set within a context, and with it the physical units: labels state them
while the figure is drawn, so that no function between has to pass them on.
"""

import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

import xarray as xr

from undula.models.scales import Scales
from undula.schema.physical_units import UNITS_PHYSICAL

#: Value and unit of one dimensionless unit by quantity, as `Scales.units` returns them.
PhysicalUnits = Mapping[str, Mapping[str, Any]]

_units: ContextVar[PhysicalUnits | None] = ContextVar("physical units of a figure", default=None)


def physical_units_of(source: Scales | xr.Dataset | None) -> PhysicalUnits | None:
    """Return the physical units of scales or of a stored result, None without any.

    Parameters
    ----------
    source
        Scales, or a stored result, whose attribute holds them.
    """
    if isinstance(source, Scales):
        return source.units()
    stored = None if source is None else source.attrs.get(UNITS_PHYSICAL)
    units: PhysicalUnits | None = json.loads(stored) if isinstance(stored, str) else None
    return units


@contextmanager
def labelled(units: PhysicalUnits | None) -> Iterator[None]:
    """Let labels state physical units within a context, none for None."""
    token = _units.set(units)
    try:
        yield
    finally:
        _units.reset(token)


def equal_to(quantity: str) -> str:
    """Return the physical value of one unit after an equals sign, as a formula; empty without.

    Parameters
    ----------
    quantity
        Quantity of the unit.
    """
    units = _units.get()
    if units is None:
        return ""
    # A letter for the prefix micro, and thin spaces between the factors.
    unit = units[quantity]["unit"].replace(" ", r"\,").replace("um", r"\mu m")
    unit = f"{unit.removeprefix('1/')}^{{-1}}" if unit.startswith("1/") else unit
    return rf"={units[quantity]['value']:.4g}\,\mathrm{{{unit}}}"


def in_physical(quantity: str, value: float) -> str:
    """Return a number in its physical unit, in brackets after a blank; empty without."""
    units = _units.get()
    if units is None:
        return ""
    unit = units[quantity]["unit"].replace("um", "µm")
    return f" ({units[quantity]['value'] * value:.4g} {unit})"
