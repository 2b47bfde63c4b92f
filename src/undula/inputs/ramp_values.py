"""Values of a ramp on the command line, by their number or by the size of a step.

A whole third number as in ``0:60:121`` is a number of values, as in every other range. A number
with a decimal point or an exponent as in ``0:60:0.5`` is the size of a step.
"""

from collections.abc import Sequence
from decimal import Decimal
from typing import NamedTuple

from undula.analysis.ramps.ramp import MOST_STEPS
from undula.errors import InputError
from undula.inputs.ranges import check_one_way, is_whole, number_in, parse_values


class RampValues(NamedTuple):
    """The values of a ramp.

    Attributes
    ----------
    parameter
        Name of the parameter.
    values
        Its values in their order, which rise or fall.
    remark
        A sentence on a text that earlier versions read in another way; None without one.
    """

    parameter: str
    values: tuple[float, ...]
    remark: str | None = None


def parse_ramp(option: str, text: str) -> RampValues:
    """Return the values of ``load.force=0:60:121``, ``load.force=0:60:0.5`` or of a list.

    Parameters
    ----------
    option
        Name of the option, for messages.
    text
        ``KEY=START:STOP:COUNT`` or ``KEY=LIST``, as for `undula.inputs.ranges.parse_axis`; or
        ``KEY=START:STOP:STEP``. In steps, the values run from START up to STOP, which is included
        if a step ends there, exact in decimals and without round-off; for a lower STOP the sign of
        STEP may be left out.

    Returns
    -------
    RampValues

    Raises
    ------
    InputError
        The parameter is missing, the rest is neither, the values turn back, or STEP is 0, leads
        away from STOP, or makes less than one step or too many.
    """
    name, equals, interval = (part.strip() for part in text.partition("="))
    if not (name and equals and interval):
        raise InputError(
            f"{option} {text} has no 'KEY=START:STOP:COUNT'; write it like load.force=0:60:121, or"
            " load.force=0:60:0.5 for steps of 0.5"
        )
    parts = interval.split(":")
    in_steps = f"{name}={interval}.0"
    if len(parts) == 3 and not is_whole(parts[2]):
        return RampValues(name, _stepped(option, text, parts))
    # A ramp of one value needs no range: an earlier version wrote steps of 1 so.
    if len(parts) == 3 and parts[2].strip() == "1":
        remark = f"{option} {text} takes steps of 1; a later version may not, write {in_steps}"
        return RampValues(name, _stepped(option, text, parts), remark)
    values = parse_values(f"{option} {name}", interval)
    check_one_way(f"{option} {text}", values)
    if len(parts) != 3 or _stepped_or_none(option, text, parts) in (None, values):
        return RampValues(name, values)
    remark = f"{option} {text} takes {len(values)} values; for steps of that size write {in_steps}"
    return RampValues(name, values, remark)


def _stepped_or_none(option: str, text: str, parts: Sequence[str]) -> tuple[float, ...] | None:
    """Return the values in steps of a size; None where the size makes no ramp."""
    try:
        return _stepped(option, text, parts)
    except InputError:
        return None


def _stepped(option: str, text: str, parts: Sequence[str]) -> tuple[float, ...]:
    wrong = InputError(
        f"{option} {text} has no 'KEY=START:STOP:COUNT'; write it like load.force=0:60:121, or"
        " load.force=0:60:0.5 for steps of 0.5"
    )
    numbers = [number_in(option, text, part, wrong) for part in parts]
    # The shortest decimal representation of a number is the one that was written.
    start, stop, step = (Decimal(repr(number)) for number in numbers)
    count = _steps_between(f"{option} {text}", start, stop, step)
    step = abs(step) if stop > start else -abs(step)
    return tuple(float(start + number * step) for number in range(count + 1))


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
