"""Definition of a sweep: its axes, and the complete input of each of its points.

Points are numbered along the axes in their order, and last along the replicates. The number of a
point determines the seed of its random start, so that the results do not depend on when, where or
in which order points are computed.
"""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from undula.analysis.parameters import FORCE
from undula.analysis.runs.memory_needed import refuse_too_large
from undula.errors import InputError
from undula.inputs.build import build_model, build_schedule, build_start
from undula.inputs.input import RunInput, SweepInput, changed_tables, parse_input, read_tables
from undula.inputs.sweep_table import MOST_POINTS, SweepTable
from undula.sweeps.axis_keys import Axis, Tables, axis_of, set_value, unvaried


@dataclass(frozen=True)
class Sweep:
    """A checked sweep.

    Attributes
    ----------
    settings
        The table ``[study]`` of the input, without the axes.
    axes
        The axes; the last one varies fastest.
    shared
        The part of the resolved input that all points have in common.
    """

    settings: Mapping[str, Any]
    axes: tuple[Axis, ...]
    shared: Tables

    @cached_property
    def shape(self) -> tuple[int, ...]:
        """Number of values of each axis, and of replicates."""
        return (*(len(axis.values) for axis in self.axes), self.settings.get("tries", 1))

    @property
    def count(self) -> int:
        """Number of points; each replicate counts as one."""
        return math.prod(self.shape)

    @property
    def label(self) -> str:
        """The result of a point: "runs" for the end of a run, "solved" for solved states."""
        return str(self.settings["label"])

    @property
    def policy(self) -> str:
        """The start of runs: "same", "random" or "neighbour"; unused by sweeps of solved states."""
        return str(self.settings.get("policy", "same"))

    @property
    def keep(self) -> str:
        """The stored part of a run: "verdict", "period" or "run"."""
        return str(self.settings.get("keep", "verdict"))

    @property
    def undecided(self) -> str:
        """Treatment of undecided runs: "keep" leaves them so, "solve" uses solved states."""
        return str(self.settings.get("undecided", "keep"))

    @property
    def whole_rows(self) -> bool:
        """True if the points along the last axis are computed together, in their order."""
        last = self.axes[-1]
        if self.label == "solved":
            # One branch, followed once along the force, holds the states of a whole row.
            return last.key == FORCE and min(last.values) >= 0.0
        return self.policy == "neighbour"

    def place(self, number: int) -> tuple[int, ...]:
        """Return the indices of a point along the axes, and of its replicate."""
        return tuple(map(int, np.unravel_index(number, self.shape)))

    def tables(self, number: int) -> dict[str, dict[str, Any]]:
        """Return the input of a point as plain tables, in the form that ``undula run`` reads."""
        tables = {name: dict(table) for name, table in self.shared.items()}
        for axis, index in zip(self.axes, self.place(number), strict=False):
            set_value(tables, axis.key, axis.values[index])
        if self.policy == "random":
            seed, amplitude = self._drawn(number)
            tables["start"] = {"shape": "kicked", "amplitude": amplitude, "seed": seed}
        return tables

    def request(self, number: int) -> dict[str, Any]:
        """Return the argument of `undula.sweeps.point.point_record` for a point."""
        request: dict[str, Any] = {
            "tables": self.tables(number),
            "label": self.label,
            "keep": self.keep,
            "undecided": self.undecided,
        }
        if self.policy == "neighbour":
            request["kick"] = (self.settings["kick"], self._drawn(number)[0])
        return request

    def seed(self, number: int) -> int:
        """Return the seed of a point's random start or kick, -1 if nothing in it is random."""
        if self.label == "solved":
            return -1
        if self.policy == "neighbour":
            return self._drawn(number)[0] if self.settings["kick"] > 0.0 else -1
        return int(self.tables(number)["start"].get("seed", -1))

    def dump(self) -> dict[str, Any]:
        """Return the complete sweep in plain JSON types; `sweep_from_dump` is the inverse."""
        axes = [{"key": axis.key, "values": list(axis.values)} for axis in self.axes]
        return {"study": {**self.settings, "axes": axes}, **self.shared}

    def _drawn(self, number: int) -> tuple[int, float]:
        """Return seed and amplitude [rad] of a point's random start."""
        own = np.random.SeedSequence((self.settings["seed"], number))
        first, second = (int(word) for word in own.generate_state(2, np.uint64))
        least, largest = self.settings.get("amplitudes", (1.0, 1.0))
        # Uniform in the logarithm of the amplitude.
        amplitude = least * (largest / least) ** (second / 2**64)
        return first >> 1, min(max(amplitude, least), largest)  # of 63 bits, to fit an int64


def read_sweep(path: Path, overrides: Sequence[str] = ()) -> Sweep:
    """Read a sweep and check the input of every point.

    Parameters
    ----------
    path
        A TOML file in UTF-8 with a table ``[study]``.
    overrides
        Changes such as ``"load.slope=0.5"`` or ``"study.seed=2"``, applied in order.

    Raises
    ------
    InputError
        The file cannot be read, a key or value is wrong, an axis varies a key that is not a
        number, or the input of a point is invalid. The sentence names the culprit.
    """
    return _checked_sweep(*read_tables(SweepInput, path, overrides), str(path))


