"""Validation errors as one sentence for the user: the culprit, what is wrong, and the cure."""

import difflib
import math
from collections.abc import Iterable, Mapping
from datetime import date, datetime, time
from typing import Any

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from undula.studies.strict_table import CONFLICT, IDLE_KEY

_LONGEST_VALUE = 60
_KINDS: tuple[tuple[type | tuple[type, ...], str], ...] = (
    (bool, "a truth value"),
    (int, "a whole number"),
    (float, "a decimal number"),
    (str, "text"),
    (list, "a list"),
    (dict, "a table"),
    ((datetime, date, time), "a date or time"),
)


def explain(error: ValidationError, record: type[BaseModel]) -> str:
    """Tell the first mistake in one sentence, and how many more there are.

    Parameters
    ----------
    error
        What pydantic found wrong.
    record
        The whole input; its fields are the tables, whose fields are the keys.

    Returns
    -------
    str
        A sentence such as ``load.slope = 2.0 is out of range; load.slope takes a number from
        -1 to 1``.
    """
    mistakes: dict[tuple[str, ...], ErrorDetails] = {}
    for details in error.errors():
        # A key of two types (a number or a word) fails once for each: it is one mistake.
        mistakes.setdefault(tuple(str(part) for part in details["loc"][:2]), details)
    more = len(mistakes) - 1
    place, first = next(iter(mistakes.items()))
    sentence = _sentence(place, first, _known_keys(record))
    return sentence if more == 0 else f"{sentence} ({more} more mistake{'s' * (more > 1)})"


def _known_keys(record: type[BaseModel]) -> dict[str, dict[str, str]]:
    """Return table name -> key -> what the key takes."""
    known = {}
    for name, field in record.model_fields.items():
        table = field.annotation
        if isinstance(table, type) and issubclass(table, BaseModel):
            known[name] = {key: str(of.description) for key, of in table.model_fields.items()}
    return known


def _sentence(
    place: tuple[str, ...], details: ErrorDetails, known: Mapping[str, Mapping[str, str]]
) -> str:
    kind, value = details["type"], details["input"]
    if kind == CONFLICT:
        return details["msg"]
    if len(place) == 1:
        return _wrong_table(place[0], value, known)
    table, key = place
    if kind == "extra_forbidden":
        return f"{_name(table, key)} is not a known key; {_cure_of_key(table, key, known)}"
    if kind == IDLE_KEY:
        return _idle_key(table, key, value, details["ctx"])
    name = _name(table, key)
    # In a list of numbers it is one entry that is wrong.
    entry = "".join(f"[{part}]" for part in details["loc"][2:] if isinstance(part, int))
    verdict = _verdict(kind, value)
    return f"{name}{entry} = {_show(value)} {verdict}; {name} takes {known[table][key]}"


def _wrong_table(table: str, value: Any, known: Mapping[str, Mapping[str, str]]) -> str:
    if table in known:
        return f"{_name(table)} = {_show(value)} is not a table; write [{table}] and its keys below"
    homes = [name for name, keys in known.items() if table in keys]
    if homes:
        return f"{table} stands outside its table; write {homes[0]}.{table}"
    near = _nearest(table, known)
    cure = f"did you mean [{near}]?" if near else f"the tables are {_listed(known, 'and')}"
    return f"[{_name(table)}] is not a known table; {cure}"


def _cure_of_key(table: str, key: str, known: Mapping[str, Mapping[str, str]]) -> str:
    near = _nearest(key, known[table])
    if near:
        return f"did you mean {table}.{near}?"
    homes = [name for name, keys in known.items() if key in keys]
    if homes:
        return f"did you mean {homes[0]}.{key}?"
    return f"the keys of [{table}] are {_listed(known[table], 'and')}"


def _idle_key(table: str, key: str, value: Any, rule: Mapping[str, Any]) -> str:
    chooser = f"{table}.{rule['chooser']}"
    use = _listed([repr(choice) for choice in rule["values"]], "or")
    return (
        f"{table}.{key} = {_show(value)} has no meaning for {chooser} = {_show(rule['chosen'])};"
        f" use {chooser} = {use} or remove {table}.{key}"
    )


def _verdict(kind: str, value: Any) -> str:
    if isinstance(value, float) and not math.isfinite(value):
        return "is not a finite number"
    if kind.startswith(("greater_than", "less_than")):
        return "is out of range"
    if kind.endswith("_too_short"):
        return "is empty"
    if kind == "literal_error" and isinstance(value, str):
        return "is not known"
    if kind.endswith("_type") and isinstance(value, int) and not isinstance(value, bool):
        # A whole number is taken wherever a number is, unless it exceeds what a float holds.
        return "is a whole number" if abs(value) < 1e308 else "is too large"
    return f"is {next((name for types, name in _KINDS if isinstance(value, types)), 'wrong')}"


def _show(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (datetime, date, time)):
        return value.isoformat()
    try:
        text = repr(value)
    except ValueError:
        # Python refuses to print whole numbers of thousands of digits.
        return "a number of thousands of digits"
    return text if len(text) <= _LONGEST_VALUE else f"{text[: _LONGEST_VALUE - 3]}..."


def _name(*parts: str) -> str:
    # Quoted keys may hold anything; a line break would tear the sentence apart.
    return ".".join(part if part.isprintable() else repr(part) for part in parts)


def _nearest(word: str, known: Iterable[str]) -> str | None:
    return next(iter(difflib.get_close_matches(word.lower(), list(known), n=1)), None)


def _listed(words: Iterable[str], last: str) -> str:
    *front, back = words
    return f"{', '.join(front)} {last} {back}" if front else back
