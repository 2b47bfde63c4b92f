"""Kinds of the keys of a JSON object: quantities, numbers without a unit, and names."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

#: Without a unit: words, numbers of things, ratios, angles in radians, and mixed lists.
UNITLESS = "unitless"
#: Quantities with a unit.
LENGTH, TIME, FREQUENCY, RATE = "length", "time", "frequency", "rate"
FORCE, ENERGY = "force", "energy"
#: The quantity of the parameter that the answer, or the object itself, names.
OF_PARAMETER = "of the parameter"


@dataclass(frozen=True)
class Named:
    """An object whose keys are names that the input or the outcome gives, as verdicts.

    Attributes
    ----------
    values
        Quantity or keys of each of its values.
    """

    values: Any


#: The keys of an object by their names.
Keys = Mapping[str, Any]
#: The key under which an object holds the value of a parameter: the parameter's own name.
PARAMETER = "<parameter>"
#: The key of the numbers of an answer in physical units.
PHYSICAL = "physical"
_RANGE = ("min", "max", "mean")
_PHYSICAL_NUMBER = ("value", "unit")


def plain(*names: str) -> Keys:
    """Return keys without a unit."""
    return dict.fromkeys(names, UNITLESS)


def with_error(name: str, quantity: str) -> Keys:
    """Return the keys of a number and of its error."""
    return {name: quantity, f"{name}_error": quantity}


def range_of(quantity: str) -> Keys:
    """Return the keys of the range of a quantity."""
    return dict.fromkeys(_RANGE, quantity)


def is_range(keys: Any) -> bool:
    """Return True for the keys of a range."""
    return isinstance(keys, Mapping) and tuple(keys) == _RANGE


def with_physical(keys: Keys) -> Keys:
    """Return the keys of an answer together with those of its numbers in physical units."""
    physical = _physical(keys)
    return {**keys, PHYSICAL: physical} if physical else keys


def _physical(keys: Any) -> Any:
    """Return the keys of physical numbers: an object in place of a number with a unit."""
    if isinstance(keys, Named):
        inner = _physical(keys.values)
        return Named(inner) if inner else {}
    if isinstance(keys, str):
        return {} if keys == UNITLESS else plain(*_PHYSICAL_NUMBER)
    inners = {name: _physical(inner) for name, inner in keys.items()}
    if PARAMETER in keys:
        inners[PARAMETER] = plain(*_PHYSICAL_NUMBER)
    if is_range(keys):
        # A quantity that does not change in time is a number in place of its range.
        inners |= plain(*_PHYSICAL_NUMBER)
    return {name: inner for name, inner in inners.items() if inner}
