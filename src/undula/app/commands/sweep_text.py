"""State of a stored sweep, in plain JSON types and for people."""

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from undula.inputs.units_table import scales_of
from undula.models.scales import Scales
from undula.schema.sweep_axes import DONE, FAILED
from undula.sweeps.sweep import Sweep, sweep_from_dump
from undula.terminal.physical import of_parameter, scales_lines, with_physical

#: Number of failures that are listed one by one.
MOST_FAILURES = 5


def sweep_answer(stored: xr.Dataset) -> dict[str, Any]:
    """Return the state of a stored sweep in plain JSON types.

    Parameters
    ----------
    stored
        The sweep, as `undula.sweeps.store.load_sweep` opens it.
    """
    sweep = sweep_from_dump(json.loads(stored.attrs["study"]))
    status = stored["status"].values.ravel()
    done, failed = int((status == DONE).sum()), int((status == FAILED).sum())
    words, counts = np.unique(stored["verdict"].values.ravel()[status == DONE], return_counts=True)
    by_number = sorted(zip(counts.tolist(), words.tolist(), strict=True), reverse=True)
    answer = {
        "status": "done" if done + failed == sweep.count else "unfinished",
        "load": stored.attrs["load"],
        "units": json.loads(stored.attrs["units"]),
        "label": sweep.label,
        "policy": sweep.policy,
        "keep": sweep.keep,
        "axes": [_axis(axis.key, axis.values) for axis in sweep.axes],
        "tries": sweep.shape[-1],
        "points": {
            "all": sweep.count,
            "done": done,
            "failed": failed,
            "to_go": sweep.count - done - failed,
        },
        "verdicts": {word: count for count, word in by_number},
        "failures": _failures(stored, sweep, np.flatnonzero(status == FAILED)[:MOST_FAILURES]),
    }
    return with_physical(answer, "sweep", scales_of(sweep.shared))


def sweep_text(answer: Mapping[str, Any], scales: Scales | None = None) -> str:
    """Return the state of a stored sweep for people, one fact in each line.

    Parameters
    ----------
    answer
        The state as `sweep_answer` returns it, with the key "store".
    scales
        SI values of the dimensionless units; None for a text without physical units.
    """
    counts = answer["points"]
    lines = [("axis", _axis_text(axis, scales)) for axis in answer["axes"]]
    if answer["tries"] > 1:
        lines.append(("tries", str(answer["tries"])))
    lines.append(("points", f"{counts['done']} of {counts['all']} done"))
    if counts["failed"] or counts["to_go"]:
        lines.append(("", f"{counts['failed']} failed, {counts['to_go']} to go"))
    lines += [("verdicts" if k == 0 else "", line) for k, line in enumerate(_verdicts(answer))]
    lines += [("failures" if k == 0 else "", line) for k, line in enumerate(_failure_lines(answer))]
    lines.append(("store", answer["store"]))
    head = [f"{answer['load']}: {answer['status']}", *scales_lines(scales)]
    return "\n".join([*head, *(f"  {name:<8}  {text}" for name, text in lines)])


def _axis(key: str, values: tuple[int | float, ...]) -> dict[str, Any]:
    return {"key": key, "count": len(values), "first": values[0], "last": values[-1]}


def _failures(stored: xr.Dataset, sweep: Sweep, numbers: Any) -> list[dict[str, Any]]:
    """Return place and reason of failed points."""
    failures = []
    for number in numbers.tolist():
        place = sweep.place(number)
        values = {
            axis.key: axis.values[index] for axis, index in zip(sweep.axes, place, strict=False)
        }
        reason = str(stored["reason"][place].values)
        failures.append({**values, "try": place[-1], "reason": reason})
    return failures


def _axis_text(axis: Mapping[str, Any], scales: Scales | None) -> str:
    values = "1 value" if axis["count"] == 1 else f"{axis['count']} values"
    physical = of_parameter(scales, axis["key"], axis["first"], axis["last"])
    return f"{axis['key']} from {axis['first']:.6g} to {axis['last']:.6g}{physical}, {values}"


def _verdicts(answer: Mapping[str, Any]) -> list[str]:
    return [f"{count} {word}" for word, count in answer["verdicts"].items()]


def _failure_lines(answer: Mapping[str, Any]) -> list[str]:
    """Return the failures, one in each line."""
    lines = []
    for failure in answer["failures"]:
        values = {key: value for key, value in failure.items() if key not in ("try", "reason")}
        place = ", ".join(f"{key} = {value:.6g}" for key, value in values.items())
        replicate = f", try {failure['try']}" if answer["tries"] > 1 else ""
        lines.append(f"{place}{replicate}: {failure['reason']}")
    more = answer["points"]["failed"] - len(lines)
    return [*lines, f"and {more} more"] if more > 0 else lines
