"""The input of a command: a frozen, checked record with a default for every key.

One file describes a model and may hold tables for several commands; each reads its own.
"""

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any, Self, TypeVar

from pydantic import Field, ValidationError, model_validator

from undula.errors import InputError
from undula.inputs.messages import explain
from undula.inputs.model_tables import LoadTable, ModelTable
from undula.inputs.overrides import apply_overrides, read_toml
from undula.inputs.run_tables import StabilityTable, StartTable, TimeTable
from undula.inputs.sweep_table import StudyTable
from undula.inputs.table import Table, conflict
from undula.models.description import words
from undula.models.loads.beads import BeadLoad
from undula.models.units import FILAMENT_UNITS, chain_units


class ModelInput(Table):
    """What every command reads.

    Attributes
    ----------
    model, load
        What moves, and what pushes it. Every key has a value; one that has no meaning under the
        choices made holds its default and is left out of `dump`.
    """

    model: ModelTable = Field(default=ModelTable(), description="a table")
    load: LoadTable = Field(default=LoadTable(), description="a table")

    @model_validator(mode="before")
    @classmethod
    def _chains_move_like_filaments(cls, given: Any) -> Any:
        """Give a chain the force and the times that correspond to a filament's defaults."""
        table = given.get("model") if isinstance(given, Mapping) else None
        if not (isinstance(table, Mapping) and table.get("kind") == "chain"):
            return given
        links = table.get("links", ModelTable.model_fields["links"].default)
        if not isinstance(links, int) or links < 1:
            return given  # which is refused where its range is known
        units = chain_units(links)
        corresponding = {
            "load": {"force": LoadTable().force / units.forces[FILAMENT_UNITS.force]},
            "time": {key: value * units.duration for key, value in _times(given).items()},
        }
        return dict(given) | {
            name: defaults | dict(given.get(name, {}))
            for name, defaults in corresponding.items()
            if name in cls.model_fields and isinstance(given.get(name, {}), Mapping)
        }

    @model_validator(mode="after")
    def _force_finds_its_beads(self) -> Self:
        if self.load.profile != "beads":
            return self
        if self.model.kind != "chain":
            raise conflict(
                "load.profile = 'beads' acts on beads, and a filament has none; use model.kind ="
                " 'chain' or another profile"
            )
        try:
            BeadLoad(self.load.force, self.load.beads).shares(self.model.links)
        except InputError as error:
            raise conflict(f"load.{str(error).removeprefix('BeadLoad: ')}") from None
        return self

    @property
    def load_text(self) -> str:
        """Model and load in a few words, such as ``tip force 75``."""
        return self.tell()

    def tell(self, swept: Collection[str] = ()) -> str:
        """Return model and load in a few words, without the keys that a curve sweeps over."""
        body, load = (
            {name: getattr(table, name) for name in table.dump()}
            for table in (self.model, self.load)
        )
        return words(body, self.load.profile, load, swept)

    def dump(self) -> dict[str, Any]:
        """Return the complete resolved input as plain JSON types.

        Returns
        -------
        dict
            Table name to keys and values, without the keys that have no meaning under the
            choices made. `parse_input` turns it back into an equal record.
        """
        return {name: getattr(self, name).dump() for name in type(self).model_fields}


class RunInput(ModelInput):
    """The complete, checked input of one run: the filament, its start, and how long."""

    start: StartTable = Field(default=StartTable(), description="a table")
    time: TimeTable = Field(default=TimeTable(), description="a table")

    @model_validator(mode="after")
    def _start_fits_in_the_plane(self) -> Self:
        if self.model.confined and self.start.shape == "helix":
            raise conflict(
                "start.shape = 'helix' leaves the plane that model.confined = true keeps; use"
                " start.shape = 'planar' or model.confined = false"
            )
        if self.model.confined and self.start.angle != 0.0:
            raise conflict(
                f"start.angle = {self.start.angle} leaves the plane that model.confined = true"
                " keeps; use start.angle = 0 or model.confined = false"
            )
        return self


class StabilityInput(ModelInput):
    """The complete, checked input of a question about the straight state."""

    stability: StabilityTable = Field(default=StabilityTable(), description="a table")


class StudyInput(RunInput):
    """The complete, checked input of a study: that of its runs, and what is varied in it."""

    study: StudyTable = Field(default=StudyTable(), description="a table")


class _WholeFile(StudyInput, StabilityInput):
    """All that an input file may hold."""


Input = TypeVar("Input", bound=ModelInput)


def parse_input(tables: Mapping[str, Any]) -> RunInput:
    """Check an input that has already been read into plain Python types.

    Parameters
    ----------
    tables
        Table name to keys and values, as TOML or JSON gives them.

    Returns
    -------
    RunInput
        The checked input, every default filled in.

    Raises
    ------
    InputError
        The first mistake, what would be right, and how many more there are.
    """
    return _checked(RunInput, tables)


def read_input(path: Path | None = None, overrides: Sequence[str] = ()) -> RunInput:
    """Read the input of a run, change single keys in it, and check the whole.

    Parameters
    ----------
    path
        A TOML file in UTF-8; without one, everything starts from the defaults.
    overrides
        Changes such as ``"load.force=80"``, applied in order. The value is read as TOML; what
        is not TOML is text, so ``"load.profile=linear"`` needs no quotes.

    Returns
    -------
    RunInput
        The checked input, every default filled in.

    Raises
    ------
    InputError
        The file cannot be read or is not TOML, an override is malformed or meant for another
        command, or a key or value is wrong. The sentence names the culprit and what would be
        right.
    """
    return read_tables(RunInput, path, overrides)[1]


def read_model_input(path: Path | None = None, overrides: Sequence[str] = ()) -> ModelInput:
    """Read what every command reads, as `read_input` does for a run."""
    return read_tables(ModelInput, path, overrides)[1]


def read_stability_input(path: Path | None = None, overrides: Sequence[str] = ()) -> StabilityInput:
    """Read the input of a question about the straight state, as `read_input` does for a run."""
    return read_tables(StabilityInput, path, overrides)[1]


def read_tables(
    record: type[Input], path: Path | None, overrides: Sequence[str]
) -> tuple[dict[str, Any], Input]:
    """Read an input as `read_input` does for a run; return its tables as given, and checked."""
    return changed_tables(record, {} if path is None else read_toml(path), overrides)


def changed_tables(
    record: type[Input], tables: Mapping[str, Any], overrides: Sequence[str]
) -> tuple[dict[str, Any], Input]:
    """Change single keys in tables; return those that a record reads as given, and checked."""
    given = apply_overrides(tables, overrides)
    _checked(_WholeFile, given)
    for override in overrides:
        if override.partition(".")[0].strip() not in record.model_fields:
            raise InputError(
                f"--set {override} changes a table that this command does not read; it reads"
                f" {', '.join(f'[{known}]' for known in record.model_fields)}"
            )
    mine = {name: given[name] for name in record.model_fields if name in given}
    return mine, _checked(record, mine)


def _times(given: Mapping[str, Any]) -> dict[str, float]:
    """Return the default times of a filament that the choices in an input leave a meaning."""
    fields, chosen = TimeTable.model_fields, given.get("time")
    if isinstance(chosen, Mapping) and chosen.get("until") in ("settled", "solved"):
        return {"limit": fields["limit"].default}
    return {"until": fields["until"].default}


def _checked(record: type[Input], tables: Mapping[str, Any]) -> Input:
    try:
        return record.model_validate(dict(tables))
    except ValidationError as error:
        raise InputError(explain(error, record)) from None
