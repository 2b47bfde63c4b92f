"""Messages on wrong inputs: one sentence with the culprit, the mistake and the cure."""

import difflib
import math
from collections.abc import Iterable, Mapping
from datetime import date, datetime, time
from typing import Any, get_args

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from undula.inputs.table import CONFLICT, IDLE_KEY

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
    """Return a sentence with the first mistake and the number of further mistakes.

    Parameters
    ----------
    error
        The error that pydantic raised.
    record
        Type of the input; its fields are the tables, whose fields are the keys.

    Returns
    -------
    str
        A sentence such as ``load.slope = 2.0 is out of range; load.slope takes a number from
        -1 to 1``.
    """
    known = _known_keys(record)
    mistakes: dict[str, ErrorDetails] = {}
    for details in error.errors():
        # A key of two types, a number or a word, fails once for each type: one mistake.
        mistakes.setdefault(_place(details, known)[-1], details)
    more = len(mistakes) - 1
    sentence = _sentence(next(iter(mistakes.values())), known)
    return sentence if more == 0 else f"{sentence} ({more} more mistake{'s' * (more > 1)})"


def _known_keys(record: type[BaseModel], prefix: str = "") -> dict[str, dict[str, str]]:
    """Return description by key by table; a list of tables is named as in study.axes."""
    known: dict[str, dict[str, str]] = {}
    for name, field in record.model_fields.items():
        listed = get_args(field.annotation)[:1]
        for table in (field.annotation, *listed):
            if isinstance(table, type) and issubclass(table, BaseModel):
                keys = table.model_fields.items()
                known[f"{prefix}{name}"] = {
                    of.alias or key: str(of.description) for key, of in keys
                }
                known |= _known_keys(table, f"{prefix}{name}.")
    return known


def _place(details: ErrorDetails, known: Mapping[str, Any]) -> tuple[str, ...]:
    """Return table, key and the name of both; table and its name if the table itself is wrong.

    The name of a table in a list contains its number, as in ``study.axes[0].count``.
    """
    place = details["loc"]
    outer = ".".join(map(str, place[:2]))
    if outer in known and len(place) > 3:
        return outer, str(place[3]), _name(f"{outer}[{place[2]}]", str(place[3]))
    parts = [str(part) for part in place[:2]]
    return (*parts, _name(*parts))


def _sentence(details: ErrorDetails, known: Mapping[str, Mapping[str, str]]) -> str:
    """Return the message on one mistake."""
    kind, value, place = details["type"], details["input"], _place(details, known)
    if kind == CONFLICT:
        return details["msg"]
    if len(place) == 2:
        return _wrong_table(place[0], value, known)
    table, key, name = place
    if kind == "extra_forbidden":
        return f"{name} is not a known key; {_cure_of_key(table, key, known)}"
    if kind == IDLE_KEY:
        return _idle_key(table, key, value, details["ctx"])
    # After table and key, or table, list, index and key, follows the index in a list of numbers.
    inner = details["loc"][4 if "." in table else 2 :]
    entry = "".join(f"[{part}]" for part in inner if isinstance(part, int))
    verdict = _verdict(kind, value)
    return f"{name}{entry} = {_show(value)} {verdict}; {name} takes {known[table][key]}"


def _wrong_table(table: str, value: Any, known: Mapping[str, Mapping[str, str]]) -> str:
    """Return the message on an outermost name that is no table or has a value of another type."""
    if table in known:
        return f"{_name(table)} = {_show(value)} is not a table; write [{table}] and its keys below"
    homes = [name for name in _outermost(known) if table in known[name]]
    if homes:
        return f"{table} stands outside its table; write {homes[0]}.{table}"
    tables = _outermost(known)
    near = nearest(table, tables)
    cure = f"did you mean [{near}]?" if near else f"the tables are {_listed(tables, 'and')}"
    return f"[{_name(table)}] is not a known table; {cure}"


def _outermost(known: Iterable[str]) -> list[str]:
    """Return the tables that are not inside another one."""
    return [name for name in known if "." not in name]


def _cure_of_key(table: str, key: str, known: Mapping[str, Mapping[str, str]]) -> str:
    near = nearest(key, known[table])
    if near:
        return f"did you mean {table}.{near}?"
    homes = [name for name, keys in known.items() if key in keys]
    if homes:
        return f"did you mean {homes[0]}.{key}?"
    return f"the keys of [{table}] are {_listed(known[table], 'and')}"


def _idle_key(table: str, key: str, value: Any, rule: Mapping[str, Any]) -> str:
    """Return the message on a key without meaning for the value of another key, its chooser."""
    chooser = f"{table}.{rule['chooser']}"
    use = _listed([repr(choice) for choice in rule["values"]], "or")
    return (
        f"{table}.{key} = {_show(value)} has no meaning for {chooser} = {_show(rule['chosen'])};"
        f" use {chooser} = {use} or remove {table}.{key}"
    )


def _verdict(kind: str, value: Any) -> str:
    """Return the mistake as a predicate, from pydantic's name of its kind."""
    if isinstance(value, float) and not math.isfinite(value):
        return "is not a finite number"
    if kind.startswith(("greater_than", "less_than")):
        return "is out of range"
    if kind.endswith("too_short"):
        return "is empty"
    if kind == "literal_error" and isinstance(value, str):
        return "is not known"
    if kind.endswith("_type") and isinstance(value, int) and not isinstance(value, bool):
        # Whole numbers are valid numbers unless they exceed the range of a float.
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
    # Quoted keys may contain line breaks, which would split the sentence.
    return ".".join(part if part.isprintable() else repr(part) for part in parts)


def nearest(word: str, known: Iterable[str]) -> str | None:
    """Return the most similar known word, None if no word is similar.

    Parameters
    ----------
    word
        A word that is not known.
    known
        The known words.
    """
    return next(iter(difflib.get_close_matches(word.lower(), list(known), n=1)), None)


def _listed(words: Iterable[str], last: str) -> str:
    *front, back = words
    return f"{', '.join(front)} {last} {back}" if front else back
