"""Targets on the command line: a quantity and its value, such as ``frequency=120``."""

import math
from collections.abc import Mapping

from undula.errors import InputError
from undula.models.scales import Quantity, Scales
from undula.schema.unit_texts import example_of, has_unit, si_value

#: Quantity of a target by the beginning of its name; it fixes the units that it may have.
_QUANTITIES: Mapping[str, Quantity] = {
    "frequency": "frequency",
    "leading_rate": "frequency",
    "bending_energy": "energy",
    "tip_": "length",
    "period": "time",
    "value": "force",
}


def parse_target(text: str, scales: Scales | None = None) -> tuple[str, float]:
    """Return the name and the value of a quantity from ``NAME=NUMBER``.

    Parameters
    ----------
    text
        Such as ``frequency=120``, or with scales ``frequency=20 Hz``.
    scales
        Those of the filament, if its input has a table ``[units]``.

    Raises
    ------
    InputError
        The text has another form, the number is not finite, or its unit needs scales or is of
        another quantity.
    """
    name, equals, value = (part.strip() for part in text.partition("="))
    if not (name and equals and value):
        raise InputError(f"target {text} has no 'NAME=NUMBER'; write it like frequency=120")
    try:
        number = float(value)
    except ValueError:
        number = _with_unit(text, name, value, scales)
    if not math.isfinite(number):
        raise InputError(f"target {text}: {value} is not a finite number; give one")
    return name, number


def _with_unit(text: str, name: str, value: str, scales: Scales | None) -> float:
    quantity = next((q for start, q in _QUANTITIES.items() if name.startswith(start)), None)
    if quantity is None or not has_unit(value):
        raise InputError(f"target {text}: {value} is no number; write it like frequency=120")
    if scales is None:
        raise InputError(
            f"target {text} has a unit, which needs a table [units] with the filament's length and"
            f" stiffness, such as units.length = '{example_of('length')}'; give one, or a number"
            " without a unit"
        )
    return scales.from_si(quantity, si_value(f"target {name}", value, quantity))


def parse_between(option: str, text: str) -> tuple[float, float]:
    """Return the ends of a range from ``LOW:HIGH``.

    Parameters
    ----------
    option
        Name of the option, for messages.
    text
        Two numbers, the lower one first.

    Raises
    ------
    InputError
        The text is not two finite numbers, or the second is not above the first.
    """
    try:
        low, high = (float(part) for part in text.split(":"))
    except ValueError:
        raise InputError(f"{option} {text} is no range; write LOW:HIGH, as 40:300") from None
    if not (math.isfinite(low) and math.isfinite(high)):
        raise InputError(f"{option} {text}: an end is not a finite number; give two")
    if not low < high:
        raise InputError(f"{option} {text} does not rise; give the lower end first, as 40:300")
    return low, high
