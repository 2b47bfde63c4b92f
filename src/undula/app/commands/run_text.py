"""The answer of a run for people: a few aligned lines."""

from collections.abc import Iterator, Mapping
from typing import Any

from undula.terminal.numbers import BODY, told_of
from undula.terminal.run_progress import duration
from undula.terminal.units_text import units_lines

Answer = Mapping[str, Any]

#: Which solved state is what a run of a verdict ends in.
_CONVERGED = {"spinning": "spinning", "planar flapping": "flapping"}


def run_text(answer: Answer) -> str:
    """Return verdict, figures, health and file names of a run, one a line.

    Parameters
    ----------
    answer
        The answer as `undula run --json` gives it.
    """
    lines = [(name, said) for name, said in _lines(answer) if said]
    width = max(len(name) for name, _ in lines)
    head = [f"{answer['load']}: {answer['verdict']}", *units_lines(answer["units"])]
    return "\n".join([*head, *(f"  {name:<{width}}  {said}" for name, said in lines)])


def _lines(answer: Answer) -> Iterator[tuple[str, str]]:
    yield "because", answer["reason"]
    yield "ended", _ended(answer)
    yield "frequency", _frequency(answer, "frequency")
    yield "rotation", _frequency(answer, "rotation_frequency")
    yield "shape", _frequency(answer, "shape_frequency")
    yield "Lyapunov", _lyapunov(answer)
    yield "bending energy", _span(answer["bending_energy"], answer["units"]["energy"])
    yield "tip radius", _span(answer["tip_radius"], "L")
    yield "tip height", _span(answer["tip_height"], "L")
    yield "links", _links(answer)
    yield "health", _health(answer)
    yield "result", answer["output"]
    yield "figure", answer["figure"] or "none"
    yield "movie", answer["movie"] or "none"


def _ended(answer: Answer) -> str:
    settled, start = answer["settled"], answer["window"][0]
    since = f", settled since t = {settled['since']:.4g} T" if settled else ""
    whose = "of the solved state" if answer["solved"] else f"from t = {start:.4g} T on"
    return (
        f"{answer['status']} at t = {answer['time']:.4g} T{since}, after"
        f" {duration(answer['seconds'])}; figures {whose}"
    )


def _frequency(answer: Answer, name: str) -> str:
    value, error = answer[name], answer[f"{name}_error"]
    if value is None:
        return ""
    return told_of(value, error, answer, "cycles per T")


def _lyapunov(answer: Answer) -> str:
    """Tell the largest exponent, the one beyond the symmetries, and what pairs of runs show."""
    found = answer["lyapunov"]
    if found is None:
        return f"none: {answer['without_lyapunov']}" if answer["without_lyapunov"] else ""
    beyond = told_of(found["beyond_symmetry"], found["beyond_symmetry_error"], answer, "/T")
    told = f"{told_of(found['value'], found['error'], answer, '/T')}, {beyond} symmetry aside"
    pairs = found["finite_separation"]
    if not pairs:
        return told
    return f"{told}; runs part at {told_of(pairs['rate'], pairs['error'], answer, '/T')}"


def _links(answer: Answer) -> str:
    """Tell on how many links the numbers hold, and what takes them to the filament."""
    count = str(answer["links"])
    if answer["error_of"] == BODY:
        return count
    kind = _CONVERGED.get(answer["verdict"])
    if kind is not None:
        return f"{count}; `undula find {kind} --converge` gives the filament's"
    return f"{count}; a run with more model.segments tells how much that matters"


def _span(values: Mapping[str, float], unit: str) -> str:
    low, high = values["min"], values["max"]
    # A spread below the digits shown is no range for the reader.
    if f"{low:.5g}" == f"{high:.5g}":
        return f"{values['mean']:.5g} {unit}"
    return f"{low:.5g} to {high:.5g} {unit}, mean {values['mean']:.5g}"


def _health(answer: Answer) -> str:
    folded = ", a joint folded (angle up to pi)" if answer["folded"] else ""
    return (
        f"power balance to {answer['power_balance_error']:.1g}, length to"
        f" {answer['length_error']:.1g}, {answer['steps']} steps ({answer['rejected']} rejected),"
        f" {answer['frame']} frame{folded}"
    )
