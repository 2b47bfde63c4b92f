"""Claims with what they came to: the rows of the table, in plain JSON types and for people."""

from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from undula.reproduction.claims.catalogue import Claim, Item
from undula.reproduction.claims.evaluate import Answer, Outcome, judge
from undula.reproduction.claims.stated_values import other_values, values_of
from undula.reproduction.tasks.task import Job

#: What stands for a verdict where a claim could not be checked, and where it was not computed.
UNCHECKED, NOT_JUDGED = "not checked", "not judged here"


def row_of(
    name: str,
    item: Item,
    claim: Claim,
    answers: Mapping[str, Answer],
    jobs: Mapping[str, Job],
    *,
    quick: bool,
    wanted: bool,
) -> dict[str, Any] | None:
    """Return the row of a claim; None if what it needs has not been computed nor asked for.

    Parameters
    ----------
    name, item
        The item that it belongs to.
    claim
        The statement.
    answers
        Those of the item that are there.
    jobs
        All jobs, for the commands behind the value.
    quick
        Whether the report is the quick one.
    wanted
        Whether the item has been asked for: then a claim that cannot be judged is told as well.
    """
    places = {local: f"{name}/{local}" for local in item.tasks} | item.uses
    asked = [local for local in places if local in claim.asks]
    why = _why_not(claim, {local: jobs.get(places[local]) for local in asked}, answers, quick=quick)
    if why:
        return (
            _row(name, item, claim, Outcome(None, None, None, why), NOT_JUDGED) if wanted else None
        )
    outcome = judge(claim, answers)
    row = _row(name, item, claim, outcome, outcome.verdict or UNCHECKED)
    return row | {
        "as_expected": outcome.verdict == claim.expected,
        "command": f"undula reproduce {name}{' --quick' if quick else ''}",
        "steps": [jobs[places[local]].told for local in asked],
    }


def left_out(asked: Iterable[str], known: Collection[str], *, quick: bool) -> str:
    """Return why something is not there that needs tasks; empty if all of them are done.

    Parameters
    ----------
    asked
        Names of the tasks.
    known
        Names of those whose answers are there.
    quick
        Whether the report is the quick one.
    """
    lacking = [name for name in asked if name not in known]
    if not lacking:
        return ""
    does = "is not" if len(lacking) == 1 else "are not"
    report = "in the quick report" if quick else "yet"
    return f"{', '.join(lacking)} {does} computed {report}"


def _why_not(
    claim: Claim, jobs: Mapping[str, Job | None], answers: Mapping[str, Answer], *, quick: bool
) -> str:
    """Return why a claim is not to be judged from these jobs; empty if it is."""
    if quick and claim.only_full:
        return "the coarser grid of the quick report does not show it"
    missing = left_out(jobs, answers, quick=quick)
    if missing:
        return missing
    computed = {
        local: values_of(job.command)
        for local, job in jobs.items()
        if job is not None and claim.at and local in claim.judged_by
    }
    return other_values(claim.at, computed)


def _row(name: str, item: Item, claim: Claim, outcome: Outcome, verdict: str) -> dict[str, Any]:
    """Return the row of a claim as far as it does not depend on how it was computed."""
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
    """Return how often each verdict occurs."""
    return dict(Counter(row["verdict"] for row in rows))


def rows_text(rows: Sequence[Mapping[str, Any]], page: Path) -> str:
    """Return the rows for a terminal."""
    lines = []
    for row in rows:
        mark = "" if row["as_expected"] is not False else f"  << known to be {row['expected']}"
        lines.append(f"{row['item']}/{row['claim']}: {row['verdict']}{mark}")
        unit = f" {row['unit']}" if row["unit"] else ""
        ours = number_text(row["value"], row["error"])
        here = "" if row["verdict"] == NOT_JUDGED else f", here {ours}{unit}"
        lines.append(f"    paper {number_text(row['published'])}{unit}{here}")
        if row["reason"]:
            cure = f"; {row['command']}" if row["verdict"] == NOT_JUDGED else ""
            lines.append(f"    {row['reason']}{cure}")
    counted = ", ".join(f"{count} {verdict}" for verdict, count in tally(rows).items())
    return "\n".join([*lines, f"{len(rows)} claims: {counted or 'none'}", f"report: {page}"])


def number_text(value: Any, error: Any = None) -> str:
    """Write a value with as many digits as its error leaves, lists as ranges."""
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
