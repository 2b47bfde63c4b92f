"""Answer of `undula run` for people: a few aligned lines."""

from collections.abc import Iterator, Mapping

from undula.terminal.numbers import BODY, with_error_of
from undula.terminal.output import JsonAnswer
from undula.terminal.run_progress import duration
from undula.terminal.units_text import units_lines

#: Kind of solved state that corresponds to a verdict.
_CONVERGED = {"spinning": "spinning", "planar flapping": "flapping"}


def run_text(answer: JsonAnswer) -> str:
    """Return verdict, figures, accuracy and file names of a run, one in each line.

    Parameters
    ----------
    answer
        The answer of ``undula run --json``.
    """
    lines = [(name, text) for name, text in _lines(answer) if text]
    width = max(len(name) for name, _ in lines)
    head = [f"{answer['load']}: {answer['verdict']}", *units_lines(answer["units"])]
    return "\n".join([*head, *(f"  {name:<{width}}  {text}" for name, text in lines)])


def _lines(answer: JsonAnswer) -> Iterator[tuple[str, str]]:
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


def _ended(answer: JsonAnswer) -> str:
    settled, start = answer["settled"], answer["window"][0]
    since = f", settled since t = {settled['since']:.4g} T" if settled else ""
    source = "of the solved state" if answer["solved"] else f"from t = {start:.4g} T on"
    return (
        f"{answer['status']} at t = {answer['time']:.4g} T{since}, after"
        f" {duration(answer['seconds'])}; figures {source}"
    )


def _frequency(answer: JsonAnswer, name: str) -> str:
    value, error = answer[name], answer[f"{name}_error"]
    if value is None:
        return ""
    return with_error_of(value, error, answer, "cycles per T")


def _lyapunov(answer: JsonAnswer) -> str:
    """Return the largest exponent, that beyond the symmetries, and the rate of separation."""
    exponents = answer["lyapunov"]
    if exponents is None:
        return f"none: {answer['without_lyapunov']}" if answer["without_lyapunov"] else ""
    beyond = with_error_of(
        exponents["beyond_symmetry"], exponents["beyond_symmetry_error"], answer, "/T"
    )
    largest = with_error_of(exponents["value"], exponents["error"], answer, "/T")
    text = f"{largest}, {beyond} symmetry aside"
    pairs = exponents["finite_separation"]
    if not pairs:
        return text
    return f"{text}; runs part at {with_error_of(pairs['rate'], pairs['error'], answer, '/T')}"


def _links(answer: JsonAnswer) -> str:
    """Return the number of links, with advice on the result for the filament."""
    count = str(answer["links"])
    if answer["error_of"] == BODY:
        return count
    kind = _CONVERGED.get(answer["verdict"])
    if kind is not None:
        return f"{count}; `undula find {kind} --converge` gives the filament's"
    return f"{count}; a run with more model.segments tells how much that matters"


def _span(values: Mapping[str, float], unit: str) -> str:
    low, high = values["min"], values["max"]
    # A range that vanishes in the shown digits is given as one number.
    if f"{low:.5g}" == f"{high:.5g}":
        return f"{values['mean']:.5g} {unit}"
    return f"{low:.5g} to {high:.5g} {unit}, mean {values['mean']:.5g}"


def _health(answer: JsonAnswer) -> str:
    folded = ", a joint folded (angle up to pi)" if answer["folded"] else ""
    return (
        f"power balance to {answer['power_balance_error']:.1g}, length to"
        f" {answer['length_error']:.1g}, {answer['steps']} steps ({answer['rejected']} rejected),"
        f" {answer['frame']} frame{folded}"
    )
