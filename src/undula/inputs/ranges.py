"""Values from the command line: a range such as ``0:60:121``, or a list such as ``20,30,40``."""

import math
from decimal import Decimal

import numpy as np

from undula.analysis.ramps.ramp import MOST_STEPS
from undula.errors import InputError

# More points than this are a slip of the finger, not a curve.
_MOST = 1_000_000


def parse_values(option: str, text: str) -> tuple[float, ...]:
    """Return the numbers that a range or a list stands for.

    Parameters
    ----------
    option
        The name under which the text was given, for complaints.
    text
        ``START:STOP:COUNT``, both ends included, or numbers with commas between them.

    Returns
    -------
    tuple of float
        One at least.

    Raises
    ------
    InputError
        It is neither, or a number in it is not finite.
    """
    parts = text.split(":")
    if len(parts) == 1:
        if text.count(",") >= _MOST:
            raise InputError(f"{option} lists more than {_MOST} numbers; give fewer")
        return tuple(_number(option, text, part) for part in text.split(","))
    if len(parts) != 3:
        raise _wrong(option, text)
    start, stop = (_number(option, text, part) for part in parts[:2])
    count = parts[2].strip()
    # Python reads no whole number of thousands of digits.
    digits = count.isascii() and count.isdigit() and len(count) <= len(str(_MOST))
    if not (digits and 1 <= int(count) <= _MOST):
        raise InputError(
            f"{option} {text}: {count or 'nothing'} is no number of points; give a whole number"
            f" from 1 to {_MOST}"
        )
    if not math.isfinite(stop - start):
        raise InputError(f"{option} {text} spans more than a number can hold; give a shorter range")
    return tuple(np.linspace(start, stop, int(count)).tolist())


def parse_way(option: str, text: str) -> tuple[str, float | None, float]:
    """Return the parameter, the start and the end of ``load.force=38:300``.

    The start is None for ``load.force=onset:300``: where the straight state loses stability.

    Raises
    ------
    InputError
        There is no parameter, or what follows is not two different numbers.
    """
    name, equals, way = (part.strip() for part in text.partition("="))
    ends = way.split(":")
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
        The name under which the text was given, for complaints.
    text
        ``KEY=START:STOP:STEP``. The values go from START by STEP as far as STOP, which is one of
        them if it is hit; down to a lower STOP the sign of STEP may be left out.

    Returns
    -------
    tuple of str and tuple of float
        The name, and two values at least; the decimals that one would write, without round-off.

    Raises
    ------
    InputError
        There is no parameter, what follows is not three finite numbers, or STEP is 0, leads away
        from STOP, or makes less than one step or far too many.
    """
    name, equals, way = (part.strip() for part in text.partition("="))
    parts = way.split(":")
    wrong = InputError(
        f"{option} {text} has no 'KEY=START:STOP:STEP'; write it like load.force=0:60:0.5"
    )
    if not (name and equals and len(parts) == 3):
        raise wrong
    numbers = (_number(option, text, part, wrong) for part in parts)
    # The shortest decimals of a number are those that were written.
    start, stop, step = (Decimal(repr(number)) for number in numbers)
    count = _steps_between(f"{option} {text}", start, stop, step)
    step = abs(step) if stop > start else -abs(step)
    return name, tuple(float(start + number * step) for number in range(count + 1))


def _steps_between(told: str, start: Decimal, stop: Decimal, step: Decimal) -> int:
    if start == stop:
        raise InputError(f"{told} goes nowhere; give two different numbers to go between")
    if step == 0:
        raise InputError(f"{told} has a step of 0, which leads nowhere; give a step above 0")
    if step < 0 and stop > start:
        raise InputError(f"{told} has a step that leads away from {stop}; leave out its sign")
    ratio = abs((stop - start) / step)
    if ratio < 1:
        raise InputError(f"{told} has a step longer than the whole way; give a shorter one")
    if ratio >= MOST_STEPS + 1:
        raise InputError(
            f"{told} takes more than {MOST_STEPS} steps; give a longer step or a shorter way"
        )
    return int(ratio)


def parse_axis(option: str, text: str) -> tuple[str, tuple[float, ...]]:
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
