"""Answer of `undula step`: in plain JSON types, and for people as regimes along the ramp."""

from collections.abc import Iterator, Sequence
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
from undula.models.scales import Scales
from undula.models.units import Units
from undula.storage.ramp_file import Series
from undula.terminal.output import JsonAnswer
from undula.terminal.physical import of_parameter, scales_lines
from undula.terminal.units_text import units_lines

_ARRAYS = ("nodes", "shape_times", "shapes")


def step_answer(
    series: Series, steps: Sequence[Step], thresholds: Sequence[Threshold] | None
) -> dict[str, Any]:
    """Return the answer in plain JSON types.

    Parameters
    ----------
    series
        The ramp.
    steps
        The steps so far.
    thresholds
        Solved thresholds of the force, or None.
    """
    changes = regime_changes(steps)
    return {
        "parameter": series.ramp.parameter,
        "load": series.load,
        "units": series.model.units.names(),
        "steps": [_record(step) for step in steps],
        "missing": len(series.ramp.targets) - len(steps),
        "regimes": [asdict(regime) for regime in regimes(steps)],
        "changes": [asdict(change) for change in changes],
        "hysteresis": [asdict(interval) for interval in hysteresis(steps)],
        "thresholds": None
        if thresholds is None
        else [_threshold(threshold, changes, series.model.units) for threshold in thresholds],
    }


def step_text(series: Series, answer: JsonAnswer) -> str:
    """Return regimes, hysteresis, thresholds and files, one in each line."""
    course, parameter, units = series.ramp, answer["parameter"], series.model.units
    scales = series.scales
    back = " and back" if course.back else ""
    count = f"{len(answer['steps'])} of {len(course.targets)} steps, {answer['status']}"
    ends = course.values[0], course.values[-1]
    interval = f"{parameter} from {ends[0]:.6g} to {ends[1]:.6g}{back}"
    further = units.forces if answer["thresholds"] else ()
    heading = f"{answer['load']}: {interval}{of_parameter(scales, parameter, *ends)}, {count}"
    head = [heading, *units_lines(units.names(), further), *scales_lines(scales)]
    lines = list(_lines(answer, units, scales))
    width = max(len(name) for name, _ in lines)
    return "\n".join([*head, *(f"  {name:<{width}}  {text}" for name, text in lines)])


def _record(step: Step) -> dict[str, Any]:
    record = {field.name: getattr(step, field.name) for field in fields(step)}
    ranges = {name: asdict(value) for name, value in record.items() if isinstance(value, Range)}
    kept = {name: value for name, value in record.items() if name not in _ARRAYS}
    return kept | ranges | {"cause": step.cause or None}


def _threshold(
    threshold: Threshold, changes: Sequence[RegimeChange], units: Units
) -> dict[str, Any]:
    change = None if threshold.value is None else nearest(changes, threshold.value)
    return {
        "threshold": threshold.kind,
        **threshold_answer(threshold, units),
        "nearest_change": None if change is None else asdict(change),
    }


def _lines(answer: JsonAnswer, units: Units, scales: Scales | None) -> Iterator[tuple[str, str]]:
    parameter = answer["parameter"]
    unit = f" {units.force}" if parameter == FORCE else ""
    direction = ""
    for regime in answer["regimes"]:
        count = f"{regime['steps']} step{'' if regime['steps'] == 1 else 's'}"
        name = regime["direction"] if regime["direction"] != direction else ""
        ends = regime["start"], regime["end"]
        interval = f"{_span(*ends)}{unit}{of_parameter(scales, parameter, *ends)}"
        yield name, f"{interval}: {regime['verdict']}, {count}"
        direction = regime["direction"]
    directions = {regime["direction"] for regime in answer["regimes"]}
    if len(directions) > 1 and not answer["hysteresis"]:
        yield "hysteresis", "none: up and down agree at every value"
    for place, loop in enumerate(answer["hysteresis"]):
        ends = loop["low"], loop["high"]
        interval = f"{_span(*ends)}{unit}{of_parameter(scales, parameter, *ends)}"
        text = f"{interval}: {loop['up']} on the way up, {loop['down']} on the way down"
        yield "" if place else "hysteresis", text
    for threshold in answer["thresholds"] or ():
        yield threshold["threshold"], _threshold_text(threshold, units, scales)
    yield "steps", answer["store"] or "none"
    yield "figure", answer["figure"] or "none"


def _span(start: float, end: float) -> str:
    return f"{start:.6g}" if start == end else f"{start:.6g} to {end:.6g}"


def _threshold_text(threshold: JsonAnswer, units: Units, scales: Scales | None) -> str:
    if threshold["value"] is None:
        return f"none: {threshold['reason']}"
    force = force_text(threshold, units, scales)
    text = f"{force} ({threshold['bifurcation']}){links_text(threshold)}"
    change = threshold["nearest_change"]
    if change is None:
        return f"{text}; no change of regime to compare with"
    return (
        f"{text}; nearest change {change['direction']}: {change['before']} at"
        f" {change['start']:.6g}, {change['after']} at {change['end']:.6g}"
    )
