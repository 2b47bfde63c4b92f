"""Kinds of result files, and checks that refuse files of another kind."""

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
        Name and number of the format, which every file carries.
    command
        Command that writes such files.
    """

    format: str
    command: str


class OtherKindError(InputError):
    """A result is of another kind than the expected one.

    Parameters
    ----------
    sentence
        The mistake and its cure.
    name
        Name of the format that the result carries, without its number.
    """

    def __init__(self, sentence: str, name: str) -> None:
        super().__init__(sentence)
        self.name = name


RUN = Kind(RUN_FORMAT, "undula run")

#: Attributes that hold JSON, in files of any kind.
_JSON = ("input", "versions", "summary", "health", "options", "units")


def damaged(path: Path, kind: Kind) -> InputError:
    """Return the error for a file that cannot be read.

    Parameters
    ----------
    path
        The file.
    kind
        The expected kind.
    """
    return InputError(f"{path} is cut short or damaged; make it again with {kind.command}")


def check_format(path: Path, kind: Kind, attributes: Mapping[str, Any]) -> None:
    """Refuse a result of another kind or format.

    Parameters
    ----------
    path
        The file, for the sentence.
    kind
        The expected kind.
    attributes
        Attributes of the root group.

    Raises
    ------
    OtherKindError
        The file is a result of another kind.
    InputError
        The file is no result, or one of another format.
    """
    written = attributes.get("undula_format")
    if written is None:
        raise InputError(
            f"{path} was not written by undula; give a result file written by {kind.command}"
        )
    if str(written).split()[:1] != kind.format.split()[:1]:
        raise OtherKindError(
            f"{path} is a result of another command ({str(written)!r}); give a result file written"
            f" by {kind.command}",
            str(written).partition(" ")[0],
        )
    if written != kind.format:
        raise InputError(
            f"{path} has the format {str(written)!r}, but this version of undula reads"
            f" {kind.format!r}; use the version that wrote it"
        )


def refuse_broken_attributes(path: Path, kind: Kind, dataset: xr.Dataset) -> None:
    """Refuse a file of other software in which an attribute is no longer valid JSON.

    Parameters
    ----------
    path
        The file.
    kind
        The expected kind.
    dataset
        Its content.

    Raises
    ------
    InputError
        An attribute is not JSON.
    """
    for name in _JSON:
        try:
            json.loads(dataset.attrs.get(name, "{}"))
        except (TypeError, ValueError):
            raise InputError(
                f"the attribute {name} of {path} is no JSON; give a file that has it as"
                f" {kind.command} wrote it"
            ) from None
