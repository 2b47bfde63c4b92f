"""How far a study is, in plain JSON types and for people."""

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from undula.schema.sweep_axes import DONE, FAILED
from undula.sweeps.sweep import Study, of_dump

#: Failures that are told one by one.
MOST_FAILURES = 5


def study_answer(stored: xr.Dataset) -> dict[str, Any]:
    """Return how far a stored study is.

    Parameters
    ----------
    stored
        As `undula.sweeps.store.load_sweep` opens it.
    """
    study = of_dump(json.loads(stored.attrs["study"]))
    status = stored["status"].values.ravel()
    done, failed = int((status == DONE).sum()), int((status == FAILED).sum())
    words, counts = np.unique(stored["verdict"].values.ravel()[status == DONE], return_counts=True)
    by_number = sorted(zip(counts.tolist(), words.tolist(), strict=True), reverse=True)
    return {
        "status": "done" if done + failed == study.count else "unfinished",
        "load": stored.attrs["load"],
        "units": json.loads(stored.attrs["units"]),
        "label": study.label,
        "policy": study.policy,
        "keep": study.keep,
        "axes": [_axis(axis.key, axis.values) for axis in study.axes],
        "tries": study.shape[-1],
        "points": {
            "all": study.count,
            "done": done,
            "failed": failed,
            "to_go": study.count - done - failed,
        },
        "verdicts": {word: count for count, word in by_number},
        "failures": _failures(stored, study, np.flatnonzero(status == FAILED)[:MOST_FAILURES]),
    }


def study_text(answer: Mapping[str, Any]) -> str:
    """Return the same for people, one thing a line."""
    counts = answer["points"]
    lines = [("axis", _axis_text(axis)) for axis in answer["axes"]]
    if answer["tries"] > 1:
        lines.append(("tries", str(answer["tries"])))
    lines.append(("points", f"{counts['done']} of {counts['all']} done"))
    if counts["failed"] or counts["to_go"]:
        lines.append(("", f"{counts['failed']} failed, {counts['to_go']} to go"))
    lines += [("verdicts" if k == 0 else "", told) for k, told in enumerate(_verdicts(answer))]
    lines += [("failures" if k == 0 else "", told) for k, told in enumerate(_told(answer))]
    lines.append(("store", answer["store"]))
    head = f"{answer['load']}: {answer['status']}"
    return "\n".join([head, *(f"  {name:<8}  {said}" for name, said in lines)])


def _axis(key: str, values: tuple[int | float, ...]) -> dict[str, Any]:
    return {"key": key, "count": len(values), "first": values[0], "last": values[-1]}


def _failures(stored: xr.Dataset, study: Study, numbers: Any) -> list[dict[str, Any]]:
    """Return where points have failed and why."""
    found = []
    for number in numbers.tolist():
        place = study.place(number)
        where = {a.key: a.values[at] for a, at in zip(study.axes, place, strict=False)}
        reason = str(stored["reason"][place].values)
        found.append({**where, "try": place[-1], "reason": reason})
    return found


def _axis_text(axis: Mapping[str, Any]) -> str:
    values = "1 value" if axis["count"] == 1 else f"{axis['count']} values"
    return f"{axis['key']} from {axis['first']:.6g} to {axis['last']:.6g}, {values}"


def _verdicts(answer: Mapping[str, Any]) -> list[str]:
    return [f"{count} {word}" for word, count in answer["verdicts"].items()]


def _told(answer: Mapping[str, Any]) -> list[str]:
    """Return the failures, one a line."""
    told = []
    for failure in answer["failures"]:
        place = {key: value for key, value in failure.items() if key not in ("try", "reason")}
        where = ", ".join(f"{key} = {value:.6g}" for key, value in place.items())
        which = f", try {failure['try']}" if answer["tries"] > 1 else ""
        told.append(f"{where}{which}: {failure['reason']}")
    more = answer["points"]["failed"] - len(told)
    return [*told, f"and {more} more"] if more > 0 else told
