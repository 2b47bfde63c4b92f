"""Values from the command line: a range such as ``0:60:121``, or a list such as ``20,30,40``."""

import math

import numpy as np

from undula.arrays import Array
from undula.errors import InputError

# More points than this are a slip of the finger, not a curve.
_MOST = 1_000_000


def parse_values(option: str, text: str) -> Array:
    """Return the numbers that a range or a list stands for.

    Parameters
    ----------
    option
        The name under which the text was given, for complaints.
    text
        ``START:STOP:COUNT``, both ends included, or numbers with commas between them.

    Returns
    -------
    ndarray of shape (k,)

    Raises
    ------
    InputError
        It is neither, or a number in it is not finite.
    """
    parts = text.split(":")
    if len(parts) == 1:
        return np.array([_number(option, text, part) for part in text.split(",")])
    if len(parts) != 3:
        raise _wrong(option, text)
    start, stop = (_number(option, text, part) for part in parts[:2])
    count = parts[2].strip()
    if not (count.isascii() and count.isdigit() and 1 <= int(count) <= _MOST):
        raise InputError(
            f"{option} {text}: {count or 'nothing'} is no number of points; give a whole number"
            f" from 1 to {_MOST}"
        )
    return np.linspace(start, stop, int(count))


def parse_axis(option: str, text: str) -> tuple[str, Array]:
    """Return the parameter and the values of ``load.slope=-1:1:41``.

    Raises
    ------
    InputError
        There is no parameter, or what follows is neither a range nor a list.
    """
    name, equals, values = (part.strip() for part in text.partition("="))
    if not (name and equals and values):
        raise InputError(f"{option} {text} has no 'KEY=RANGE'; write it like load.slope=-1:1:41")
    return name, parse_values(f"{option} {name}", values)


def _number(option: str, text: str, part: str) -> float:
    try:
        value = float(part)
    except ValueError:
        raise _wrong(option, text) from None
    if not math.isfinite(value):
        raise InputError(f"{option} {text}: {part.strip()} is not a finite number; give one")
    return value


def _wrong(option: str, text: str) -> InputError:
    return InputError(f"{option} {text} is no range; write START:STOP:COUNT, or numbers as 1,2,5")
