"""Statements held against what was computed: value, error and verdict of each claim."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from undula.errors import InputError
from undula.reproduction.claims import errata as slips
from undula.reproduction.claims import measures
from undula.reproduction.claims import sweep_measures as study_measures
from undula.reproduction.claims.catalogue import (
    CONFIRMED,
    CORRECTED,
    NOT_REPRODUCIBLE,
    WITHIN_RANGE,
    Claim,
)

_ROOMS = (measures, study_measures, slips)
#: What expressions may use besides the answers.
_WORDS: Mapping[str, Any] = {
    **{name: getattr(room, name) for room in _ROOMS for name in room.__all__},
    **{word.__name__: word for word in (abs, all, any, float, len, max, min, round, sorted, sum)},
    "log": np.log,
    "pi": np.pi,
    "sqrt": np.sqrt,
}


class Rows:
    """Rows of an answer, such as the points of a branch: one array for each key."""

    def __init__(self, rows: Sequence[Mapping[str, Any]]) -> None:
        self._rows = rows

    def __len__(self) -> int:
        """Return the number of rows."""
        return len(self._rows)

    def __getitem__(self, key: str | int) -> Any:
        """Return the values of a key, one deeper down as `energy/max`, or the row of a number."""
        if isinstance(key, int):
            return _opened(self._rows[key])
        path = key.split("/")
        values = [_at(row, path) for row in self._rows]
        if all(isinstance(value, str) for value in values):
            return np.array(values, dtype=object)
        return np.array([np.nan if value is None else value for value in values], dtype=float)

    def __getattr__(self, key: str) -> Any:
        """Return the values of a key."""
        if key.startswith("__"):
            raise AttributeError(key)
        return self[key]


class Answer(Mapping[str, Any]):
    """The JSON answer of a command, with its keys as attributes, and the folder of its files."""

    def __init__(self, answer: Mapping[str, Any], folder: Path | None = None) -> None:
        self._answer = answer
        self.folder = folder

    def __getitem__(self, key: str) -> Any:
        """Return the value of a key."""
        return _opened(self._answer[key])

    def __iter__(self) -> Any:
        """Go through the keys."""
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


@dataclass(frozen=True)
class Outcome:
    """What a claim came to.

    Attributes
    ----------
    value, error
        A number, a word, a truth value, or a list of numbers; with the error of numbers if it is
        known.
    verdict
        In words; None if the claim could not be checked.
    reason
        Why it could not; empty otherwise.
    """

    value: Any
    error: Any
    verdict: str | None
    reason: str = ""


def judge(claim: Claim, answers: Mapping[str, Answer]) -> Outcome:
    """Check a claim against the answers of the tasks that it names.

    Parameters
    ----------
    claim
        The statement.
    answers
        By name, at least those that it asks for.

    Returns
    -------
    Outcome
        A claim whose expression fails, as when a state was not found, has no verdict but a reason.

    Raises
    ------
    InputError
        An expression is not Python, or uses a word that is not known.
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
    ours, theirs = np.atleast_1d(value).astype(float), np.atleast_1d(published).astype(float)
    return ours.shape == theirs.shape and bool((np.abs(ours - theirs) <= within).all())


def _evaluate(claim: Claim, text: str, answers: Mapping[str, Answer]) -> Any:
    # A catalogue is trusted like code. That built-in words are missing here catches slips of the
    # pen; it does not make a stranger's file safe.
    try:
        return eval(text.strip(), {"__builtins__": {}, **_WORDS, **answers})
    except (NameError, SyntaxError) as error:
        raise InputError(f"claim {claim.name}: {text!r} cannot be computed: {error}") from error


def _opened(value: Any) -> Any:
    if isinstance(value, Mapping):
        return Answer(value)
    if isinstance(value, list) and value and all(isinstance(one, Mapping) for one in value):
        return Rows(value)
    return value


def _at(row: Any, path: Sequence[str]) -> Any:
    for key in path:
        row = None if row is None else row[key]
    return row


def _plain(value: Any) -> Any:
    """Return a value in plain JSON types."""
    if isinstance(value, np.ndarray):
        return [_plain(one) for one in value.tolist()]
    if isinstance(value, tuple | list):
        return [_plain(one) for one in value]
    if isinstance(value, np.generic):
        return _plain(value.item())
    if isinstance(value, int) and not isinstance(value, bool):
        return float(value)
    return value
