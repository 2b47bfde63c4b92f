"""A study: what is varied, and the complete input of each of its points.

Points are numbered through: by the axes in their order, and last by the try. The number of a point
makes the seed of its random start, so that it does not matter when, where or in which order points
are run.
"""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, get_args

import numpy as np

from undula.analysis.parameters import FORCE
from undula.analysis.runs.memory_needed import refuse_too_large
from undula.errors import InputError
from undula.inputs.build import build_model, build_schedule, build_start
from undula.inputs.input import RunInput, StudyInput, parse_input, read_tables
from undula.inputs.messages import nearest
from undula.inputs.sweep_table import MOST_POINTS, StudyTable

Tables = Mapping[str, Mapping[str, Any]]


@dataclass(frozen=True)
class Axis:
    """A key of the input, such as ``load.force``, and the values that it takes."""

    key: str
    values: tuple[int | float, ...]


@dataclass(frozen=True)
class Study:
    """A checked study.

    Attributes
    ----------
    settings
        Its table ``[study]``, without the axes.
    axes
        What is varied, the last one fastest.
    shared
        The resolved input as far as it is the same at all points.
    """

    settings: Mapping[str, Any]
    axes: tuple[Axis, ...]
    shared: Tables

    @cached_property
    def shape(self) -> tuple[int, ...]:
        """Number of values of each axis, and of tries."""
        return (*(len(axis.values) for axis in self.axes), self.settings.get("tries", 1))

    @property
    def count(self) -> int:
        """Number of points, each try one."""
        return math.prod(self.shape)

    @property
    def label(self) -> str:
        """What is found at a point."""
        return str(self.settings["label"])

    @property
    def policy(self) -> str:
        """How runs begin; a study of solved states has none."""
        return str(self.settings.get("policy", "same"))

    @property
    def keep(self) -> str:
        """What is kept of a run."""
        return str(self.settings.get("keep", "verdict"))

    @property
    def undecided(self) -> str:
        """What becomes of points whose runs do not tell."""
        return str(self.settings.get("undecided", "keep"))

    @property
    def whole_lines(self) -> bool:
        """Whether the points along the last axis are done together, in their order."""
        last = self.axes[-1]
        if self.label == "solved":
            # The states along a branch are had by following it once.
            return last.key == FORCE and min(last.values) >= 0.0
        return self.policy == "neighbour"

    def place(self, number: int) -> tuple[int, ...]:
        """Return the indices of a point along the axes, and of its try."""
        return tuple(map(int, np.unravel_index(number, self.shape)))

    def tables(self, number: int) -> dict[str, dict[str, Any]]:
        """Return the input of a point as plain tables, as `undula run` reads them."""
        tables = {name: dict(table) for name, table in self.shared.items()}
        for axis, at in zip(self.axes, self.place(number), strict=False):
            table, key = axis.key.split(".")
            tables[table][key] = axis.values[at]
        if self.policy == "random":
            seed, amplitude = self._drawn(number)
            tables["start"] = {"shape": "kicked", "amplitude": amplitude, "seed": seed}
        return tables

    def job(self, number: int) -> dict[str, Any]:
        """Return what `undula.sweeps.point.point` wants of a point, in plain types."""
        job: dict[str, Any] = {
            "tables": self.tables(number),
            "label": self.label,
            "keep": self.keep,
            "undecided": self.undecided,
        }
        if self.policy == "neighbour":
            job["kick"] = (self.settings["kick"], self._drawn(number)[0])
        return job

    def seed(self, number: int) -> int:
        """Return the seed of what is random in the start of a point, -1 if nothing is."""
        if self.label == "solved":
            return -1
        if self.policy == "neighbour":
            return self._drawn(number)[0] if self.settings["kick"] > 0.0 else -1
        return int(self.tables(number)["start"].get("seed", -1))

    def dump(self) -> dict[str, Any]:
        """Return the complete study as plain JSON types; `of_dump` makes it again."""
        axes = [{"key": axis.key, "values": list(axis.values)} for axis in self.axes]
        return {"study": {**self.settings, "axes": axes}, **self.shared}

    def _drawn(self, number: int) -> tuple[int, float]:
        """Return seed and amplitude of a point's own random start."""
        own = np.random.SeedSequence((self.settings["seed"], number))
        first, second = (int(word) for word in own.generate_state(2, np.uint64))
        least, largest = self.settings.get("amplitudes", (1.0, 1.0))
        # The part of the way from one to the other, on a scale of logarithms.
        amplitude = least * (largest / least) ** (second / 2**64)
        return first >> 1, min(max(amplitude, least), largest)  # of 63 bits, to fit an int64


