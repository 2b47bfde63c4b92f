"""Numbers of an input that are given with their units, such as ``load.force = "8 pN"``.

They are converted before the input is checked, so that everything behind reads dimensionless
numbers. Only the table ``[units]`` is checked here, since it gives the scales.
"""

from collections.abc import Mapping
from functools import partial
from typing import Any, cast

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from undula.errors import InputError
from undula.inputs.messages import explain
from undula.inputs.units_table import UnitsTable
from undula.models.scales import Quantity, Scales
from undula.models.units import FILAMENT_UNITS
from undula.schema.physical_units import INPUT_QUANTITIES
from undula.schema.unit_texts import example_of, has_unit, si_value

#: Keys of an axis that hold values of the key that it varies.
_OF_AXIS = ("values", "from", "to")
#: First characters of a number.
_BEGINNINGS = tuple("+-.0123456789")
#: Quantities of the lists in a table of the natural curvature.
_OF_TABLE = {"s": "length"}


class _Units(BaseModel):
    """The table ``[units]`` alone."""

    model_config = ConfigDict(strict=True)

    units: UnitsTable | None = Field(default=None, description="a table")


def dimensionless(tables: Mapping[str, Any]) -> dict[str, Any]:
    """Return a copy of tables in which numbers with a unit are dimensionless.

    Parameters
    ----------
    tables
        Keys and values by table, as given; whatever is no number with a unit stays.

    Raises
    ------
    InputError
        A unit is unknown or belongs to another quantity, or the table ``[units]`` is wrong or
        missing. The sentence names the key and the cure.
    """
    scales = _scales(tables)
    return {
        name: _of_study(table, scales) if name == "study" else _of_table(name, table, scales)
        for name, table in tables.items()
    }


def _scales(tables: Mapping[str, Any]) -> Scales | None:
    """Return the scales of the table ``[units]``, None without one."""
    if "units" not in tables:
        return None
    try:
        units = _Units.model_validate({"units": tables["units"]}).units
    except ValidationError as error:
        raise InputError(explain(error, _Units)) from None
    return None if units is None else units.scales


def _of_table(name: str, table: Any, scales: Scales | None) -> Any:
    if not isinstance(table, Mapping):
        return table
    return {key: _value(f"{name}.{key}", value, scales) for key, value in table.items()}


def _of_study(table: Any, scales: Scales | None) -> Any:
    """Return a table ``[study]``, with the values of its axes in the units of their keys."""
    axes = table.get("axes") if isinstance(table, Mapping) else None
    if not isinstance(axes, list):
        return table
    return {**table, "axes": [_axis(axis, scales) for axis in axes]}


def _axis(axis: Any, scales: Scales | None) -> Any:
    if not isinstance(axis, Mapping):
        return axis
    varied = axis.get("key")
    convert = partial(_value, varied if isinstance(varied, str) else "", scales=scales)
    return {key: convert(value) if key in _OF_AXIS else value for key, value in axis.items()}


def _value(key: str, value: Any, scales: Scales | None) -> Any:
    """Return a value of a key, dimensionless if it was given with a unit."""
    quantity = INPUT_QUANTITIES.get(key)
    return value if quantity is None else _number(key, value, quantity, scales)


def _number(key: str, value: Any, quantity: str, scales: Scales | None) -> Any:
    if isinstance(value, Mapping):
        return {
            name: _number(f"{key}.{name}", part, _OF_TABLE.get(str(name), quantity), scales)
            for name, part in value.items()
        }
    if isinstance(value, list):
        return [_number(key, part, quantity, scales) for part in value]
    # Other texts are words, as "settled", or are refused by the check of the key.
    if not isinstance(value, str) or not value.lstrip().startswith(_BEGINNINGS):
        return value
    if scales is not None:
        number = scales.from_si(cast(Quantity, quantity), si_value(key, value, quantity))
        return float(f"{number:.15g}")  # without the round-off of the conversion
    if not has_unit(value):
        return value
    unit = FILAMENT_UNITS.names().get(quantity)
    plain = f"a number in {unit}" if unit else "a dimensionless number"
    raise InputError(
        f"{key} = {value!r} has a unit, which needs a table [units] with the filament's length and"
        f" stiffness, such as units.length = '{example_of('length')}'; give one, or {plain}"
    )
