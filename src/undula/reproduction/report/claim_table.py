"""Table of claims with their outcomes, in plain JSON types and for people."""

from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from undula.reproduction.claims.catalogue import Claim, Item
from undula.reproduction.claims.evaluate import Answers, Outcome, judge
from undula.reproduction.claims.stated_values import other_values, values_of
from undula.reproduction.tasks.task import ReproductionTask, Tasks

#: Verdicts of claims that could not be checked, and of claims that were not computed.
UNCHECKED, NOT_JUDGED = "not checked", "not judged here"


def row_of(
    name: str,
    item: Item,
    claim: Claim,
    answers: Answers,
    tasks: Tasks,
    *,
    quick: bool,
    wanted: bool,
) -> dict[str, Any] | None:
    """Return the row of a claim; None for a claim that was neither computed nor wanted.

    Parameters
    ----------
    name, item
        The item of the claim.
    claim
        The claim.
    answers
        Stored answers of the item's tasks.
    tasks
        All tasks, for the commands of the row.
    quick
        True for the quick report.
    wanted
        True if the user has selected the item; its row then exists even without a verdict.
    """
    places = {local: f"{name}/{local}" for local in item.tasks} | item.uses
    used = [local for local in places if local in claim.asks]
    own_tasks = {local: tasks.get(places[local]) for local in used}
    reason = _why_not(claim, own_tasks, answers, quick=quick)
    if reason:
        outcome = Outcome(None, None, None, reason)
        return _row(name, item, claim, outcome, NOT_JUDGED) if wanted else None
    outcome = judge(claim, answers)
    row = _row(name, item, claim, outcome, outcome.verdict or UNCHECKED)
    return row | {
        "as_expected": outcome.verdict == claim.expected,
        "command": f"undula reproduce {name}{' --quick' if quick else ''}",
        "steps": [tasks[places[local]].typed for local in used],
    }


def left_out(needed: Iterable[str], answered: Collection[str], *, quick: bool) -> str:
    """Return the reason for leaving out a claim or figure; empty if all its tasks are done.

    Parameters
    ----------
    needed
        Names of its tasks.
    answered
        Names of the tasks with an answer.
    quick
        True for the quick report.
    """
    lacking = [name for name in needed if name not in answered]
    if not lacking:
        return ""
    verb = "is not" if len(lacking) == 1 else "are not"
    report = "in the quick report" if quick else "yet"
    return f"{', '.join(lacking)} {verb} computed {report}"


def _why_not(
    claim: Claim,
    tasks: Mapping[str, ReproductionTask | None],
    answers: Answers,
    *,
    quick: bool,
) -> str:
    """Return the reason for not judging a claim from these tasks; empty if it is judged."""
    if quick and claim.only_full:
        return "the coarser grid of the quick report does not show it"
    missing = left_out(tasks, answers, quick=quick)
    if missing:
        return missing
    computed = {
        local: values_of(task.command)
        for local, task in tasks.items()
        if task is not None and claim.at and local in claim.judged_by
    }
    return other_values(claim.at, computed)


def _row(name: str, item: Item, claim: Claim, outcome: Outcome, verdict: str) -> dict[str, Any]:
    """Return the part of a row that does not depend on the computation."""
    return {
        "item": name,
        "title": item.title,
        "claim": claim.name,
        "says": claim.says,
        "where": claim.where,
        "at": claim.at,
        "published": claim.published if claim.over is None else claim.over,
        "over_a_range": claim.over is not None,
        "value": outcome.value,
        "error": outcome.error,
        "unit": claim.unit,
        "within": claim.within,
        "because": claim.because,
        "verdict": verdict,
        "reason": outcome.reason,
        "expected": claim.expected,
        "as_expected": None,
        "erratum": claim.erratum,
        "note": claim.note,
        "silent": claim.silent,
        "figure": claim.figure,
        "command": f"undula reproduce {name}",
        "steps": [],
    }


def tally(rows: Sequence[Mapping[str, Any]]) -> dict[str, int]:
    """Return the number of rows by verdict."""
    return dict(Counter(row["verdict"] for row in rows))


def rows_text(rows: Sequence[Mapping[str, Any]], page: Path) -> str:
    """Return the rows for a terminal.

    Parameters
    ----------
    rows
        Rows of `row_of`.
    page
        File of the report.
    """
    lines = []
    for row in rows:
        mark = "" if row["as_expected"] is not False else f"  << known to be {row['expected']}"
        lines.append(f"{row['item']}/{row['claim']}: {row['verdict']}{mark}")
        unit = f" {row['unit']}" if row["unit"] else ""
        value = number_text(row["value"], row["error"])
        here = "" if row["verdict"] == NOT_JUDGED else f", here {value}{unit}"
        lines.append(f"    paper {number_text(row['published'])}{unit}{here}")
        if row["reason"]:
            cure = f"; {row['command']}" if row["verdict"] == NOT_JUDGED else ""
            lines.append(f"    {row['reason']}{cure}")
    counted = ", ".join(f"{count} {verdict}" for verdict, count in tally(rows).items())
    return "\n".join([*lines, f"{len(rows)} claims: {counted or 'none'}", f"report: {page}"])


def number_text(value: Any, error: Any = None) -> str:
    """Return a value with the digits that its error leaves, and a pair as a range.

    Parameters
    ----------
    value
        A number, a word, a truth value or a list of numbers.
    error
        Error of the numbers, None if unknown.
    """
    if isinstance(value, list | tuple):
        errors = error if isinstance(error, list | tuple) else [error] * len(value)
        return (
            " to ".join(map(number_text, value, errors))
            if len(value) == 2
            else ", ".join(map(number_text, value, errors))
        )
    if isinstance(value, bool):
        return "holds" if value else "does not hold"
    if value is None:
        return "none"
    if isinstance(value, str):
        return value
    if error:
        from undula.terminal.numbers import with_error

        return with_error(value, error)
    return f"{value:.6g}"
