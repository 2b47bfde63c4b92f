"""Where two pinned values differ, in sentences."""

import difflib
import re
from collections.abc import Iterator
from typing import Any

_NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
_LONGEST = 160


def differences(before: Any, now: Any, place: str = "") -> Iterator[str]:
    """Yield a line for each difference: its place, what was pinned, and what is there now.

    Numbers are the same if they are of one type and have the same digits.
    """
    if isinstance(before, dict) and isinstance(now, dict):
        yield from _of_objects(before, now, place)
    elif _is_text(before) and _is_text(now):
        yield from _of_texts(before, now, place)
    elif isinstance(before, list) and isinstance(now, list) and len(before) == len(now):
        for index, (one, other) in enumerate(zip(before, now, strict=True)):
            yield from differences(one, other, f"{place}[{index}]")
    elif type(before) is not type(now) or repr(before) != repr(now):
        yield f"{place}: {_short(before)} -> {_short(now)}{_how_far(before, now)}"


def _of_objects(before: dict[str, Any], now: dict[str, Any], place: str) -> Iterator[str]:
    for key in before:
        if key in now:
            yield from differences(before[key], now[key], f"{place}.{key}".lstrip("."))
        else:
            yield f"{place}.{key}: {_short(before[key])} -> gone".lstrip(".")
    for key in now:
        if key not in before:
            yield f"{place}.{key}: new, {_short(now[key])}".lstrip(".")
    if before.keys() == now.keys() and list(before) != list(now):
        yield f"{place}: the order of the keys is another, {', '.join(now)}"


def _of_texts(before: list[str], now: list[str], place: str) -> Iterator[str]:
    matcher = difflib.SequenceMatcher(None, before, now, autojunk=False)
    for kind, start, end, first, last in matcher.get_opcodes():
        if kind == "equal":
            continue
        old, new = before[start:end], now[first:last]
        for index in range(max(len(old), len(new))):
            one = old[index] if index < len(old) else None
            other = new[index] if index < len(new) else None
            far = _how_far_lines(one, other)
            yield f"{place}, line {start + index + 1}: {_short(one)} -> {_short(other)}{far}"


def _is_text(value: Any) -> bool:
    return isinstance(value, list) and all(isinstance(one, str) for one in value)


def _how_far(before: Any, now: Any) -> str:
    """Return how far two numbers are from each other, nothing for anything else."""
    if not all(isinstance(one, int | float) and not isinstance(one, bool) for one in (before, now)):
        return ""
    return f" (relative difference {_apart(before, now):.2g})"


def _how_far_lines(before: str | None, now: str | None) -> str:
    """Return the largest relative difference of the numbers of two lines of the same words."""
    one, other = before or "", now or ""
    if _NUMBER.sub("", one) != _NUMBER.sub("", other):
        return ""
    pairs = zip(_NUMBER.findall(one), _NUMBER.findall(other), strict=True)
    apart = [_apart(float(a), float(b)) for a, b in pairs if a != b]
    return f" (relative difference up to {max(apart):.2g})" if apart else ""


def _apart(before: float, now: float) -> float:
    scale = max(abs(before), abs(now))
    return abs(now - before) / scale if scale else 0.0


def _short(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}..."
