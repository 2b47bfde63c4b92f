"""Numbers of an answer in physical units, found by the quantities of its keys."""

from collections.abc import Callable, Mapping
from typing import Any

from undula.schema.key_kinds import OF_PARAMETER, UNITLESS, Keys, Named, is_range
from undula.schema.physical_units import INPUT_QUANTITIES

#: A function of a quantity and a dimensionless number: the value and the unit.
Convert = Callable[[Any, float], tuple[float, str]]
#: Keys under which an object names the parameter to which its numbers belong.
_NAMES = ("parameter", "key")


def physical_numbers(answer: Mapping[str, Any], keys: Keys, convert: Convert) -> dict[str, Any]:
    """Return the numbers of an answer that have a unit, in physical units.

    Parameters
    ----------
    answer
        The answer in plain JSON types.
    keys
        Keys that it may hold, with their quantities.
    convert
        Function of a quantity and a dimensionless number that returns the value and the unit.

    Returns
    -------
    dict
        An object in the form of the answer, in which a number is an object of `value` and `unit`.
        What has no unit is left out; a list of objects keeps its length.
    """
    found: dict[str, Any] = _object(answer, keys, convert, "")
    return found


def _object(given: Mapping[str, Any], keys: Any, convert: Convert, parameter: str) -> Any:
    named = next((given[name] for name in _NAMES if isinstance(given.get(name), str)), parameter)
    parts = {name: _part(part, _kind(name, keys), convert, named) for name, part in given.items()}
    return {name: part for name, part in parts.items() if part is not None}


def _kind(name: str, keys: Any) -> Any:
    """Return the quantity or the keys of a key; a parameter has a dot in its name."""
    if isinstance(keys, Named):
        return keys.values
    return keys.get(name, INPUT_QUANTITIES.get(name, UNITLESS))


def _part(value: Any, kind: Any, convert: Convert, parameter: str) -> Any:
    """Return a value in physical units, None without any."""
    if isinstance(value, list | tuple):
        parts = [_part(part, kind, convert, parameter) for part in value]
        return parts if any(part is not None for part in parts) else None
    if isinstance(value, Mapping):
        return None if isinstance(kind, str) else _object(value, kind, convert, parameter) or None
    quantity = _quantity(kind, parameter)
    if quantity == UNITLESS or not _is_number(value):
        return None
    number, unit = convert(quantity, float(value))
    # Without the round-off of the conversion.
    return {"value": float(f"{number:.15g}"), "unit": unit}


def _quantity(kind: Any, parameter: str) -> str:
    if isinstance(kind, str):
        return INPUT_QUANTITIES.get(parameter, UNITLESS) if kind == OF_PARAMETER else kind
    # A quantity that does not change in time is a number in place of its range.
    return str(kind["mean"]) if is_range(kind) else UNITLESS


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
