"""Answer of `undula run` for people: a few aligned lines."""

from collections.abc import Iterator, Mapping

from undula.models.scales import Quantity, Scales
from undula.terminal.numbers import BODY, with_error_of
from undula.terminal.output import JsonAnswer
from undula.terminal.physical import bracketed, scales_lines
from undula.terminal.run_progress import duration
from undula.terminal.units_text import units_lines

#: Kind of solved state that corresponds to a verdict.
_CONVERGED = {"spinning": "spinning", "planar flapping": "flapping"}


def run_text(answer: JsonAnswer, scales: Scales | None = None) -> str:
    """Return verdict, figures, accuracy and file names of a run, one in each line.

    Parameters
    ----------
    answer
        The answer of ``undula run --json``.
    scales
        SI values of the dimensionless units; None for a text without physical units.
    """
    lines = [(name, text) for name, text in _lines(answer, scales) if text]
    width = max(len(name) for name, _ in lines)
    units = [*units_lines(answer["units"]), *scales_lines(scales)]
    head = [f"{answer['load']}: {answer['verdict']}", *units]
    return "\n".join([*head, *(f"  {name:<{width}}  {text}" for name, text in lines)])


def _lines(answer: JsonAnswer, scales: Scales | None) -> Iterator[tuple[str, str]]:
    yield "because", answer["reason"]
    yield "ended", _ended(answer, scales)
    yield "frequency", _frequency(answer, "frequency", scales)
    yield "rotation", _frequency(answer, "rotation_frequency", scales)
    yield "shape", _frequency(answer, "shape_frequency", scales)
    yield "Lyapunov", _lyapunov(answer, scales)
    yield "bending energy", _span(answer, "bending_energy", "energy", scales)
    yield "tip radius", _span(answer, "tip_radius", "length", scales)
    yield "tip height", _span(answer, "tip_height", "length", scales)
    yield "links", _links(answer)
    yield "health", _health(answer)
    yield "result", answer["output"]
    yield "figure", answer["figure"] or "none"
    yield "movie", answer["movie"] or "none"


def _ended(answer: JsonAnswer, scales: Scales | None) -> str:
    def instant(value: float) -> str:
        return f"t = {value:.4g} T{bracketed(scales, 'time', value)}"

    settled, start = answer["settled"], answer["window"][0]
    since = f", settled since {instant(settled['since'])}" if settled else ""
    source = "of the solved state" if answer["solved"] else f"from {instant(start)} on"
    return (
        f"{answer['status']} at {instant(answer['time'])}{since}, after"
        f" {duration(answer['seconds'])}; figures {source}"
    )


def _frequency(answer: JsonAnswer, name: str, scales: Scales | None) -> str:
    value, error = answer[name], answer[f"{name}_error"]
    if value is None:
        return ""
    physical = bracketed(scales, "frequency", value, error=error)
    return with_error_of(value, error, answer, f"cycles per T{physical}")


def _lyapunov(answer: JsonAnswer, scales: Scales | None) -> str:
    """Return the largest exponent, that beyond the symmetries, and the rate of separation."""
    exponents = answer["lyapunov"]
    if exponents is None:
        return f"none: {answer['without_lyapunov']}" if answer["without_lyapunov"] else ""

    def rate(value: float, error: float) -> str:
        physical = bracketed(scales, "rate", value, error=error)
        return with_error_of(value, error, answer, f"/T{physical}")

    beyond = rate(exponents["beyond_symmetry"], exponents["beyond_symmetry_error"])
    largest = rate(exponents["value"], exponents["error"])
    text = f"{largest}, {beyond} symmetry aside"
    pairs = exponents["finite_separation"]
    if not pairs:
        return text
    return f"{text}; runs part at {rate(pairs['rate'], pairs['error'])}"


def _links(answer: JsonAnswer) -> str:
    """Return the number of links, with advice on the result for the filament."""
    count = str(answer["links"])
    if answer["error_of"] == BODY:
        return count
    kind = _CONVERGED.get(answer["verdict"])
    if kind is not None:
        return f"{count}; `undula find {kind} --converge` gives the filament's"
    return f"{count}; a run with more model.segments tells how much that matters"


def _span(answer: JsonAnswer, name: str, quantity: Quantity, scales: Scales | None) -> str:
    values: Mapping[str, float] = answer[name]
    unit, low, high = answer["units"][quantity], values["min"], values["max"]
    # A range that vanishes in the shown digits is given as one number.
    if f"{low:.5g}" == f"{high:.5g}":
        return f"{values['mean']:.5g} {unit}{bracketed(scales, quantity, values['mean'])}"
    physical = bracketed(scales, quantity, low, high)
    return f"{low:.5g} to {high:.5g} {unit}{physical}, mean {values['mean']:.5g}"


def _health(answer: JsonAnswer) -> str:
    folded = ", a joint folded (angle up to pi)" if answer["folded"] else ""
    return (
        f"power balance to {answer['power_balance_error']:.1g}, length to"
        f" {answer['length_error']:.1g}, {answer['steps']} steps ({answer['rejected']} rejected),"
        f" {answer['frame']} frame{folded}"
    )
