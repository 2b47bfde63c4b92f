"""`undula threshold`: forces at which stability changes, in plain JSON types and as text."""

from collections.abc import Iterable, Mapping
from typing import Any

from undula.analysis.parameters import changed
from undula.analysis.solvers.threshold_record import Threshold, ThresholdCurve
from undula.analysis.solvers.thresholds import single_threshold, threshold_curve
from undula.interrupts import interruptible
from undula.models.model import Model
from undula.models.scales import Scales
from undula.models.units import Units
from undula.terminal.numbers import BODY, CURE, digits, on_links, with_error
from undula.terminal.output import Answer
from undula.terminal.physical import bracketed, scales_lines, with_physical
from undula.terminal.progress import counted, searching
from undula.terminal.sensitivities_text import with_sensitivities
from undula.terminal.units_text import force_in, units_lines

#: Advice where the search ended without a threshold.
_FARTHER = "--up-to looks farther"


def answer_threshold(
    model: Model,
    name: str,
    *,
    converge: bool,
    up_to: float | None,
    title: str,
    derivatives: bool = False,
    scales: Scales | None = None,
) -> Answer:
    """Return the answer for one threshold.

    Parameters
    ----------
    model : Model
        The model; its own force is not used.
    name : str
        Name of the threshold, such as "onset".
    converge : bool
        If true, extrapolate the threshold to the limit of many links.
    up_to : float or None
        Force at which the search ends [the model's unit of force]; None for the default.
    title : str
        Beginning of the text.
    derivatives : bool
        If true, add the derivatives of force and frequency by all parameters.
    scales : Scales or None
        SI values of the dimensionless units; None for an answer without physical units.
    """
    with searching(name) as progress:
        result = single_threshold(model, name, converged=converge, up_to=up_to, progress=progress)
    units = model.units
    answer = {"status": "done", "units": units.names(), "threshold": name}
    answer |= threshold_answer(result, units)
    lines = [
        f"{title}: {name} {_line(answer, units, scales)}",
        *_cure([answer]),
        *units_lines(units.names(), units.forces),
        *scales_lines(scales),
    ]
    whole = Answer(answer, "\n".join(lines))
    if derivatives and result:
        whole = with_sensitivities(whole, result)
    return Answer(with_physical(whole.answer, "threshold", scales), whole.text)


def answer_threshold_curve(
    model: Model,
    name: str,
    along: tuple[str, tuple[float, ...]],
    *,
    converge: bool,
    up_to: float | None,
    title: str,
    scales: Scales | None = None,
) -> tuple[Answer, ThresholdCurve]:
    """Return the answer for a threshold along a second parameter, and the thresholds.

    Parameters are those of `answer_threshold`; `along` is the second one's name and its values.
    """
    parameter, values = along
    with interruptible() as interrupted, counted(f"{name} along {parameter}") as progress:
        curve = threshold_curve(
            model,
            name,
            parameter,
            values,
            converged=converge,
            up_to=up_to,
            progress=progress,
            stop=interrupted,
        )
    answer, lines = _curve_answer(model, name, along, curve, (title, scales))
    return Answer(with_physical(answer, "threshold", scales), "\n".join(lines)), curve


def _curve_answer(
    model: Model,
    name: str,
    along: tuple[str, tuple[float, ...]],
    curve: ThresholdCurve,
    heading: tuple[str, Scales | None],
) -> tuple[dict[str, Any], list[str]]:
    """Return the answer and the lines for the thresholds found along a second parameter."""
    (parameter, values), (title, scales) = along, heading
    done = len(curve) == len(values)
    # A chain of other links has other further units.
    units = [changed(model, parameter, value).units for value in values[: len(curve)]]
    answers = [threshold_answer(*pair) for pair in zip(curve, units, strict=True)]
    rows = list(zip(values, answers, units, strict=False))
    names = model.units.names()
    answer = {
        "status": "done" if done else "interrupted",
        "units": names,
        "threshold": name,
        "parameter": parameter,
        "thresholds": [{parameter: value} | row for value, row, _ in rows],
    }
    lines = [
        f"{title}: {name} along {parameter}",
        *units_lines(names, model.units.forces),
        *scales_lines(scales),
        *(f"  {value:>12.6g}  {_line(row, own, scales)}" for value, row, own in rows),
        *_cure(answers),
    ]
    return answer, lines


def threshold_answer(result: Threshold, units: Units) -> dict[str, Any]:
    """Return a threshold in plain JSON types."""
    return {
        "value": result.value,
        **force_in(units, result.value),
        "error": result.error,
        "error_of": BODY,
        "solver_error": result.solver_error,
        "links": _links(result),
        "frequency": result.frequency,
        "second_frequency": result.second_frequency,
        "bifurcation": result.bifurcation,
        "reason": result.reason,
        "searched_to": result.searched_to,
    }


def _links(result: Threshold) -> int | list[int] | None:
    """Return the number of links that a force is of, or those that it was extrapolated from."""
    return result.links[0] if len(result.links) == 1 else list(result.links) or None


def force_text(answer: Mapping[str, Any], units: Units, scales: Scales | None) -> str:
    """Return the force of a threshold's answer, with its error if that is known."""
    value, error = answer["value"], answer["error"]
    if error is None:
        text = on_links(value, answer["solver_error"], answer["links"], units.force)
    else:
        text = f"{with_error(value, error)} {units.force}"
    physical = bracketed(scales, "force", value, error=error)
    return f"{text}{units.bracketed(value)}{physical}"


def links_text(answer: Mapping[str, Any]) -> str:
    """Return the force on these links, after a semicolon, if it differs from the body's."""
    if not _is_of_few(answer) or answer["error"] is None:
        return ""
    error = answer["solver_error"]
    force = digits(answer["value"], error)
    return f"; on {answer['links']} links {force}, solved to {error:.1g}"


def _is_of_few(answer: Mapping[str, Any]) -> bool:
    """Return True if a force holds for a few links that represent a body of more links."""
    differs = answer["value"] is not None and answer["error"] != answer["solver_error"]
    return differs and isinstance(answer["links"], int)


def _line(answer: Mapping[str, Any], units: Units, scales: Scales | None) -> str:
    if answer["value"] is None:
        farther = "" if answer["searched_to"] is None else f"; {_FARTHER}"
        return f"none: {answer['reason']}{farther}"
    physical = bracketed(scales, "frequency", answer["frequency"])
    return (
        f"at force {force_text(answer, units, scales)} ({answer['bifurcation']}),"
        f" {answer['frequency']:.7g} cycles per T{physical}{links_text(answer)}"
    )


def _cure(answers: Iterable[Mapping[str, Any]]) -> list[str]:
    """Return a line with the option that gives the body's force, if links are few."""
    return [f"  {CURE}"] if any(map(_is_of_few, answers)) else []
