"""Numbers in physical units, in texts and answers of commands whose input has `[units]`."""

import math
from typing import Any, cast

from undula.models.scales import Quantity, Scales
from undula.schema.answer_keys import ANSWERS
from undula.schema.key_kinds import PHYSICAL
from undula.schema.physical_answer import physical_numbers
from undula.schema.physical_units import INPUT_QUANTITIES

#: Most significant digits of a physical number in a text, since scales are known to a few.
_DIGITS = 4


def with_physical(answer: dict[str, Any], command: str, scales: Scales | None) -> dict[str, Any]:
    """Return an answer with its numbers in physical units; without scales unchanged.

    Parameters
    ----------
    answer
        The answer in plain JSON types.
    command
        Name of the command.
    scales
        SI values of the dimensionless units, or None.
    """
    if scales is None:
        return answer
    return answer | {PHYSICAL: physical_numbers(answer, ANSWERS[command], scales.physical)}


def bracketed(
    scales: Scales | None, quantity: Quantity, *values: float | None, error: float | None = None
) -> str:
    """Return numbers in physical units, in brackets after a blank; empty without scales.

    Parameters
    ----------
    scales
        SI values of the dimensionless units, or None.
    quantity
        Quantity of the numbers.
    values
        Dimensionless number, or the ends of a range; without a number that is finite the text is
        empty.
    error
        Dimensionless error of a number, whose digits beyond it are left out.

    Examples
    --------
    >>> bracketed(Scales(), "frequency", 86.44, error=0.02)
    ' (158.4 Hz)'
    """
    numbers = [value for value in values if value is not None and math.isfinite(value)]
    if scales is None or len(numbers) < max(len(values), 1):
        return ""
    factor, unit = scales.physical(quantity, 1.0)
    spread = None if error is None else factor * error
    shown = (_digits(factor * value, spread) for value in numbers)
    return f" ({' to '.join(dict.fromkeys(shown))} {unit})"


def of_parameter(
    scales: Scales | None, parameter: str, *values: float, error: float | None = None
) -> str:
    """Return values of a parameter as `bracketed` does; empty for a parameter without a unit.

    Parameters
    ----------
    scales
        SI values of the dimensionless units, or None.
    parameter
        Key of the parameter, such as "load.force".
    values
        Dimensionless value, or the ends of a range.
    error
        Dimensionless error of a value.
    """
    if parameter not in INPUT_QUANTITIES:
        return ""
    return bracketed(scales, cast(Quantity, INPUT_QUANTITIES[parameter]), *values, error=error)


def scales_lines(scales: Scales | None) -> list[str]:
    """Return the line with the physical units below the heading of a text; no line without."""
    if scales is None:
        return []
    names: dict[str, Quantity] = {"L": "length", "T": "time", "B/L^2": "force", "B/L": "energy"}
    values = ((name, *scales.physical(quantity, 1.0)) for name, quantity in names.items())
    units = (f"{name} = {_digits(value)} {unit}" for name, value, unit in values)
    cycles = f"1 cycle per T = {_digits(scales.frequency)} Hz"
    return [f"  {', '.join([*units, cycles])}"]


def _digits(value: float, error: float | None = None) -> str:
    """Return a number to the digits that its error leaves, at most four."""
    digits = _DIGITS
    if error is not None and 0.0 < error < math.inf and value != 0.0:
        left = math.floor(math.log10(abs(value))) - math.floor(math.log10(error)) + 1
        digits = min(max(1, left), _DIGITS)
    rounded = float(f"{value:.{digits}g}")
    return f"{rounded:.{_DIGITS}g}"
