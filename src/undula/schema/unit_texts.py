"""Texts of a number and its unit, such as "25 pN um^2", converted to SI numbers by pint.

The grammar of the unit is checked before pint reads it, which would evaluate any arithmetic. The
import of pint takes about a second and happens at the first text.
"""

import math
import re
import sys
from collections.abc import Mapping
from functools import cache
from typing import Any

from undula.errors import InputError

#: SI unit of a quantity, and a text as an example.
_QUANTITIES: Mapping[str, tuple[str, str]] = {
    "stiffness": ("N m^2", "25 pN um^2"),
    "viscosity": ("Pa s", "1 mPa s"),
    "length": ("m", "12 um"),
    "time": ("s", "0.2 s"),
    "frequency": ("Hz", "20 Hz"),
    "rate": ("1/s", "20 1/s"),
    "force": ("N", "8 pN"),
    "force_density": ("N/m", "0.1 pN/um"),
    "energy": ("J", "40 pN um"),
    "power": ("W", "40 pN um/s"),
    "curvature": ("1/m", "0.1 1/um"),
}
#: Least and largest SI value of the properties of a filament and its fluid.
_RANGES: Mapping[str, tuple[float, float]] = {
    "stiffness": (1e-36, 1e6),
    "viscosity": (1e-9, 1e12),
    "length": (1e-9, 1e3),
}
_NUMBER = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(.*?)\s*", re.DOTALL)
_POWER = r"(?:(?:\^|\*\*)?-?[1-9]|[⁻]?[¹²³⁴⁵⁶⁷⁸⁹])?"
_UNIT = re.compile(rf"(?:1\s*/\s*)?[^\W\d_]+{_POWER}(?:(?:\s*[*/·]\s*|\s+)[^\W\d_]+{_POWER})*")
#: What pint may raise for a unit, besides its own errors.
_FAILURES = (ArithmeticError, AttributeError, TypeError, ValueError)
#: Longest unit [characters], and longest part of a wrong text that is shown.
_LONGEST_UNIT, _LONGEST_SHOWN = 40, 40


def has_unit(text: str) -> bool:
    """Return True for a text of a number and a known unit."""
    match = _NUMBER.fullmatch(text)
    if match is None or len(match.group(2)) > _LONGEST_UNIT or not _UNIT.fullmatch(match.group(2)):
        return False
    registry, errors = _registry()
    try:
        registry.Quantity(1.0, match.group(2).replace("·", "*"))
    except (errors.PintError, *_FAILURES):
        return False
    return True


def example_of(quantity: str) -> str:
    """Return a text of a quantity, such as "8 pN"."""
    return _QUANTITIES[quantity][1]


def si_value(name: str, text: object, quantity: str, *, of_filament: bool = False) -> float:
    """Return the SI value of a text of a number and its unit.

    Parameters
    ----------
    name
        Name of the value in the sentence of an error.
    text
        A text such as ``"12 um"``.
    quantity
        Quantity of the value: one of `undula.schema.physical_units.SHOWN_IN`, "stiffness" or
        "viscosity".
    of_filament
        True for a property of the filament and its fluid, which has to be above 0 and within
        bounds that no microfilament reaches.

    Raises
    ------
    InputError
        The text has no number or no unit, the unit is unknown or belongs to another quantity, or
        the value is out of range. The sentence names the cure.

    Examples
    --------
    >>> si_value("force", "8 pN", "force")
    8e-12
    """
    unit, example = _QUANTITIES[quantity]
    named = f"{'an' if quantity == 'energy' else 'a'} {quantity.replace('_', ' ')}"
    shown = f"{name} = {_shown(text)}"
    cure = f"give {named} with its unit, such as '{example}'"
    match = _NUMBER.fullmatch(text) if isinstance(text, str) else None
    if match is None:
        raise InputError(f"{shown} is not a number and its unit; {cure}")
    number, given = float(match.group(1)), match.group(2)
    if not given:
        raise InputError(f"{shown} has no unit; {cure}")
    # Without the round-off of the factor: 25 pN um^2 is 2.5e-23 N m^2.
    value = float(f"{number * _factor(given, unit, f'{shown} has a unit that', named, cure):.15g}")
    least, largest = _RANGES[quantity] if of_filament else (-sys.float_info.max, sys.float_info.max)
    if of_filament and not value > 0.0:
        raise InputError(f"{shown} is not above 0; {cure}")
    if not least <= value <= largest:
        raise InputError(
            f"{shown} is {value:.3g} {unit}, which is out of range; give {named} from {least:.3g}"
            f" to {largest:.3g} {unit}"
        )
    return value


def _shown(text: object) -> str:
    shown = repr(text)
    return shown if len(shown) <= _LONGEST_SHOWN else f"{shown[: _LONGEST_SHOWN - 3]}..."


def _factor(given: str, unit: str, beginning: str, named: str, cure: str) -> float:
    """Return the SI value of a unit; refuse one that is unknown or of another quantity."""
    if len(given) > _LONGEST_UNIT or not _UNIT.fullmatch(given):
        raise InputError(f"{beginning} cannot be read; {cure}")
    registry, errors = _registry()
    try:
        one_unit = registry.Quantity(1.0, given.replace("·", "*"))
        value = float(one_unit.to(unit).magnitude)
        # pint takes angles for plain numbers, so that 60 rpm would be 6.28 Hz.
        of_angle = "radian" in f"{one_unit.to_base_units().units}"
    except errors.UndefinedUnitError:
        raise InputError(f"{beginning} is not known; {cure}") from None
    except errors.DimensionalityError:
        raise InputError(f"{beginning} is not that of {named}; {cure}") from None
    except (errors.PintError, *_FAILURES):
        raise InputError(f"{beginning} cannot be read; {cure}") from None
    if of_angle:
        raise InputError(f"{beginning} is one of an angle; {cure}")
    if not math.isfinite(value):
        raise InputError(f"{beginning} is out of range; {cure}")
    return value


@cache
def _registry() -> tuple[Any, Any]:
    """Return pint's units and the module of its errors."""
    import pint

    return pint.UnitRegistry(), pint.errors
