"""The input of one run: a frozen, checked record with a default for every key."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Self

from pydantic import Field, ValidationError, model_validator

from undula.errors import InputError
from undula.studies.complaints import explain
from undula.studies.overrides import apply_overrides, read_toml
from undula.studies.strict_table import Table, conflict
from undula.studies.tables import LoadTable, ModelTable, StartTable, TimeTable


class RunInput(Table):
    """The complete, checked input of one run.

    Attributes
    ----------
    model, load, start, time
        The four tables. Every key has a value; one that has no meaning under the choices made
        holds its default and is left out of :meth:`dump`.
    """

    model: ModelTable = Field(default=ModelTable(), description="a table")
    load: LoadTable = Field(default=LoadTable(), description="a table")
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

    @property
    def load_text(self) -> str:
        """The load in a few words, such as ``tip force 75``."""
        return self.load.text

    def dump(self) -> dict[str, Any]:
        """Return the complete resolved input as plain JSON types.

        Returns
        -------
        dict
            Table name to keys and values, without the keys that have no meaning under the
            choices made. :func:`parse_input` turns it back into an equal record.
        """
        return {name: getattr(self, name).dump() for name in type(self).model_fields}


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
    try:
        return RunInput.model_validate(dict(tables))
    except ValidationError as error:
        raise InputError(explain(error, RunInput)) from None


def read_input(path: Path | None = None, overrides: Sequence[str] = ()) -> RunInput:
    """Read an input file, change single keys in it, and check the whole.

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
        The file cannot be read or is not TOML, an override is malformed, or a key or value is
        wrong. The sentence names the culprit and what would be right.
    """
    tables = {} if path is None else read_toml(path)
    return parse_input(apply_overrides(tables, overrides))