def read_study(path: Path, overrides: Sequence[str] = ()) -> Study:
    """Read a study and check the input of every one of its points.

    Parameters
    ----------
    path
        A TOML file in UTF-8 with a table ``[study]``.
    overrides
        Changes such as ``"load.slope=0.5"`` or ``"study.seed=2"``, applied in order.

    Raises
    ------
    InputError
        The file cannot be read, a key or value is wrong, an axis varies what is no number of the
        input, or a point has an input that no run could have. The sentence names the culprit.
    """
    tables, checked = read_tables(StudyInput, path, overrides)
    if not checked.study.axes:
        raise InputError(
            f"{path} varies nothing; add a table [study] and [[study.axes]] with key and values"
        )
    return _study(checked.study, {name: tables.get(name, {}) for name in RunInput.model_fields})


def of_dump(dumped: Mapping[str, Any]) -> Study:
    """Return the study that `Study.dump` was called on."""
    settings = dict(dumped["study"])
    axes = tuple(Axis(axis["key"], tuple(axis["values"])) for axis in settings.pop("axes"))
    return Study(settings, axes, {name: dumped[name] for name in dumped if name != "study"})


def _study(table: StudyTable, given: Tables) -> Study:
    axes = tuple(_axis(axis.key, axis.resolved) for axis in table.axes)
    settings = {key: value for key, value in table.dump().items() if key != "axes"}
    settings = json.loads(json.dumps(settings))  # lists, as they are read again
    draft = Study(settings, axes, given)
    if draft.count > MOST_POINTS:
        raise InputError(
            f"the study has {draft.count} points, more than {MOST_POINTS}; give shorter axes"
        )
    _refuse_idle_starts(draft, given)
    _refuse_ragged_shapes(draft)
    return Study(settings, axes, _shared(draft))


def _axis(key: str, values: Sequence[int | float]) -> Axis:
    """Return an axis with values of the type that its key has."""
    known = {
        f"{table}.{name}": field.annotation
        for table, of in RunInput.model_fields.items()
        for name, field in getattr(of.annotation, "model_fields", {}).items()
    }
    if key not in known:
        near = nearest(key, known)
        cure = f"did you mean {near}?" if near else "take one such as load.force"
        raise InputError(f"study.axes varies {key}, which is no key of a run; {cure}")
    kinds = (known[key], *get_args(known[key]))
    if int in kinds:
        whole = all(value == round(value) for value in values)
        return Axis(key, tuple(int(value) for value in values) if whole else tuple(values))
    return Axis(key, tuple(float(value) for value in values))


def _refuse_ragged_shapes(study: Study) -> None:
    """Refuse to keep shapes of different numbers of nodes, for which one array has no room."""
    ragged = [axis.key for axis in study.axes if axis.key in ("model.segments", "model.links")]
    if study.keep == "period" and ragged:
        raise InputError(
            f"{ragged[0]} varies, and shapes of different lengths do not fit in one array; use"
            " study.keep = 'run' or 'verdict', or leave out this axis"
        )


def _refuse_idle_starts(study: Study, given: Tables) -> None:
    """Refuse settings of the start that no point would read."""
    if study.policy == "random":
        idle = [axis.key for axis in study.axes if axis.key.startswith("start.")]
        idle += [f"start.{key}" for key in given["start"]]
        if idle:
            raise InputError(
                f"{idle[0]} has no meaning for study.policy = 'random', whose starts follow from"
                f" study.amplitudes and study.seed; remove {idle[0]}"
            )
    last = study.axes[-1].key
    if study.policy == "neighbour" and last.startswith("start."):
        raise InputError(
            f"{last} has no meaning along the last axis for study.policy = 'neighbour', whose runs"
            " begin with what the one before has come to; put another axis last"
        )


def _shared(draft: Study) -> Tables:
    """Check the input of all points; return what they have in common when it is resolved."""
    common: dict[str, dict[str, Any]] | None = None
    tries = draft.shape[-1]
    for number in range(0, draft.count, tries):
        dumped = _checked(draft, number).dump()
        if common is None:
            common = dumped
        for name, table in common.items():
            for key in [key for key in table if table[key] != dumped[name].get(key)]:
                del table[key]  # an axis, or a default that depends on one
    assert common is not None  # there is a point at least
    for name, key in (axis.key.split(".") for axis in draft.axes):
        common[name].pop(key, None)
    if draft.policy == "random":
        common["start"] = {}
    return common


def _checked(draft: Study, number: int) -> RunInput:
    try:
        wanted = parse_input(draft.tables(number))
        model = build_model(wanted)
        model.straight()  # of which extensible links may be incapable
        refuse_too_large(model, build_schedule(wanted))
        if number == 0:
            build_start(wanted, model)  # which may lie in a file
        if model.unwrapped and draft.policy == "neighbour":
            raise InputError(
                "joints that wind up lose their full turns between neighbours; use model.spring ="
                " 'angle' or another study.policy"
            )
    except InputError as error:
        place = zip(draft.axes, draft.place(number), strict=False)
        told = ", ".join(f"{axis.key} = {axis.values[at]}" for axis, at in place)
        raise InputError(f"the study cannot run at {told}: {error}") from None
    return wanted
