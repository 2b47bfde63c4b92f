"""The answer of `undula step`: in plain JSON types, and for people as regimes along the way."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, fields
from typing import Any

from undula.analysis.observables.shapes import Range
from undula.analysis.parameters import FORCE
from undula.analysis.ramps.ramp import Step
from undula.analysis.ramps.regime_changes import (
    RegimeChange,
    hysteresis,
    nearest,
    regime_changes,
    regimes,
)
from undula.analysis.solvers.threshold_record import Threshold
from undula.app.commands.threshold import force_text, links_text, threshold_answer
from undula.models.units import Units
from undula.storage.ramp_file import Series
from undula.terminal.units_text import units_lines

Answer = Mapping[str, Any]

_ARRAYS = ("nodes", "shape_times", "shapes")


def step_answer(
    series: Series, steps: Sequence[Step], found: Sequence[Threshold] | None
) -> dict[str, Any]:
    """Return a series in plain JSON types.

    Parameters
    ----------
    series
        What makes the steps.
    steps
        All that there are.
    found
        The solved thresholds, None if there are none to tell of.
    """
    changes = regime_changes(steps)
    return {
        "parameter": series.course.parameter,
        "load": series.load,
        "units": series.model.units.names(),
        "steps": [_record(step) for step in steps],
        "missing": len(series.course.targets) - len(steps),
        "regimes": [asdict(one) for one in regimes(steps)],
        "changes": [asdict(one) for one in changes],
        "hysteresis": [asdict(one) for one in hysteresis(steps)],
        "thresholds": None
        if found is None
        else [_threshold(one, changes, series.model.units) for one in found],
    }


def step_text(series: Series, answer: Answer) -> str:
    """Return the regimes, what depends on the way, the thresholds and the files, one a line."""
    course, parameter, units = series.course, answer["parameter"], series.model.units
    back = " and back" if course.back else ""
    made = f"{len(answer['steps'])} of {len(course.targets)} steps, {answer['status']}"
    way = f"{parameter} from {course.values[0]:.6g} to {course.values[-1]:.6g}{back}"
    further = units.forces if answer["thresholds"] else ()
    head = [f"{answer['load']}: {way}, {made}", *units_lines(units.names(), further)]
    lines = list(_lines(answer, units))
    width = max(len(name) for name, _ in lines)
    return "\n".join([*head, *(f"  {name:<{width}}  {said}" for name, said in lines)])


def _record(step: Step) -> dict[str, Any]:
    record = {field.name: getattr(step, field.name) for field in fields(step)}
    ranges = {name: asdict(value) for name, value in record.items() if isinstance(value, Range)}
    kept = {name: value for name, value in record.items() if name not in _ARRAYS}
    return kept | ranges | {"cause": step.cause or None}


def _threshold(found: Threshold, changes: Sequence[RegimeChange], units: Units) -> dict[str, Any]:
    beside = None if found.value is None else nearest(changes, found.value)
    return {
        "threshold": found.kind,
        **threshold_answer(found, units),
        "nearest_change": None if beside is None else asdict(beside),
    }


def _lines(answer: Answer, units: Units) -> Iterator[tuple[str, str]]:
    unit = f" {units.force}" if answer["parameter"] == FORCE else ""
    direction = ""
    for one in answer["regimes"]:
        count = f"{one['steps']} step{'' if one['steps'] == 1 else 's'}"
        name = one["direction"] if one["direction"] != direction else ""
        yield name, f"{_span(one['start'], one['end'])}{unit}: {one['verdict']}, {count}"
        direction = one["direction"]
    if len({one["direction"] for one in answer["regimes"]}) > 1 and not answer["hysteresis"]:
        yield "hysteresis", "none: up and down agree at every value"
    for place, one in enumerate(answer["hysteresis"]):
        said = f"{_span(one['low'], one['high'])}{unit}: {one['up']} on the way up, {one['down']}"
        yield "" if place else "hysteresis", f"{said} on the way down"
    for one in answer["thresholds"] or ():
        yield one["threshold"], _beside(one, units)
    yield "steps", answer["store"] or "none"
    yield "figure", answer["figure"] or "none"


def _span(start: float, end: float) -> str:
    return f"{start:.6g}" if start == end else f"{start:.6g} to {end:.6g}"


def _beside(found: Answer, units: Units) -> str:
    if found["value"] is None:
        return f"none: {found['reason']}"
    said = f"{force_text(found, units)} ({found['bifurcation']}){links_text(found)}"
    change = found["nearest_change"]
    if change is None:
        return f"{said}; no change of regime to compare with"
    return (
        f"{said}; nearest change {change['direction']}: {change['before']} at"
        f" {change['start']:.6g}, {change['after']} at {change['end']:.6g}"
    )
