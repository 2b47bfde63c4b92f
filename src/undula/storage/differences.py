"""What two records in plain JSON types differ in, told in words."""

import json
from collections.abc import Mapping, Sequence
from typing import Any


def difference(found: Any, wanted: Any, at: str = "") -> str | None:
    """Return the first difference, such as ``load.force = 75.0 instead of 80.0``; None without.

    Parameters
    ----------
    found, wanted
        Values in plain JSON types.
    at
        The name of both.
    """
    if isinstance(found, Mapping) and isinstance(wanted, Mapping):
        for key in dict.fromkeys([*wanted, *found]):
            inner = difference(found.get(key), wanted.get(key), f"{at}.{key}" if at else key)
            if inner is not None:
                return inner
        return None
    if _is_list(found) and _is_list(wanted):
        if len(found) != len(wanted):
            return f"{at} of length {len(found)} instead of {len(wanted)}"
        entries = enumerate(zip(found, wanted, strict=True))
        inners = (difference(one, other, f"{at}[{k}]") for k, (one, other) in entries)
        return next((inner for inner in inners if inner is not None), None)
    if found != wanted:
        return f"{at} = {json.dumps(found)} instead of {json.dumps(wanted)}"
    return None


def _is_list(value: Any) -> bool:
    return isinstance(value, Sequence) and not isinstance(value, str)
