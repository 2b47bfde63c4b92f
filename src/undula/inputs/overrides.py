"""Reading of TOML files into plain tables, and changes of single keys."""

import re
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from undula.errors import InputError

#: Largest input file [bytes]: lists of a million numbers fit.
_LARGEST = 32_000_000
_PLACE = re.compile(r" \(at (.*)\)$")


def read_toml(path: Path) -> dict[str, Any]:
    """Read a TOML file into plain Python types.

    Parameters
    ----------
    path
        A TOML file in UTF-8, with or without a byte order mark.

    Raises
    ------
    InputError
        The file is missing, unreadable, too large, not UTF-8 or not TOML; the sentence on wrong
        TOML contains line and column.
    """
    try:
        with path.open("rb") as file:
            content = file.read(_LARGEST + 1)
        text = content.decode("utf-8-sig")
    except FileNotFoundError:
        raise InputError(f"there is no input file {path}; check the name") from None
    except OSError as error:
        reason = error.strerror or error
        raise InputError(
            f"cannot read the input file {path} ({reason}); give a readable TOML file"
        ) from error
    except UnicodeDecodeError as error:
        raise InputError(
            f"{path} is not UTF-8 text (byte {error.start}); give a TOML file saved as UTF-8"
        ) from None
    if len(content) > _LARGEST:
        raise InputError(
            f"{path} is larger than any input file, beyond {_LARGEST // 10**6} MB; check the name"
        )
    return _parse(path, text)


def apply_overrides(tables: Mapping[str, Any], overrides: Sequence[str]) -> dict[str, Any]:
    """Return a copy of `tables` with single keys changed or added.

    Parameters
    ----------
    tables
        Keys and values by table; not changed.
    overrides
        ``TABLE.KEY=VALUE``, applied in order. A value that is not valid TOML is taken as text.

    Raises
    ------
    InputError
        An override has no ``=``, no table, more than one dot or no value.
    """
    changed = {
        name: dict(table) if isinstance(table, Mapping) else table for name, table in tables.items()
    }
    for override in overrides:
        name, key, value = _split(override)
        table = changed.setdefault(name, {})
        # A value in place of a table stays: the check of the whole input reports it.
        if isinstance(table, dict):
            table[key] = value
    return changed


def _parse(path: Path, text: str) -> dict[str, Any]:
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        message = str(error)
        match = _PLACE.search(message)
        place = f", {match.group(1)}" if match else ""
        raise InputError(
            f"{path}{place}: {_PLACE.sub('', message)}; correct the TOML there"
        ) from None
    except (ValueError, RecursionError):
        # Numbers of thousands of digits, and thousands of nested brackets.
        raise InputError(
            f"{path} holds a value too large to read; give plain TOML numbers and text"
        ) from None


def _split(override: str) -> tuple[str, str, Any]:
    target, equals, text = (part.strip() for part in override.partition("="))
    if not equals:
        raise InputError(f"--set {override} has no '='; write --set {target or 'load.force'}=VALUE")
    name, dot, key = (part.strip() for part in target.partition("."))
    if not (name and dot and key) or "." in key:
        raise InputError(
            f"--set {override} does not name a table and a key; write it like --set load.force=75"
        )
    if not text:
        raise InputError(f"--set {override} gives no value; write --set {target}=VALUE")
    return name, key, _value(text)


def _value(text: str) -> Any:
    try:
        parsed = tomllib.loads(f"value = {text}")
    except (ValueError, RecursionError):
        return text
    return parsed["value"] if parsed.keys() == {"value"} else text
