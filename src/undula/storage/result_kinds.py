"""The kinds of result files, and the sentences with which others are refused."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import xarray as xr

from undula.errors import InputError
from undula.schema.formats import RUN_FORMAT


@dataclass(frozen=True)
class Kind:
    """A kind of result file.

    Attributes
    ----------
    format
        Its name and number, which every file of it carries.
    command
        What writes such files.
    """

    format: str
    command: str


RUN = Kind(RUN_FORMAT, "undula run")

#: Attributes of any kind that are JSON.
_JSON = ("input", "versions", "summary", "health", "options", "units")


def damaged(path: Path, kind: Kind) -> InputError:
    """Return the error of a file that cannot be read."""
    return InputError(f"{path} is cut short or damaged; make it again with {kind.command}")


def check_format(path: Path, kind: Kind, attributes: Mapping[str, Any]) -> None:
    """Refuse a result of another kind or format, by the attributes of its root."""
    found = attributes.get("undula_format")
    if found is None:
        raise InputError(
            f"{path} was not written by undula; give a result file written by {kind.command}"
        )
    if str(found).split()[:1] != kind.format.split()[:1]:
        raise InputError(
            f"{path} is a result of another command ({str(found)!r}); give a result file written"
            f" by {kind.command}"
        )
    if found != kind.format:
        raise InputError(
            f"{path} has the format {str(found)!r}, but this version of undula reads"
            f" {kind.format!r}; use the version that wrote it"
        )


def refuse_broken_attributes(path: Path, kind: Kind, dataset: xr.Dataset) -> None:
    """Refuse attributes that are no JSON any longer, of a file that other software has stored."""
    for name in _JSON:
        try:
            json.loads(dataset.attrs.get(name, "{}"))
        except (TypeError, ValueError):
            raise InputError(
                f"the attribute {name} of {path} is no JSON; give a file that has it as"
                f" {kind.command} wrote it"
            ) from None
