"""Comparison of the keys of a JSON answer with those of the schema."""

import json
from collections.abc import Iterator
from typing import Any

from undula.schema.answer_keys import PARAMETER, Named


def unknown_keys(answer: str, keys: Any) -> list[str]:
    """Return the places of an answer that its schema does not have; none for what is not JSON."""
    return list(_unknown(json.loads(answer), keys, "")) if answer.startswith("{") else []


def _unknown(value: Any, keys: Any, place: str) -> Iterator[str]:
    if isinstance(value, list):
        for part in value:
            yield from _unknown(part, keys, place)
    elif isinstance(value, dict):
        if isinstance(keys, str):
            yield f"{place}: an object in place of a number or word"
            return
        for name, part in value.items():
            inner = keys.values if isinstance(keys, Named) else _keys_of(name, keys)
            if inner is None:
                yield f"{place}.{name}"
            else:
                yield from _unknown(part, inner, f"{place}.{name}")


def _keys_of(name: str, keys: Any) -> Any:
    """Return what is known of a key; a parameter has a dot in its name, and no unit."""
    return keys.get(name, keys.get(PARAMETER) if "." in name else None)
