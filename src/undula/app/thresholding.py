"""`undula threshold`: forces at which stability changes, in plain JSON types and for people."""

from typing import Any

from undula.analysis.thresholds import Threshold, threshold, threshold_curve
from undula.app.answers import Told
from undula.app.progress import counted, searching
from undula.app.run_text import with_error
from undula.models.model import Model


def tell_threshold(model: Model, name: str, *, converge: bool, title: str) -> Told:
    """Find one threshold."""
    with searching(name) as tell:
        found = threshold(model, name, converged=converge, progress=tell)
    answer = {"status": "done", "threshold": name} | _answer(found)
    return Told(answer, f"{title}: {name} {_line(found)}")


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
    with counted(f"{name} along {parameter}") as tell:
        found = threshold_curve(model, name, parameter, values, converged=converge, progress=tell)
    answer = {
        "status": "done",
        "threshold": name,
        "parameter": parameter,
        "thresholds": [
            {parameter: value} | _answer(one) for value, one in zip(values, found, strict=True)
        ],
    }
    lines = [
        f"{title}: {name} along {parameter}",
        *(f"  {value:>12.6g}  {_line(one)}" for value, one in zip(values, found, strict=True)),
    ]
    return Told(answer, "\n".join(lines)), found


def _answer(found: Threshold) -> dict[str, Any]:
    return {
        "value": found.value,
        "error": found.error,
        "frequency": found.frequency,
        "second_frequency": found.second_frequency,
        "bifurcation": found.bifurcation,
        "reason": found.reason,
    }


def _line(found: Threshold) -> str:
    if found.value is None:
        return f"none: {found.reason}"
    return (
        f"at force {with_error(found.value, found.error)} B/L^2 ({found.bifurcation}),"
        f" {found.frequency:.7g} cycles per T"
    )