def sweep_from_tables(tables: Mapping[str, Any]) -> Sweep:
    """Return the sweep of tables as a file would hold them, checked as `read_sweep` does.

    Raises
    ------
    InputError
        As of `read_sweep`.
    """
    if not isinstance(tables, Mapping):
        raise InputError(
            f"{type(tables).__name__} is no input of a sweep; give its tables by name, or a file"
        )
    return _checked_sweep(*changed_tables(SweepInput, tables, ()), "the input")


def _checked_sweep(tables: Tables, checked: SweepInput, name: str) -> Sweep:
    if not checked.study.axes:
        raise InputError(
            f"{name} varies nothing; add a table [study] and [[study.axes]] with key and values"
        )
    # Without [units] a sweep has no such table, which would have defaults.
    read = [name for name in RunInput.model_fields if name != "units" or name in tables]
    return _resolved_sweep(checked.study, {name: tables.get(name, {}) for name in read})


def sweep_from_dump(dumped: Mapping[str, Any]) -> Sweep:
    """Return the sweep that `Sweep.dump` was called on."""
    settings = dict(dumped["study"])
    axes = tuple(Axis(axis["key"], tuple(axis["values"])) for axis in settings.pop("axes"))
    return Sweep(settings, axes, {name: dumped[name] for name in dumped if name != "study"})


def _resolved_sweep(table: SweepTable, given: Tables) -> Sweep:
    """Return the checked sweep of a table ``[study]`` and of the other tables of its file."""
    axes = tuple(axis_of(axis.key, axis.resolved) for axis in table.axes)
    settings = {key: value for key, value in table.dump().items() if key != "axes"}
    settings = json.loads(json.dumps(settings))  # tuples become lists, as in a stored sweep
    draft = Sweep(settings, axes, given)
    if draft.count > MOST_POINTS:
        raise InputError(
            f"the study has {draft.count} points, more than {MOST_POINTS}; give shorter axes"
        )
    _refuse_idle_starts(draft, given)
    _refuse_ragged_shapes(draft)
    return Sweep(settings, axes, _shared(draft))


def _refuse_ragged_shapes(sweep: Sweep) -> None:
    """Refuse to store shapes of different numbers of nodes, which do not fit in one array."""
    ragged = [axis.key for axis in sweep.axes if axis.key in ("model.segments", "model.links")]
    if sweep.keep == "period" and ragged:
        raise InputError(
            f"{ragged[0]} varies, and shapes of different lengths do not fit in one array; use"
            " study.keep = 'run' or 'verdict', or leave out this axis"
        )


def _refuse_idle_starts(sweep: Sweep, given: Tables) -> None:
    """Refuse settings of the start that no point would use."""
    if sweep.policy == "random":
        idle = [axis.key for axis in sweep.axes if axis.key.startswith("start.")]
        idle += [f"start.{key}" for key in given["start"]]
        if idle:
            raise InputError(
                f"{idle[0]} has no meaning for study.policy = 'random', whose starts follow from"
                f" study.amplitudes and study.seed; remove {idle[0]}"
            )
    last = sweep.axes[-1].key
    if sweep.policy == "neighbour" and last.startswith("start."):
        raise InputError(
            f"{last} has no meaning along the last axis for study.policy = 'neighbour', whose runs"
            " begin with what the one before has come to; put another axis last"
        )


def _shared(draft: Sweep) -> Tables:
    """Check the input of all points; return the part of the resolved input that they share."""
    common: dict[str, dict[str, Any]] | None = None
    replicates = draft.shape[-1]
    for number in range(0, draft.count, replicates):
        dumped = unvaried(_checked(draft, number).dump(), draft.axes)
        if common is None:
            common = dumped
        for name, table in common.items():
            for key in [key for key in table if table[key] != dumped[name].get(key)]:
                del table[key]  # a default that depends on an axis
    assert common is not None  # a sweep has at least one point
    if draft.policy == "random":
        common["start"] = {}
    return common


def _checked(draft: Sweep, number: int) -> RunInput:
    """Return the input of a point; refuse one with which no run can begin."""
    try:
        wanted = parse_input(draft.tables(number))
        model = build_model(wanted)
        model.straight()  # raises an error for extensible links that have no straight state
        refuse_too_large(model, build_schedule(wanted))
        if number == 0:
            build_start(wanted, model)  # the start may be read from a file
        if model.unwrapped and draft.policy == "neighbour":
            raise InputError(
                "joints that wind up lose their full turns between neighbours; use model.spring ="
                " 'angle' or another study.policy"
            )
    except InputError as error:
        place = zip(draft.axes, draft.place(number), strict=False)
        values = ", ".join(f"{axis.key} = {axis.values[index]}" for axis, index in place)
        raise InputError(f"the study cannot run at {values}: {error}") from None
    return wanted
