"""The values that a statement is about, held against those of the commands that compute it.

A statement on F = 180 says nothing about F = 150: it is judged at its own values, or not at all.
"""

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

from undula.inputs.input import ModelInput, StudyInput, read_tables
from undula.inputs.ranges import parse_axis, parse_steps, parse_values, parse_way
from undula.inputs.sweep_table import AxisTable
from undula.models.units import chain_units

FORCE = "load.force"
#: The commands that compute anything from an input.
_COMPUTING = ("find", "follow", "run", "stability", "step", "sweep", "threshold")
#: Number of the words that stand between such a command and its options.
_WORDS = {"find": 1, "follow": 1, "threshold": 1, "sweep": 1}


@dataclass(frozen=True)
class Values:
    """What a command is about.

    Attributes
    ----------
    fixed
        Values of keys of the model and the load. The force of a chain is there as well in units of
        single links, as ``load.force [K/l]``.
    swept
        Least and greatest value of keys that the command goes over.
    """

    fixed: Mapping[str, Any] = field(default_factory=dict)
    swept: Mapping[str, tuple[float, float]] = field(default_factory=dict)


def values_of(command: Sequence[str]) -> Values:
    """Return what a command of `undula` is about.

    Parameters
    ----------
    command
        Its words, without `undula`.

    Raises
    ------
    InputError
        Its input is wrong.
    """
    return _values(tuple(command))


def values_of_call(call: str, inputs: Path) -> Values:
    """Return what a command of a catalogue is about, whose input files are in a folder."""
    return values_of(shlex.split(call.replace("{inputs}", str(inputs))))


def other_values(stated: Mapping[str, Any], computed: Mapping[str, Values]) -> str:
    """Return why commands do not compute a statement at its own values; empty if they do.

    Parameters
    ----------
    stated
        Keys of the input, each with the value that the statement is about, or with several.
    computed
        What the commands behind the statement are about, by their names. One that does not know a
        key has nothing to do with it.
    """
    for key, given in stated.items():
        wanted = given if isinstance(given, list) else [given]
        found: list[Any] = []
        for name, values in computed.items():
            if key in values.swept:
                low, high = values.swept[key]
                found += [value for value in wanted if low <= value <= high]
            elif key in values.fixed:
                found.append(values.fixed[key])
                if values.fixed[key] not in wanted:
                    return (
                        f"{name} is computed at {key} = {_told([values.fixed[key]])}, and the"
                        f" statement is about {_told(wanted)}"
                    )
        missing = [value for value in wanted if value not in found]
        if missing:
            return f"nothing is computed at {key} = {_told(missing)}, which the statement is about"
    return ""


@cache
def _values(command: tuple[str, ...]) -> Values:
    verb = command[0]
    if verb not in _COMPUTING:
        return Values()
    options = command[1 + _WORDS.get(verb, 0) :]
    given = [value for option, value in pairwise(options) if option == "--set"]
    path, record = (Path(command[1]), StudyInput) if verb == "sweep" else (None, ModelInput)
    # Of starts and times nothing is stated, and some commands have their own.
    told = [change for change in given if change.startswith(("model.", "load."))]
    wanted = read_tables(record, path, told)[1]
    fixed = {
        f"{name}.{key}": getattr(table, key)
        for name, table in (("model", wanted.model), ("load", wanted.load))
        for key in table.dump()
    }
    swept = _swept(verb, options)
    if isinstance(wanted, StudyInput):
        swept |= {axis.key: _ends(axis) for axis in wanted.study.axes}
    if wanted.model.kind == "chain":
        for unit, factor in chain_units(wanted.model.links).forces.items():
            fixed[f"{FORCE} [{unit}]"] = wanted.load.force * factor
    if verb == "threshold":
        # The force is what is looked for.
        swept.setdefault(FORCE, (0.0, float("inf")))
    gone = {key for key in fixed if key.partition(" ")[0] in swept}
    return Values({key: value for key, value in fixed.items() if key not in gone}, swept)


def _swept(verb: str, options: Sequence[str]) -> dict[str, tuple[float, float]]:
    swept = {}
    for option, text in pairwise(options):
        if option == "--forces":
            values = parse_values(option, text)
            swept[FORCE] = min(values), max(values)
        elif option == "--along" and verb == "follow":
            name, start, end = parse_way(option, text)
            # A branch that begins at the onset begins above 0.
            swept[name] = min(start or 0.0, end), max(start or 0.0, end)
        elif option == "--along":
            name, values = (parse_steps if verb == "step" else parse_axis)(option, text)
            swept[name] = min(values), max(values)
    return swept


def _ends(axis: AxisTable) -> tuple[float, float]:
    values = axis.values or (axis.start, axis.to)
    known = [float(value) for value in values if value is not None]
    return min(known), max(known)


def _told(values: Sequence[Any]) -> str:
    return ", ".join(f"{one:.6g}" if isinstance(one, float | int) else str(one) for one in values)
