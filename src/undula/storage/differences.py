"""First difference between two records in plain JSON types, in words."""

import json
from collections.abc import Mapping, Sequence
from typing import Any


def difference(stored: Any, wanted: Any, name: str = "") -> str | None:
    """Return the first difference, such as ``load.force = 75.0 instead of 80.0``; None without.

    Parameters
    ----------
    stored, wanted
        Values in plain JSON types.
    name
        Name of both values in the sentence.
    """
    if isinstance(stored, Mapping) and isinstance(wanted, Mapping):
        for key in dict.fromkeys([*wanted, *stored]):
            inner = difference(stored.get(key), wanted.get(key), f"{name}.{key}" if name else key)
            if inner is not None:
                return inner
        return None
    if _is_list(stored) and _is_list(wanted):
        if len(stored) != len(wanted):
            return f"{name} of length {len(stored)} instead of {len(wanted)}"
        pairs = enumerate(zip(stored, wanted, strict=True))
        inners = (difference(left, right, f"{name}[{k}]") for k, (left, right) in pairs)
        return next((inner for inner in inners if inner is not None), None)
    if stored != wanted:
        return f"{name} = {json.dumps(stored)} instead of {json.dumps(wanted)}"
    return None


def _is_list(value: Any) -> bool:
    return isinstance(value, Sequence) and not isinstance(value, str)
