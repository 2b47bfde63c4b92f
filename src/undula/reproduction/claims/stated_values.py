"""Parameter values of claims, compared with those of the commands that compute them.

A claim on F = 180 does not extend to F = 150: it is judged at its own values, or not at all.
"""

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

from undula.inputs.input import ModelInput, SweepInput, read_tables
from undula.inputs.ramp_values import parse_ramp
from undula.inputs.ranges import parse_axis, parse_values, parse_way
from undula.inputs.sweep_table import AxisTable
from undula.models.units import chain_units

FORCE = "load.force"
#: Commands that compute from an input.
_COMPUTING = ("find", "follow", "run", "stability", "step", "sweep", "threshold")
#: Number of words between such a command and its options.
_WORDS = {"find": 1, "follow": 1, "threshold": 1, "sweep": 1}


@dataclass(frozen=True)
class Values:
    """Parameter values of a command.

    Attributes
    ----------
    fixed
        Values of keys of model and load. For a chain they include the force in units of single
        links, as ``load.force [K/l]``.
    swept
        Least and greatest value of the keys that the command varies.
    """

    fixed: Mapping[str, Any] = field(default_factory=dict)
    swept: Mapping[str, tuple[float, float]] = field(default_factory=dict)


def values_of(command: Sequence[str]) -> Values:
    """Return the parameter values of a command.

    Parameters
    ----------
    command
        Words of the command, without `undula`.

    Raises
    ------
    InputError
        The input of the command is wrong.
    """
    return _values(tuple(command))


def values_of_call(call: str, inputs: Path) -> Values:
    """Return the parameter values of a command in the catalogue, with its folder of inputs.

    Parameters
    ----------
    call
        The command in the catalogue.
    inputs
        Folder of the input files.
    """
    return values_of(shlex.split(call.replace("{inputs}", str(inputs))))


def other_values(stated: Mapping[str, Any], computed: Mapping[str, Values]) -> str:
    """Return the first difference between the values of a claim and of its commands in words.

    Parameters
    ----------
    stated
        Value, or list of values, of the claim by key of the input.
    computed
        Values of the commands of the claim by name. A command without a key does not depend on it.

    Returns
    -------
    str
        Empty without a difference.
    """
    for key, value_or_list in stated.items():
        wanted = value_or_list if isinstance(value_or_list, list) else [value_or_list]
        covered: list[Any] = []
        for name, values in computed.items():
            if key in values.swept:
                low, high = values.swept[key]
                covered += [value for value in wanted if low <= value <= high]
            elif key in values.fixed:
                covered.append(values.fixed[key])
                if values.fixed[key] not in wanted:
                    return (
                        f"{name} is computed at {key} = {_listed([values.fixed[key]])}, and the"
                        f" statement is about {_listed(wanted)}"
                    )
        missing = [value for value in wanted if value not in covered]
        if missing:
            return (
                f"nothing is computed at {key} = {_listed(missing)}, which the statement is about"
            )
    return ""


@cache
def _values(command: tuple[str, ...]) -> Values:
    verb = command[0]
    if verb not in _COMPUTING:
        return Values()
    options = command[1 + _WORDS.get(verb, 0) :]
    changes = [value for option, value in pairwise(options) if option == "--set"]
    path, record = (Path(command[1]), SweepInput) if verb == "sweep" else (None, ModelInput)
    # Claims state no starts and times, and some commands have their own.
    changes = [change for change in changes if change.startswith(("model.", "load."))]
    wanted = read_tables(record, path, changes)[1]
    fixed = {
        f"{name}.{key}": getattr(table, key)
        for name, table in (("model", wanted.model), ("load", wanted.load))
        for key in table.dump()
    }
    swept = _swept(verb, options)
    if isinstance(wanted, SweepInput):
        swept |= {axis.key: _ends(axis) for axis in wanted.study.axes}
    if wanted.model.kind == "chain":
        for unit, factor in chain_units(wanted.model.links).forces.items():
            fixed[f"{FORCE} [{unit}]"] = wanted.load.force * factor
    if verb == "threshold":
        # The command solves for the force.
        swept.setdefault(FORCE, (0.0, float("inf")))
    varied = {key for key in fixed if key.partition(" ")[0] in swept}
    return Values({key: value for key, value in fixed.items() if key not in varied}, swept)


def _swept(verb: str, options: Sequence[str]) -> dict[str, tuple[float, float]]:
    swept = {}
    for option, text in pairwise(options):
        if option == "--forces":
            values = parse_values(option, text)
            swept[FORCE] = min(values), max(values)
        elif option == "--along" and verb == "follow":
            name, start, end, _ = parse_way(option, text)
            # A branch that begins at the onset begins above 0.
            swept[name] = min(start or 0.0, end), max(start or 0.0, end)
        elif option == "--along":
            name, values = (parse_ramp if verb == "step" else parse_axis)(option, text)[:2]
            swept[name] = min(values), max(values)
    return swept


def _ends(axis: AxisTable) -> tuple[float, float]:
    values = axis.values or (axis.start, axis.to)
    numbers = [float(value) for value in values if value is not None]
    return min(numbers), max(numbers)


def _listed(values: Sequence[Any]) -> str:
    return ", ".join(
        f"{value:.6g}" if isinstance(value, float | int) else str(value) for value in values
    )
