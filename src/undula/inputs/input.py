"""Inputs of commands: frozen, checked records with a default for every key.

One file describes a model and may hold tables for several commands; each command reads its own
tables.
"""

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any, Self, TypeVar

from pydantic import Field, ValidationError, model_validator

from undula.errors import InputError
from undula.inputs.chain_defaults import with_chain_defaults
from undula.inputs.given_units import dimensionless
from undula.inputs.messages import explain
from undula.inputs.model_tables import LoadTable, ModelTable
from undula.inputs.overrides import apply_overrides, read_toml
from undula.inputs.run_tables import StabilityTable, StartTable, TimeTable
from undula.inputs.sweep_table import SweepTable
from undula.inputs.table import Table, conflict
from undula.inputs.units_table import UnitsTable
from undula.models.description import describe
from undula.models.loads.beads import BeadLoad
from undula.models.scales import Scales


class ModelInput(Table):
    """The input of a model, which every command reads.

    Attributes
    ----------
    model, load
        The tables ``[model]`` and ``[load]``. Every key has a value; a key without meaning for the
        chosen values of other keys holds its default and is left out of `dump`.
    units
        The table ``[units]``, None without one; it changes no dimensionless number.
    """

    model: ModelTable = Field(default=ModelTable(), description="a table")
    load: LoadTable = Field(default=LoadTable(), description="a table")
    units: UnitsTable | None = Field(default=None, description="a table")

    @model_validator(mode="before")
    @classmethod
    def _chains_move_like_filaments(cls, given: Any) -> Any:
        """Set the defaults of a chain: force and times that correspond to those of a filament."""
        return with_chain_defaults(given, cls.model_fields)

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

    @model_validator(mode="after")
    def _units_are_of_a_filament(self) -> Self:
        if self.units is not None and self.model.kind == "chain":
            raise conflict(
                "[units] are those of a filament, and model.kind = 'chain' has springs and beads"
                " of its own; use model.kind = 'filament' or remove [units]"
            )
        return self

    @property
    def scales(self) -> Scales | None:
        """SI values of the dimensionless units, None without a table ``[units]``."""
        return None if self.units is None else self.units.scales

    @property
    def load_text(self) -> str:
        """Model and load in a few words, such as ``tip force 75``."""
        return self.describe()

    def describe(self, varied: Collection[str] = ()) -> str:
        """Return model and load in a few words, without the keys in `varied`."""
        body, load = (
            {name: getattr(table, name) for name in table.dump()}
            for table in (self.model, self.load)
        )
        return describe(body, self.load.profile, load, varied)

    def dump(self) -> dict[str, Any]:
        """Return the complete resolved input as plain JSON types.

        Returns
        -------
        dict
            Keys and values by table, without the keys that have no meaning for the chosen values
            of others, and without a table ``[units]`` that is not given. `parse_input` turns it
            back into an equal record.
        """
        tables = {name: getattr(self, name) for name in type(self).model_fields}
        return {name: table.dump() for name, table in tables.items() if table is not None}


class RunInput(ModelInput):
    """The complete, checked input of one run: model, load, start and time."""

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
    """The complete, checked input of a stability analysis of the straight state."""

    stability: StabilityTable = Field(default=StabilityTable(), description="a table")

    @model_validator(mode="after")
    def _units_have_one_time(self) -> Self:
        if self.units is not None and self.stability.paper_time:
            raise conflict(
                "stability.paper_time = true has a unit of time that is not that of [units]; use"
                " stability.paper_time = false or remove [units]"
            )
        return self


class SweepInput(RunInput):
    """The complete, checked input of a sweep: that of its runs, and the table ``[study]``."""

    study: SweepTable = Field(default=SweepTable(), description="a table")


class _WholeFile(SweepInput, StabilityInput):
    """All tables of an input file."""


Input = TypeVar("Input", bound=ModelInput)


def parse_input(tables: Mapping[str, Any]) -> RunInput:
    """Check an input in plain Python types.

    Parameters
    ----------
    tables
        Keys and values by table, as read from TOML or JSON.

    Returns
    -------
    RunInput
        The checked input, every default filled in.

    Raises
    ------
    InputError
        A key or value is wrong. The sentence states the first mistake, its cure and the number of
        further mistakes.
    """
    return _checked(RunInput, dimensionless(tables))


def read_input(path: Path | None = None, overrides: Sequence[str] = ()) -> RunInput:
    """Read the input of a run, change single keys in it, and check the whole.

    Parameters
    ----------
    path
        A TOML file in UTF-8; None for the defaults.
    overrides
        Changes such as ``"load.force=80"``, applied in order. A value that is not valid TOML is
        taken as text, so that ``"load.profile=linear"`` needs no quotes.

    Returns
    -------
    RunInput
        The checked input, every default filled in.

    Raises
    ------
    InputError
        The file cannot be read or is not TOML, an override is malformed or belongs to another
        command, or a key or value is wrong. The sentence names the culprit and the cure.
    """
    return read_tables(RunInput, path, overrides)[1]


def read_model_input(path: Path | None = None, overrides: Sequence[str] = ()) -> ModelInput:
    """Read the input of a model; arguments and errors as for `read_input`.

    Parameters
    ----------
    path
        A TOML file in UTF-8; None for the defaults.
    overrides
        Changes such as ``"load.force=80"``, applied in order.
    """
    return read_tables(ModelInput, path, overrides)[1]


def read_stability_input(path: Path | None = None, overrides: Sequence[str] = ()) -> StabilityInput:
    """Read the input of a stability analysis; arguments and errors as for `read_input`.

    Parameters
    ----------
    path
        A TOML file in UTF-8; None for the defaults.
    overrides
        Changes such as ``"load.force=80"``, applied in order.
    """
    return read_tables(StabilityInput, path, overrides)[1]


def read_tables(
    record: type[Input], path: Path | None, overrides: Sequence[str]
) -> tuple[dict[str, Any], Input]:
    """Read an input of a given type; return its tables as given, and the checked record.

    Arguments and errors are as for `changed_tables`, with a file in place of tables.

    Parameters
    ----------
    record
        Type of the input.
    path
        A TOML file in UTF-8; None for the defaults.
    overrides
        Changes such as ``"load.force=80"``, applied in order.
    """
    return changed_tables(record, {} if path is None else read_toml(path), overrides)


def changed_tables(
    record: type[Input], tables: Mapping[str, Any], overrides: Sequence[str]
) -> tuple[dict[str, Any], Input]:
    """Change single keys in tables and check the result.

    Parameters
    ----------
    record
        Type of the input.
    tables
        Keys and values by table.
    overrides
        Changes such as ``"load.force=80"``, applied in order.

    Returns
    -------
    dict
        The tables of this type of input as given, with dimensionless numbers.
    Input
        The checked record, every default filled in.

    Raises
    ------
    InputError
        An override is malformed or belongs to another command, or a key or value is wrong.
    """
    given = dimensionless(apply_overrides(tables, overrides))
    _checked(_WholeFile, given)
    for override in overrides:
        if override.partition(".")[0].strip() not in record.model_fields:
            raise InputError(
                f"--set {override} changes a table that this command does not read; it reads"
                f" {', '.join(f'[{name}]' for name in record.model_fields)}"
            )
    own = {name: given[name] for name in record.model_fields if name in given}
    return own, _checked(record, own)


def _checked(record: type[Input], tables: Mapping[str, Any]) -> Input:
    try:
        return record.model_validate(dict(tables))
    except ValidationError as error:
        raise InputError(explain(error, record)) from None
