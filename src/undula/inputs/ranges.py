"""Values on the command line: a range such as ``0:60:121``, or a list such as ``20,30,40``."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from undula.errors import InputError

#: Largest number of points of a range; more count as a typing error.
_MOST_NUMBERS = 1_000_000


def parse_values(option: str, text: str) -> tuple[float, ...]:
    """Return the numbers of a range or a list.

    Parameters
    ----------
    option
        Name of the option, for messages.
    text
        ``START:STOP:COUNT``, both ends included, or numbers with commas between them.

    Returns
    -------
    tuple of float
        At least one number.

    Raises
    ------
    InputError
        The text is neither, or a number in it is not finite.
    """
    parts = text.split(":")
    if len(parts) == 1:
        if text.count(",") >= _MOST_NUMBERS:
            raise InputError(f"{option} lists more than {_MOST_NUMBERS} numbers; give fewer")
        return tuple(number_in(option, text, part) for part in text.split(","))
    if len(parts) != 3:
        raise _wrong(option, text)
    start, stop = (number_in(option, text, part) for part in parts[:2])
    count = parts[2].strip()
    # Python refuses to convert whole numbers of thousands of digits.
    short = len(count) <= len(str(_MOST_NUMBERS))
    if not (is_whole(count) and short and 1 <= int(count) <= _MOST_NUMBERS):
        raise InputError(
            f"{option} {text}: {count or 'nothing'} is no number of points; give a whole number"
            f" from 1 to {_MOST_NUMBERS}"
        )
    if not math.isfinite(stop - start):
        raise InputError(f"{option} {text} spans more than a number can hold; give a shorter range")
    return tuple(np.linspace(start, stop, int(count)).tolist())


class Way(NamedTuple):
    """The interval of a parameter, and the values in it that were asked for.

    Attributes
    ----------
    parameter
        Name of the parameter.
    start
        First value; None for the onset of instability of the straight state.
    end
        Last value.
    values
        All values, from `start` to `end`; None without a choice of them.
    """

    parameter: str
    start: float | None
    end: float
    values: tuple[float, ...] | None = None


def parse_way(option: str, text: str) -> Way:
    """Return the way of ``load.force=38:300``, ``load.force=38:300:27`` or of a list of values.

    The start is None for ``load.force=onset:300``, the onset of instability of the straight state.

    Parameters
    ----------
    option
        Name of the option, for messages.
    text
        ``KEY=START:END``, or a parameter and at least two values as for `parse_axis`.

    Raises
    ------
    InputError
        The parameter is missing, the ends are not two different numbers, or the values turn back.
    """
    name, equals, interval = (part.strip() for part in text.partition("="))
    ends = interval.split(":")
    if not (name and equals and (len(ends) in (2, 3) or "," in interval)):
        raise InputError(f"{option} {text} has no 'KEY=START:END'; write it like load.force=38:300")
    if len(ends) != 2:
        return _way_of_values(option, text, name, interval)
    end = number_in(option, text, ends[1])
    if ends[0].strip() == "onset":
        return Way(name, None, end)
    start = number_in(option, text, ends[0])
    if start == end:
        raise InputError(f"{option} {text} goes nowhere; give two different numbers")
    return Way(name, start, end)


def _way_of_values(option: str, text: str, name: str, interval: str) -> Way:
    first, _, rest = interval.partition(":")
    if first.strip() == "onset":
        raise InputError(
            f"{option} {text} counts values from an onset, which is not known yet; write"
            f" {name}=onset:{rest.partition(':')[0].strip()}, or give a number to start at"
        )
    values = parse_values(f"{option} {name}", interval)
    check_one_way(f"{option} {text}", values)
    if len(values) == 1:
        raise InputError(f"{option} {text} is one value; give at least two")
    return Way(name, values[0], values[-1], values)


def check_one_way(given: str, values: Sequence[float]) -> None:
    """Refuse values that neither rise nor fall all along.

    Parameters
    ----------
    given
        The option and its text, for the message.
    values
        The values in their order.

    Raises
    ------
    InputError
        Two neighbours are equal, or the values turn back.
    """
    differences = np.diff(values)
    for index in np.flatnonzero(differences * np.sign(values[-1] - values[0]) <= 0.0).tolist():
        before, after = values[index : index + 2]
        raise InputError(
            f"{given} goes from {before:g} to {after:g}; give values that rise, or values that fall"
        )


def parse_axis(option: str, text: str) -> tuple[str, tuple[float, ...]]:
    """Return the parameter and the values of ``load.slope=-1:1:41``.

    Parameters
    ----------
    option
        Name of the option, for messages.
    text
        ``KEY=RANGE`` or ``KEY=LIST``, with the values as for `parse_values`.

    Raises
    ------
    InputError
        The parameter is missing, or the rest is neither a range nor a list.
    """
    name, equals, values = (part.strip() for part in text.partition("="))
    if not (name and equals and values):
        raise InputError(f"{option} {text} has no 'KEY=RANGE'; write it like load.slope=-1:1:41")
    return name, parse_values(f"{option} {name}", values)


def is_whole(text: str) -> bool:
    """Return True for a whole number without a sign, a decimal point or an exponent."""
    return text.strip().isascii() and text.strip().isdigit()


def number_in(option: str, text: str, part: str, wrong: InputError | None = None) -> float:
    """Return the finite number that a part of an option's text is.

    Parameters
    ----------
    option, text
        Name and text of the option, for messages.
    part
        The part.
    wrong
        Error for a part that is no number; by default, that the text is no range.

    Raises
    ------
    InputError
        The part is no number, or not a finite one.
    """
    try:
        value = float(part)
    except ValueError:
        raise wrong or _wrong(option, text) from None
    if not math.isfinite(value):
        raise InputError(f"{option} {text}: {part.strip()} is not a finite number; give one")
    return value


def _wrong(option: str, text: str) -> InputError:
    return InputError(f"{option} {text} is no range; write START:STOP:COUNT, or numbers as 1,2,5")
