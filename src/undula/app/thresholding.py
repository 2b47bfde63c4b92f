"""`undula threshold`: forces at which stability changes, in plain JSON types and for people."""

from typing import Any

from undula.analysis.interrupts import interruptible
from undula.analysis.parameters import changed
from undula.analysis.thresholds import Threshold, threshold, threshold_curve
from undula.app.answers import Told
from undula.app.progress import counted, searching
from undula.app.run_text import with_error
from undula.app.units_told import force_in, units_lines
from undula.models.model import Model
from undula.models.units import Units


def tell_threshold(model: Model, name: str, *, converge: bool, title: str) -> Told:
    """Find one threshold."""
    with searching(name) as tell:
        found = threshold(model, name, converged=converge, progress=tell)
    units = model.units
    answer = {"status": "done", "units": units.names(), "threshold": name} | _answer(found, units)
    lines = [f"{title}: {name} {_line(found, units)}", *units_lines(units.names(), units.forces)]
    return Told(answer, "\n".join(lines))


def tell_thresholds(
    model: Model,
    name: str,
    along: tuple[str, tuple[float, ...]],
    *,
    converge: bool,
    title: str,
) -> tuple[Told, tuple[Threshold, ...]]:
    """Find a threshold at each value of a second parameter."""
    parameter, values = along
    with interruptible() as interrupted, counted(f"{name} along {parameter}") as tell:
        found = threshold_curve(
            model, name, parameter, values, converged=converge, progress=tell, stop=interrupted
        )
    done = len(found) == len(values)
    # A chain of other links has other further units.
    each = [
        (value, one, changed(model, parameter, value).units)
        for value, one in zip(values, found, strict=False)
    ]
    names = model.units.names()
    answer = {
        "status": "done" if done else "interrupted",
        "units": names,
        "threshold": name,
        "parameter": parameter,
        "thresholds": [{parameter: value} | _answer(one, units) for value, one, units in each],
    }
    lines = [
        f"{title}: {name} along {parameter}",
        *units_lines(names, model.units.forces),
        *(f"  {value:>12.6g}  {_line(one, units)}" for value, one, units in each),
    ]
    return Told(answer, "\n".join(lines)), found


def _answer(found: Threshold, units: Units) -> dict[str, Any]:
    return {
        "value": found.value,
        **force_in(units, found.value),
        "error": found.error,
        "frequency": found.frequency,
        "second_frequency": found.second_frequency,
        "bifurcation": found.bifurcation,
        "reason": found.reason,
    }


def _line(found: Threshold, units: Units) -> str:
    if found.value is None:
        return f"none: {found.reason}"
    return (
        f"at force {with_error(found.value, found.error)} {units.force}{units.beside(found.value)}"
        f" ({found.bifurcation}), {found.frequency:.7g} cycles per T"
    )
