"""The answer of `undula follow` for people: points of a branch and its bifurcations."""

from typing import Any

from undula.analysis.parameters import FORCE
from undula.models.scales import Scales
from undula.models.units import Units
from undula.terminal.numbers import CURE, LINKS, with_error_of
from undula.terminal.output import Answer
from undula.terminal.physical import bracketed, of_parameter, scales_lines
from undula.terminal.units_text import units_lines


def branch_text(
    answer: dict[str, Any], title: str, units: Units, scales: Scales | None = None
) -> Answer:
    """Return an answer on a branch with its text.

    Parameters
    ----------
    answer
        The answer in plain JSON types.
    title
        Beginning of the text.
    units
        Units of the model.
    scales
        SI values of the dimensionless units; None for a text without physical units.
    """
    name = answer["parameter"]
    first, last = answer["points"][0], answer["points"][-1]
    lines = [
        f"{title} along {name} from {first[name]:.6g} to {last[name]:.6g},"
        f" {len(answer['points'])} points, {answer['status']}",
        *units_lines(answer["units"], units.forces if name == FORCE else ()),
        *scales_lines(scales),
        f"  {name:>16} {'frequency':>12} {'leading rate':>13}",
        *(
            f"  {point[name]:>16.8g} {point['frequency']:>12.7g} {point['leading_rate']:>13.5g}"
            f"  {'stable' if point['stable'] else 'unstable'}"
            for point in answer["points"]
        ),
        *(_bifurcation_line(point, units, scales, name) for point in answer["bifurcations"]),
        *([f"  born {answer['birth']}ly at the onset"] if "birth" in answer else []),
    ]
    return Answer(answer, "\n".join(lines))


def _bifurcation_line(
    point: dict[str, Any], units: Units, scales: Scales | None, parameter: str
) -> str:
    further = "force_in" in point
    unit = units.force if further else ""
    place = f"{point['value']:.10g} {unit}".rstrip()
    if point["error"] is not None or point["error_of"] == LINKS:
        cure = "" if "not_converged" in point else CURE
        place = with_error_of(point["value"], point["error"], point, unit, cure).rstrip()
    place += units.bracketed(point["value"]) if further else ""
    place += of_parameter(scales, parameter, point["value"], error=point["error"])
    second = point["second_frequency"]
    second_text = f", second frequency {second:.6g}" if second is not None else ""
    second_text += bracketed(scales, "frequency", second)
    stability = f", stability {point['stability']}" if "stability" in point else ""
    unconverged = f" (not converged: {point['not_converged']})" if "not_converged" in point else ""
    frequency = f"{point['frequency']:.7g} cycles per T"
    frequency += bracketed(scales, "frequency", point["frequency"])
    further_text = f"{second_text}{stability}{unconverged}"
    return f"  {point['kind']} at {place}: {frequency}{further_text}"
