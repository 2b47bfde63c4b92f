"""What a command says: its answer on standard output, everything else on standard error."""

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from undula.terminal.streams import Guarded, err, out

#: Exit status of every command.
DONE, BAD_INPUT, STOPPED_EARLY = 0, 2, 3
#: What a shell reports for a program ended by Ctrl-C; here: before there was any result.
INTERRUPTED = 130

JsonAnswer = Mapping[str, Any]


@dataclass(frozen=True)
class Answer:
    """An answer in plain JSON types, and the same for people."""

    answer: dict[str, Any]
    text: str


def reply(answer: JsonAnswer, text: str, *, as_json: bool) -> None:
    """Give the answer of a command.

    Parameters
    ----------
    answer
        The answer in plain JSON types; numbers that are not finite become null.
    text
        The same answer for people.
    as_json
        Which of the two to give: the first as exactly one JSON object, in ASCII whatever the
        locale.
    """
    _write(out(), json.dumps(finite(answer), indent=2, allow_nan=False) if as_json else text)


def notice(sentence: str) -> None:
    """Tell something that is not the answer, on standard error."""
    _write(err(), f"undula: {sentence}")


def refuse(sentence: str, *, as_json: bool) -> int:
    """Tell what is wrong with the input, in one sentence.

    Parameters
    ----------
    sentence
        What is wrong and what would be right.
    as_json
        Whether to answer with a JSON object on standard output as well.

    Returns
    -------
    int
        The exit status.
    """
    sentence = " ".join(sentence.split())
    if as_json:
        reply({"status": "bad input", "error": sentence}, "", as_json=True)
    notice(sentence)
    return BAD_INPUT


def interrupted() -> int:
    """Tell that a command was ended before there was anything to keep; return the exit status."""
    notice("interrupted before there was a result; nothing has been kept")
    return INTERRUPTED


def finite(value: Any) -> Any:
    """Return a JSON value with null in place of every number that JSON cannot hold."""
    if isinstance(value, Mapping):
        return {str(key): finite(part) for key, part in value.items()}
    if isinstance(value, list | tuple):
        return [finite(part) for part in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def _write(stream: Guarded, text: str) -> None:
    stream.write(f"{text}\n")
    stream.flush()
