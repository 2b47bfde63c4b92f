"""What is left of an answer when all that differs from call to call is taken out of it."""

import re
import tomllib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
_PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
#: The command's name. In answers a word stands in its place, for pins to outlast another name.
NAME = next(iter(_PROJECT["scripts"]))
_NAME = re.compile(rf"(?<![A-Za-z]){re.escape(NAME)}(?![A-Za-z])")
_STANDS_FOR_NAME = "(name)"
#: Wall times, versions, and digests that versions are a part of.
_DROPPED = frozenset({"seconds", "versions", "software", "sha256"})
_DURATION = re.compile(r"after [\d.e+]+ (s|min|h|days)\b")
#: As the report has it behind each of its commands.
_COST = re.compile(r"# [\d.]+ s$", re.MULTILINE)
_VERSION = re.compile(rf"(?<={re.escape(_STANDS_FOR_NAME)}) \d+(\.\d+)+")
#: Notices that come only the first time, or hold an address.
_PASSING = ("compiling", "dashboard")


def steady(text: str) -> str:
    """Return a text without wall times and without the name of the command."""
    without = _COST.sub("# (time)", _DURATION.sub("after (time)", text))
    return _VERSION.sub(" (version)", _NAME.sub(_STANDS_FOR_NAME, without))


def steady_value(value: Any) -> Any:
    """Return a JSON value without what `steady` takes out, and without what differs by its key."""
    if isinstance(value, dict):
        kept = {key: part for key, part in value.items() if key not in _DROPPED | {NAME}}
        return {steady(key): steady_value(part) for key, part in kept.items()}
    if isinstance(value, list | tuple):
        return [steady_value(part) for part in value if not _is_dropped_pair(part)]
    return steady(value) if isinstance(value, str) else value


def steady_lines(text: str) -> list[str]:
    """Return the lines of an answer for people."""
    return steady(text).splitlines()


def messages(text: str) -> list[str]:
    """Return the lines on standard error that are no progress."""
    return [steady(line) for line in text.splitlines() if _stays(line)]


def _stays(line: str) -> bool:
    ours = line.startswith(f"{NAME}: ") or "Error" in line or "Warning" in line
    return ours and not any(word in line for word in _PASSING)


def _is_dropped_pair(part: Any) -> bool:
    """Tell whether part of a list is a name with its value, of a name that is dropped."""
    return isinstance(part, list | tuple) and len(part) == 2 and _in(part[0], _DROPPED)


def _in(value: Any, names: Iterable[str]) -> bool:
    return isinstance(value, str) and value in names
