"""Kinds of the keys of a JSON object: quantities, numbers without a unit, and names."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

#: Without a unit: words, numbers of things, ratios, angles in radians, and mixed lists.
UNITLESS = "unitless"
#: Quantities with a unit.
LENGTH, TIME, FREQUENCY, RATE = "length", "time", "frequency", "rate"
FORCE, ENERGY = "force", "energy"


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


def plain(*names: str) -> Keys:
    """Return keys without a unit."""
    return dict.fromkeys(names, UNITLESS)


def with_error(name: str, quantity: str) -> Keys:
    """Return the keys of a number and of its error."""
    return {name: quantity, f"{name}_error": quantity}


def range_of(quantity: str) -> Keys:
    """Return the keys of the range of a quantity."""
    return dict.fromkeys(("min", "max", "mean"), quantity)
