"""Output of commands: answers on standard output, everything else on standard error."""

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Any

from undula.errors import InputError
from undula.log import logger
from undula.terminal.streams import Guarded, err, out

_LOG = logger(__name__)

#: Exit status of every command.
DONE, BAD_INPUT, STOPPED_EARLY = 0, 2, 3
#: Exit status that shells report for programs ended by Ctrl-C; here without any result.
INTERRUPTED = 130

#: An answer in plain JSON types.
JsonAnswer = Mapping[str, Any]


@dataclass(frozen=True)
class Answer:
    """The answer of a command.

    Attributes
    ----------
    answer
        The answer in plain JSON types.
    text
        The same answer for people.
    """

    answer: dict[str, Any]
    text: str


class Form(Enum):
    """The form of an answer on standard output."""

    TEXT, JSON, CSV = "text", "JSON", "CSV"


def answer_form(*, as_json: bool, as_csv: bool) -> Form:
    """Return the form of an answer that two options ask for.

    Raises
    ------
    InputError
        Both are given.
    """
    if as_json and as_csv:
        raise InputError("--json and --csv are two forms of the answer; leave one of them out")
    return Form.JSON if as_json else Form.CSV if as_csv else Form.TEXT


def reply(answer: JsonAnswer, text: str, *, as_json: bool) -> None:
    """Write the answer of a command to standard output.

    Parameters
    ----------
    answer
        The answer in plain JSON types; numbers that are not finite become null.
    text
        The same answer for people.
    as_json
        If true, write exactly one JSON object, in ASCII for every locale; else the text.
    """
    _write(out(), json.dumps(finite(answer), indent=2, allow_nan=False) if as_json else text)


def notice(sentence: str) -> None:
    """Write a sentence that is not the answer to standard error, and log it."""
    _LOG.info("%s", sentence)
    _write(err(), f"undula: {sentence}")


def refuse(sentence: str, *, as_json: bool) -> int:
    """Report a mistake in the input in one sentence.

    Parameters
    ----------
    sentence
        The mistake and its cure.
    as_json
        If true, also write a JSON object to standard output.

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
    """Report that a command was ended without any result; return the exit status."""
    notice("interrupted before there was a result; nothing has been kept")
    return INTERRUPTED


def finite(value: Any) -> Any:
    """Return a JSON value with null in place of NaN and infinity."""
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
