"""Values on the command line: a range such as ``0:60:121``, or a list such as ``20,30,40``."""

import math
from decimal import Decimal

import numpy as np

from undula.analysis.ramps.ramp import MOST_STEPS
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
        return tuple(_number(option, text, part) for part in text.split(","))
    if len(parts) != 3:
        raise _wrong(option, text)
    start, stop = (_number(option, text, part) for part in parts[:2])
    count = parts[2].strip()
    # Python refuses to convert whole numbers of thousands of digits.
    digits = count.isascii() and count.isdigit() and len(count) <= len(str(_MOST_NUMBERS))
    if not (digits and 1 <= int(count) <= _MOST_NUMBERS):
        raise InputError(
            f"{option} {text}: {count or 'nothing'} is no number of points; give a whole number"
            f" from 1 to {_MOST_NUMBERS}"
        )
    if not math.isfinite(stop - start):
        raise InputError(f"{option} {text} spans more than a number can hold; give a shorter range")
    return tuple(np.linspace(start, stop, int(count)).tolist())


def parse_way(option: str, text: str) -> tuple[str, float | None, float]:
    """Return the parameter, the start and the end of ``load.force=38:300``.

    The start is None for ``load.force=onset:300``, the onset of instability of the straight state.

    Parameters
    ----------
    option
        Name of the option, for messages.
    text
        ``KEY=START:END``.

    Raises
    ------
    InputError
        The parameter is missing, or the ends are not two different numbers.
    """
    name, equals, interval = (part.strip() for part in text.partition("="))
    ends = interval.split(":")
    if not (name and equals and len(ends) == 2):
        raise InputError(f"{option} {text} has no 'KEY=START:END'; write it like load.force=38:300")
    end = _number(option, text, ends[1])
    if ends[0].strip() == "onset":
        return name, None, end
    start = _number(option, text, ends[0])
    if start == end:
        raise InputError(f"{option} {text} goes nowhere; give two different numbers")
    return name, start, end


def parse_steps(option: str, text: str) -> tuple[str, tuple[float, ...]]:
    """Return the parameter and the values of ``load.force=0:60:0.5``.

    Parameters
    ----------
    option
        Name of the option, for messages.
    text
        ``KEY=START:STOP:STEP``. The values run from START in steps of STEP up to STOP, which is
        included if a step ends there; for a lower STOP the sign of STEP may be left out.

    Returns
    -------
    str
        Name of the parameter.
    tuple of float
        At least two values, exact in decimals, without round-off.

    Raises
    ------
    InputError
        The parameter is missing, the rest is not three finite numbers, or STEP is 0, leads away
        from STOP, or makes less than one step or too many.
    """
    name, equals, interval = (part.strip() for part in text.partition("="))
    parts = interval.split(":")
    wrong = InputError(
        f"{option} {text} has no 'KEY=START:STOP:STEP'; write it like load.force=0:60:0.5"
    )
    if not (name and equals and len(parts) == 3):
        raise wrong
    numbers = (_number(option, text, part, wrong) for part in parts)
    # The shortest decimal representation of a number is the one that was written.
    start, stop, step = (Decimal(repr(number)) for number in numbers)
    count = _steps_between(f"{option} {text}", start, stop, step)
    step = abs(step) if stop > start else -abs(step)
    return name, tuple(float(start + number * step) for number in range(count + 1))


def _steps_between(given: str, start: Decimal, stop: Decimal, step: Decimal) -> int:
    if start == stop:
        raise InputError(f"{given} goes nowhere; give two different numbers to go between")
    if step == 0:
        raise InputError(f"{given} has a step of 0, which leads nowhere; give a step above 0")
    if step < 0 and stop > start:
        raise InputError(f"{given} has a step that leads away from {stop}; leave out its sign")
    ratio = abs((stop - start) / step)
    if ratio < 1:
        raise InputError(f"{given} has a step longer than the whole way; give a shorter one")
    if ratio >= MOST_STEPS + 1:
        raise InputError(
            f"{given} takes more than {MOST_STEPS} steps; give a longer step or a shorter way"
        )
    return int(ratio)


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


def _number(option: str, text: str, part: str, wrong: InputError | None = None) -> float:
    try:
        value = float(part)
    except ValueError:
        raise wrong or _wrong(option, text) from None
    if not math.isfinite(value):
        raise InputError(f"{option} {text}: {part.strip()} is not a finite number; give one")
    return value


def _wrong(option: str, text: str) -> InputError:
    return InputError(f"{option} {text} is no range; write START:STOP:COUNT, or numbers as 1,2,5")
