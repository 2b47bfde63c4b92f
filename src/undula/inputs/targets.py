"""Targets on the command line: a quantity and its value, such as ``frequency=120``."""

import math

from undula.errors import InputError


def parse_target(text: str) -> tuple[str, float]:
    """Return the name and the value of a quantity from ``NAME=NUMBER``.

    Raises
    ------
    InputError
        The text has another form, or the number is not finite.
    """
    name, equals, value = (part.strip() for part in text.partition("="))
    if not (name and equals and value):
        raise InputError(f"target {text} has no 'NAME=NUMBER'; write it like frequency=120")
    try:
        number = float(value)
    except ValueError:
        raise InputError(
            f"target {text}: {value} is no number; write it like frequency=120"
        ) from None
    if not math.isfinite(number):
        raise InputError(f"target {text}: {value} is not a finite number; give one")
    return name, number


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
