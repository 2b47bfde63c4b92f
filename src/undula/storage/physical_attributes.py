"""Attributes of stored results that give their numbers in physical units.

A result of an input with ``[units]`` has the attribute ``units_physical``, one dimensionless unit
of each quantity. Its variables have ``physical_unit`` and ``physical_factor``: a number times the
factor is in this unit.
"""

import json
from collections.abc import Mapping
from typing import Any, cast

import xarray as xr

from undula.models.scales import Quantity, Scales
from undula.schema.physical_units import INPUT_QUANTITIES, UNITS_PHYSICAL

#: Further name of the unit of time, in files of runs.
_FURTHER = {"L^4 zeta_perp / B": "time", "1/T": "rate"}


def physical_attributes(scales: Scales | None, quantity: str) -> dict[str, Any]:
    """Return the attributes of a variable; empty without scales or quantity.

    Parameters
    ----------
    scales
        SI values of the dimensionless units, or None.
    quantity
        Quantity of the variable; empty for a variable without a unit.
    """
    if scales is None or not quantity:
        return {}
    factor, unit = scales.physical(cast(Quantity, quantity), 1.0)
    return {"physical_unit": unit, "physical_factor": factor}


def scales_attributes(scales: Scales | None) -> dict[str, str]:
    """Return the attribute of a result with one dimensionless unit of each quantity."""
    return {} if scales is None else {UNITS_PHYSICAL: json.dumps(scales.units())}


def coordinate_attributes(
    scales: Scales | None, key: str, names: Mapping[str, str]
) -> dict[str, Any]:
    """Return the attributes of a coordinate that is a key of the input; empty without scales.

    Parameters
    ----------
    scales
        SI values of the dimensionless units, or None.
    key
        Key of the input, such as "load.force".
    names
        Names of the dimensionless units by quantity.
    """
    quantity = INPUT_QUANTITIES.get(key, "")
    if scales is None or quantity not in names:
        return {}
    return {"units": names[quantity], **physical_attributes(scales, quantity)}


def with_physical_attributes(
    dataset: xr.Dataset, scales: Scales | None, names: Mapping[str, str]
) -> xr.Dataset:
    """Return a result whose variables have physical units, by the names of their units.

    Parameters
    ----------
    dataset
        The result; without scales it is returned unchanged.
    scales
        SI values of the dimensionless units, or None.
    names
        Names of the dimensionless units by quantity.
    """
    if scales is None:
        return dataset
    quantities = _FURTHER | {name: quantity for quantity, name in names.items()}
    described = dataset.assign_attrs(scales_attributes(scales))
    for variable in described.variables.values():
        quantity = quantities.get(str(variable.attrs.get("units", "")), "")
        variable.attrs.update(physical_attributes(scales, quantity))
    return described
