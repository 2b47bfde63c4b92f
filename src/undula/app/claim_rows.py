"""Claims with what they came to: the rows of the table, in plain JSON types and for people."""

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from undula.app.catalogue_tasks import Job
from undula.studies.claims import Answer, judge
from undula.studies.items import Claim, Item

#: What stands for a verdict where a claim could not be checked.
UNCHECKED = "not checked"


def row_of(
    name: str,
    item: Item,
    claim: Claim,
    answers: Mapping[str, Answer],
    jobs: Mapping[str, Job],
    *,
    quick: bool,
) -> dict[str, Any] | None:
    """Return the row of a claim; None if what it needs has not been computed, or only in full.

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
    """
    if quick and claim.only_full:
        return None
    asked = [local for local in (*item.tasks, *item.uses) if local in claim.asks]
    if any(local not in answers for local in asked):
        return None
    outcome = judge(claim, answers)
    places = {local: f"{name}/{local}" for local in item.tasks} | item.uses
    return {
        "item": name,
        "title": item.title,
        "claim": claim.name,
        "says": claim.says,
        "where": claim.where,
        "published": claim.published if claim.over is None else claim.over,
        "over_a_range": claim.over is not None,
        "value": outcome.value,
        "error": outcome.error,
        "unit": claim.unit,
        "within": claim.within,
        "because": claim.because,
        "verdict": outcome.verdict or UNCHECKED,
        "reason": outcome.reason,
        "expected": claim.expected,
        "as_expected": outcome.verdict == claim.expected,
        "erratum": claim.erratum,
        "note": claim.note,
        "silent": claim.silent,
        "figure": claim.figure,
        "command": f"undula reproduce {name}{' --quick' if quick else ''}",
        "steps": [jobs[places[local]].told for local in asked],
    }


def tally(rows: Sequence[Mapping[str, Any]]) -> dict[str, int]:
    """Return how often each verdict occurs."""
    return dict(Counter(row["verdict"] for row in rows))


def rows_text(rows: Sequence[Mapping[str, Any]], page: Path) -> str:
    """Return the rows for a terminal."""
    lines = []
    for row in rows:
        mark = "" if row["as_expected"] else f"  << known to be {row['expected']}"
        lines.append(f"{row['item']}/{row['claim']}: {row['verdict']}{mark}")
        unit = f" {row['unit']}" if row["unit"] else ""
        ours = number_text(row["value"], row["error"])
        lines.append(f"    paper {number_text(row['published'])}{unit}, here {ours}{unit}")
        if row["reason"]:
            lines.append(f"    {row['reason']}")
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
        from undula.app.run_text import with_error

        return with_error(value, error)
    return f"{value:.6g}"
