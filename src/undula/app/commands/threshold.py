"""`undula threshold`: forces at which stability changes, in plain JSON types and for people."""

from collections.abc import Iterable, Mapping
from typing import Any

from undula.analysis.parameters import changed
from undula.analysis.solvers.thresholds import Threshold, threshold, threshold_curve
from undula.interrupts import interruptible
from undula.models.model import Model
from undula.models.units import Units
from undula.terminal.numbers import BODY, CURE, digits, on_links, with_error
from undula.terminal.output import Answer
from undula.terminal.progress import counted, searching
from undula.terminal.units_text import force_in, units_lines

#: What helps where the search ended without a threshold.
_FARTHER = "--up-to looks farther"


def tell_threshold(
    model: Model, name: str, *, converge: bool, up_to: float | None, title: str
) -> Answer:
    """Find one threshold."""
    with searching(name) as tell:
        found = threshold(model, name, converged=converge, up_to=up_to, progress=tell)
    units = model.units
    answer = {"status": "done", "units": units.names(), "threshold": name}
    answer |= threshold_answer(found, units)
    lines = [
        f"{title}: {name} {_line(answer, units)}",
        *_cure([answer]),
        *units_lines(units.names(), units.forces),
    ]
    return Answer(answer, "\n".join(lines))


def tell_thresholds(
    model: Model,
    name: str,
    along: tuple[str, tuple[float, ...]],
    *,
    converge: bool,
    up_to: float | None,
    title: str,
) -> tuple[Answer, tuple[Threshold, ...]]:
    """Find a threshold at each value of a second parameter."""
    parameter, values = along
    with interruptible() as interrupted, counted(f"{name} along {parameter}") as tell:
        found = threshold_curve(
            model,
            name,
            parameter,
            values,
            converged=converge,
            up_to=up_to,
            progress=tell,
            stop=interrupted,
        )
    done = len(found) == len(values)
    # A chain of other links has other further units.
    units = [changed(model, parameter, value).units for value in values[: len(found)]]
    told = [threshold_answer(one, of) for one, of in zip(found, units, strict=True)]
    each = list(zip(values, told, units, strict=False))
    names = model.units.names()
    answer = {
        "status": "done" if done else "interrupted",
        "units": names,
        "threshold": name,
        "parameter": parameter,
        "thresholds": [{parameter: value} | one for value, one, _ in each],
    }
    lines = [
        f"{title}: {name} along {parameter}",
        *units_lines(names, model.units.forces),
        *(f"  {value:>12.6g}  {_line(one, of)}" for value, one, of in each),
        *_cure(told),
    ]
    return Answer(answer, "\n".join(lines)), found


def threshold_answer(found: Threshold, units: Units) -> dict[str, Any]:
    """Return a threshold in plain JSON types."""
    return {
        "value": found.value,
        **force_in(units, found.value),
        "error": found.error,
        "error_of": BODY,
        "solver_error": found.solver_error,
        "links": _links(found),
        "frequency": found.frequency,
        "second_frequency": found.second_frequency,
        "bifurcation": found.bifurcation,
        "reason": found.reason,
        "searched_to": found.searched_to,
    }


def _links(found: Threshold) -> int | list[int] | None:
    """Return the number of links that a force is of, or those that it was extrapolated from."""
    return found.links[0] if len(found.links) == 1 else list(found.links) or None


def force_told(answer: Mapping[str, Any], units: Units) -> str:
    """Return the force of a threshold's answer, with its error if that is known."""
    value, error = answer["value"], answer["error"]
    if error is None:
        told = on_links(value, answer["solver_error"], answer["links"], units.force)
    else:
        told = f"{with_error(value, error)} {units.force}"
    return f"{told}{units.beside(value)}"


def links_told(answer: Mapping[str, Any]) -> str:
    """Return what the force is on these links, after a semicolon, if that is something else."""
    if not _is_of_few(answer) or answer["error"] is None:
        return ""
    here, exactly = digits(answer["value"], answer["solver_error"]), answer["solver_error"]
    return f"; on {answer['links']} links {here}, solved to {exactly:.1g}"


def _is_of_few(answer: Mapping[str, Any]) -> bool:
    """Tell whether a force is that of links which have more of them for a body."""
    apart = answer["value"] is not None and answer["error"] != answer["solver_error"]
    return apart and isinstance(answer["links"], int)


def _line(answer: Mapping[str, Any], units: Units) -> str:
    if answer["value"] is None:
        farther = "" if answer["searched_to"] is None else f"; {_FARTHER}"
        return f"none: {answer['reason']}{farther}"
    return (
        f"at force {force_told(answer, units)} ({answer['bifurcation']}),"
        f" {answer['frequency']:.7g} cycles per T{links_told(answer)}"
    )


def _cure(answers: Iterable[Mapping[str, Any]]) -> list[str]:
    """Return a line on how to come from these links to the body, if there is more to come to."""
    return [f"  {CURE}"] if any(map(_is_of_few, answers)) else []
