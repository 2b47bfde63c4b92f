"""Evaluation of claims: value, error and verdict of each claim from answers of commands."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from undula.errors import InputError
from undula.reproduction.claims import answer_measures, errata, measures, sweep_measures
from undula.reproduction.claims.catalogue import (
    CONFIRMED,
    CORRECTED,
    NOT_REPRODUCIBLE,
    WITHIN_RANGE,
    Claim,
)

_MODULES = (measures, answer_measures, sweep_measures, errata)
#: Names for expressions, in addition to the answers.
_WORDS: Mapping[str, Any] = {
    **{name: getattr(module, name) for module in _MODULES for name in module.__all__},
    **{word.__name__: word for word in (abs, all, any, float, len, max, min, round, sorted, sum)},
    "log": np.log,
    "pi": np.pi,
    "sqrt": np.sqrt,
}


class AnswerRows:
    """List of records in an answer, such as the points of a branch, as one array for each key."""

    def __init__(self, rows: Sequence[Mapping[str, Any]]) -> None:
        self._rows = rows

    def __len__(self) -> int:
        """Return the number of rows."""
        return len(self._rows)

    def __getitem__(self, key: str | int) -> Any:
        """Return the values of a key, of a nested key such as `energy/max`, or one row."""
        if isinstance(key, int):
            return _opened(self._rows[key])
        path = key.split("/")
        values = [_nested(row, path) for row in self._rows]
        if all(isinstance(value, str) for value in values):
            return np.array(values, dtype=object)
        return np.array([np.nan if value is None else value for value in values], dtype=float)

    def __getattr__(self, key: str) -> Any:
        """Return the values of a key."""
        if key.startswith("__"):
            raise AttributeError(key)
        return self[key]


class ClaimAnswer(Mapping[str, Any]):
    """The JSON answer of a command, with its keys as attributes.

    Parameters
    ----------
    answer
        The answer in plain JSON types.
    folder
        Folder of the files of the command; None without files.
    """

    def __init__(self, answer: Mapping[str, Any], folder: Path | None = None) -> None:
        self._answer = answer
        self.folder = folder

    def __getitem__(self, key: str) -> Any:
        """Return the value of a key."""
        return _opened(self._answer[key])

    def __iter__(self) -> Any:
        """Iterate over the keys."""
        return iter(self._answer)

    def __len__(self) -> int:
        """Return the number of keys."""
        return len(self._answer)

    def __getattr__(self, key: str) -> Any:
        """Return the value of a key."""
        try:
            return self[key]
        except KeyError:
            raise AttributeError(f"the answer has no {key}") from None


#: Answers of tasks by name.
Answers = Mapping[str, ClaimAnswer]


@dataclass(frozen=True)
class Outcome:
    """Outcome of the check of a claim.

    Attributes
    ----------
    value, error
        A number, a word, a truth value or a list of numbers; errors are those of numbers, None if
        unknown.
    verdict
        Verdict in words; None if the claim could not be checked.
    reason
        Cause of a missing verdict, else empty.
    """

    value: Any
    error: Any
    verdict: str | None
    reason: str = ""


def judge(claim: Claim, answers: Answers) -> Outcome:
    """Check a claim against the answers of the tasks that it names.

    Parameters
    ----------
    claim
        The claim.
    answers
        Answers of tasks by name, at least those that the claim uses.

    Returns
    -------
    Outcome
        A claim whose expression fails, as without a state, has a reason in place of a verdict.

    Raises
    ------
    InputError
        An expression is not Python, or uses an unknown name.
    """
    try:
        value = _plain(_evaluate(claim, claim.value, answers))
        error = None if claim.error is None else _plain(_evaluate(claim, claim.error, answers))
        other = None
        if claim.agrees_with is not None:
            other = _plain(_evaluate(claim, claim.agrees_with, answers))
    except InputError:
        raise
    except (AttributeError, IndexError, KeyError, TypeError, ValueError) as trouble:
        return Outcome(None, None, None, f"{type(trouble).__name__}: {trouble}")
    if value is None or (isinstance(value, float) and not np.isfinite(value)):
        return Outcome(value, error, None, "there is no such value")
    if other is not None and not _close(value, other, claim.agrees_within):
        reason = f"another way gives {other}, which differs by more than {claim.agrees_within:g}"
        return Outcome(value, error, None, reason)
    return Outcome(value, error, _verdict(claim, value))


def _verdict(claim: Claim, value: Any) -> str:
    if claim.over is not None:
        low, high = claim.over
        if value[0] <= low + claim.within and value[1] >= high - claim.within:
            return CONFIRMED
        holds_on_a_part = min(value[1], high) > max(value[0], low)
        if holds_on_a_part:
            return WITHIN_RANGE
    elif _close(value, claim.published, claim.within):
        return CONFIRMED
    return NOT_REPRODUCIBLE if claim.silent else CORRECTED


def _close(value: Any, published: Any, within: float) -> bool:
    if isinstance(published, str | bool) or isinstance(value, str | bool):
        return bool(value == published)
    computed, stated = np.atleast_1d(value).astype(float), np.atleast_1d(published).astype(float)
    return computed.shape == stated.shape and bool((np.abs(computed - stated) <= within).all())


def _evaluate(claim: Claim, text: str, answers: Answers) -> Any:
    # A catalogue is trusted like code. Built-in names are left out to detect typing errors, which
    # does not make untrusted files safe.
    try:
        return eval(text.strip(), {"__builtins__": {}, **_WORDS, **answers})
    except (NameError, SyntaxError) as error:
        raise InputError(f"claim {claim.name}: {text!r} cannot be computed: {error}") from error


def _opened(value: Any) -> Any:
    if isinstance(value, Mapping):
        return ClaimAnswer(value)
    if isinstance(value, list) and value and all(isinstance(entry, Mapping) for entry in value):
        return AnswerRows(value)
    return value


def _nested(row: Any, path: Sequence[str]) -> Any:
    """Return the value of a nested key; None if an outer key has no value."""
    for key in path:
        row = None if row is None else row[key]
    return row


def _plain(value: Any) -> Any:
    """Return a value in plain JSON types."""
    if isinstance(value, np.ndarray):
        return [_plain(entry) for entry in value.tolist()]
    if isinstance(value, tuple | list):
        return [_plain(entry) for entry in value]
    if isinstance(value, np.generic):
        return _plain(value.item())
    if isinstance(value, int) and not isinstance(value, bool):
        return float(value)
    return value
