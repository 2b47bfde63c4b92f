"""Tables of comma-separated values, made of the rows of an answer."""

import csv
import io
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from undula.schema.key_kinds import ENERGY, FORCE, FREQUENCY, LENGTH, PARAMETER, RATE, TIME, Named

#: Units of quantities that are the same for all models.
_FIXED = {RATE: "1/T", TIME: "T"}
#: The parameter that is a force.
_FORCE_KEY = "load.force"


def csv_text(rows: Sequence[Mapping[str, Any]], keys: Any, units: Mapping[str, str]) -> str:
    """Return the rows of an answer as a table with one line of names and units.

    Parameters
    ----------
    rows
        Objects in plain JSON types. A column holds a number or word, or a part of an inner object:
        `bending_energy_min` is `min` of `bending_energy`.
    keys
        Keys that the objects may hold, with their quantities.
    units
        Names of the model's units by quantity.

    Returns
    -------
    str
        Lines without the last line break. The heading of a number with a unit is its name and the
        unit in brackets. Null and NaN are empty, truth values are true and false, and the numbers
        of a list are separated by spaces.
    """
    flat = [dict(_cells(row, keys, units)) for row in rows]
    heading = list(dict.fromkeys(name for row in flat for name in row))
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(heading)
    writer.writerows([_shown(row.get(name)) for name in heading] for row in flat)
    return text.getvalue().removesuffix("\n")


def _cells(
    row: Mapping[str, Any], keys: Any, units: Mapping[str, str], prefix: str = ""
) -> Iterator[tuple[str, Any]]:
    """Yield heading and value of every cell of a row."""
    for name, value in row.items():
        known = keys.get(name, keys.get(PARAMETER)) if isinstance(keys, Mapping) else keys
        if isinstance(known, Named):
            # The inner names of a force in further units are these units.
            parts = (value or {}).items()
            yield from ((f"{prefix}{name} [{unit}]", part) for unit, part in parts)
        elif isinstance(value, Mapping):
            yield from _cells(value, known, units, f"{prefix}{name}_")
        else:
            unit = _unit(FORCE if name == _FORCE_KEY else known, units)
            yield f"{prefix}{name}{f' [{unit}]' if unit else ''}", value


def _unit(quantity: Any, units: Mapping[str, str]) -> str:
    if isinstance(quantity, Mapping):
        # Of a steady state, a single number stands in place of least, largest and mean value.
        parts = set(quantity.values())
        quantity = parts.pop() if len(parts) == 1 else None
    if quantity in (LENGTH, FORCE, ENERGY, FREQUENCY):
        return units[quantity]
    return _FIXED.get(quantity, "") if isinstance(quantity, str) else ""


def _shown(value: Any) -> Any:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float) and not math.isfinite(value):
        return ""
    if isinstance(value, list | tuple):
        return " ".join(map(str, value))
    return value
