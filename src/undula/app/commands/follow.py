"""`undula follow`: a branch of states along a parameter, in plain JSON types and as text."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from undula.analysis.linear.straight_branch import StraightBranch, follow_straight
from undula.analysis.parameters import FORCE, changed, value_of
from undula.analysis.solvers.branches import follow, follow_from_onset
from undula.analysis.solvers.refind import limit_of
from undula.analysis.solvers.state_kinds import kind_by_name
from undula.analysis.states.along_parameter import model_along
from undula.analysis.states.branch import Bifurcation, Branch
from undula.analysis.states.branch_json import bifurcation_as_json, points_as_json
from undula.analysis.states.extrapolation import Converged, links_are_body
from undula.analysis.states.not_found import NotFound
from undula.app.commands.find import not_found
from undula.errors import InputError
from undula.interrupts import interruptible
from undula.models.model import Model
from undula.models.units import Units
from undula.terminal.numbers import BODY, CURE, LINKS, with_error_of
from undula.terminal.output import Answer
from undula.terminal.progress import approached
from undula.terminal.units_text import force_in, units_lines


@dataclass(frozen=True)
class ParameterInterval:
    """The interval of a parameter along which a state is followed.

    Attributes
    ----------
    parameter : str
        Its name.
    start : float or None
        The first value; None for the onset.
    end : float
        The last value.
    """

    parameter: str
    start: float | None
    end: float


def follow_along(
    model: Model, kind: str, interval: ParameterInterval, *, converge: bool, title: str
) -> tuple[Answer, Branch[Any] | StraightBranch | None]:
    """Follow a state along a parameter.

    Parameters
    ----------
    model : Model
        The model; its own value of the parameter is not used.
    kind : str
        Kind of state, or "straight".
    interval : ParameterInterval
        The parameter, and its first and last value.
    converge : bool
        If true, extrapolate bifurcations to the limit of many links.
    title : str
        Beginning of the text.

    Returns
    -------
    tuple of Answer and (Branch, StraightBranch or None)
        The branch is None if there is no state to begin at.

    Raises
    ------
    InputError
        There is no such kind or parameter, or a value is out of its range.
    """
    value_of(model, interval.parameter)
    if kind == "straight":
        return _straight(model, interval, converge=converge, title=title)
    with interruptible() as interrupted:
        if interval.start is None:
            branch = _from_onset(model, kind, interval, interrupted)
        else:
            branch = _between(model, kind, interval, interval.start, interrupted)
        early = interrupted()
    if isinstance(branch, NotFound):
        return not_found(branch, f"{title}: {kind}", model.units), None
    answer = branch_answer(branch, model.units, converge=converge and not early)
    if early:
        answer["status"] = "interrupted"
    return _with_text(answer, f"{title}: {kind}", model.units), branch


def _straight(
    model: Model, interval: ParameterInterval, *, converge: bool, title: str
) -> tuple[Answer, StraightBranch]:
    if converge:
        raise InputError("the straight state is converged already; leave --converge out")
    if interval.start is None:
        raise InputError("the straight state ends at its onset; give a number to start at")
    straight = follow_straight(model, interval.parameter, interval.start, interval.end)
    answer = straight_answer(straight, model)
    return _with_text(answer, f"{title}: straight state", model.units), straight


def _from_onset(
    model: Model, kind: str, interval: ParameterInterval, stop: Callable[[], bool]
) -> Branch[Any] | NotFound:
    if interval.parameter != FORCE:
        raise InputError(f"an onset is a value of {FORCE}; start {interval.parameter} at a number")
    with approached(f"following {kind}", 0.0, interval.end) as progress:
        return follow_from_onset(model, kind, interval.end, progress=progress, stop=stop)


def _between(
    model: Model, kind: str, interval: ParameterInterval, start: float, stop: Callable[[], bool]
) -> Branch[Any] | NotFound:
    chosen = kind_by_name(kind)
    along = model_along(model, kind, interval.parameter, (start, interval.end))
    state = chosen.find(changed(along, interval.parameter, start))
    if isinstance(state, NotFound):
        return state
    with approached(f"following {kind}", start, interval.end) as progress:
        return follow(state, interval.parameter, interval.end, progress=progress, stop=stop)


def branch_answer(branch: Branch[Any], units: Units, *, converge: bool) -> dict[str, Any]:
    """Return a branch in plain JSON types; `converge` takes its bifurcations to many links."""
    answer: dict[str, Any] = {
        "status": "done" if branch.complete else "stopped early",
        "units": units.names(),
        "parameter": branch.parameter,
        "points": points_as_json(branch),
        "bifurcations": [
            _with_force(_bifurcation_answer(branch.parameter, point, converge=converge), units)
            for point in branch.bifurcations
        ],
    }
    if branch.criticality is not None:
        answer |= {"birth": branch.criticality, "onset": branch.onset}
    return answer


def straight_answer(branch: StraightBranch, model: Model) -> dict[str, Any]:
    """Return the straight state of a model along a parameter in plain JSON types."""
    units, of_body = model.units, branch.links is None or links_are_body(model)
    columns = zip(branch.values, branch.rates, branch.frequencies, strict=True)
    return {
        "status": "done",
        "units": units.names(),
        "parameter": branch.parameter,
        "points": [
            {
                branch.parameter: float(value),
                "frequency": float(frequency),
                "stable": bool(rate < 0.0),
                "leading_rate": float(rate),
            }
            for value, rate, frequency in columns
        ],
        "bifurcations": [
            _with_force(
                {
                    "kind": "Hopf",
                    "value": value,
                    branch.parameter: value,
                    "error": None,
                    "error_of": BODY if of_body else LINKS,
                    "links": branch.links,
                    "frequency": frequency,
                    "second_frequency": None,
                },
                units,
            )
            for value, frequency in branch.hopf
        ],
    }


def _bifurcation_answer(
    parameter: str, bifurcation: Bifurcation[Any], *, converge: bool
) -> dict[str, Any]:
    error_of = BODY if links_are_body(bifurcation.state.model) else LINKS
    answer = bifurcation_as_json(parameter, bifurcation, error_of=error_of)
    limit = limit_of(bifurcation, parameter) if converge else None
    if isinstance(limit, Converged):
        answer |= dict(limit.values) | {
            parameter: limit.values["value"],
            "error": limit.errors["value"] + bifurcation.error,
            "error_of": BODY,
            "links": list(limit.links),
        }
    elif limit is not None:
        answer |= {"not_converged": limit.reason}
    return answer


def _with_force(bifurcation: dict[str, Any], units: Units) -> dict[str, Any]:
    """Return a bifurcation, with its force in further units if it is a value of the force."""
    return bifurcation | force_in(units, bifurcation.get(FORCE))


def _with_text(answer: dict[str, Any], title: str, units: Units) -> Answer:
    name = answer["parameter"]
    first, last = answer["points"][0], answer["points"][-1]
    lines = [
        f"{title} along {name} from {first[name]:.6g} to {last[name]:.6g},"
        f" {len(answer['points'])} points, {answer['status']}",
        *units_lines(answer["units"], units.forces if name == FORCE else ()),
        f"  {name:>16} {'frequency':>12} {'leading rate':>13}",
        *(
            f"  {point[name]:>16.8g} {point['frequency']:>12.7g} {point['leading_rate']:>13.5g}"
            f"  {'stable' if point['stable'] else 'unstable'}"
            for point in answer["points"]
        ),
        *(_bifurcation_line(point, units) for point in answer["bifurcations"]),
        *([f"  born {answer['birth']}ly at the onset"] if "birth" in answer else []),
    ]
    return Answer(answer, "\n".join(lines))


def _bifurcation_line(point: dict[str, Any], units: Units) -> str:
    further = "force_in" in point
    unit = units.force if further else ""
    place = f"{point['value']:.10g} {unit}".rstrip()
    if point["error"] is not None or point["error_of"] == LINKS:
        cure = "" if "not_converged" in point else CURE
        place = with_error_of(point["value"], point["error"], point, unit, cure).rstrip()
    place += units.bracketed(point["value"]) if further else ""
    second = point["second_frequency"]
    second_text = f", second frequency {second:.6g}" if second is not None else ""
    stability = f", stability {point['stability']}" if "stability" in point else ""
    unconverged = f" (not converged: {point['not_converged']})" if "not_converged" in point else ""
    frequency = f"{point['frequency']:.7g} cycles per T"
    further_text = f"{second_text}{stability}{unconverged}"
    return f"  {point['kind']} at {place}: {frequency}{further_text}"
