"""`undula follow`: a branch of states along a parameter, in plain JSON types and for people."""

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
from undula.analysis.states.extrapolation import Converged, links_are_body
from undula.analysis.states.not_found import NotFound
from undula.app.commands.find import not_found, state_answer
from undula.errors import InputError
from undula.interrupts import interruptible
from undula.models.model import Model
from undula.models.units import Units
from undula.terminal.numbers import BODY, CURE, LINKS, told_of
from undula.terminal.output import Answer
from undula.terminal.progress import approached
from undula.terminal.units_text import force_in, units_lines

#: What is told of each point of a branch.
_KEPT = (
    "frequency",
    "bending_energy",
    "tip_radius",
    "tip_height",
    "stable",
    "leading_rate",
    "leading_rate_in_plane",
    "leading_rate_out_of_plane",
)


@dataclass(frozen=True)
class Way:
    """A parameter, and the values at which to begin, None for the onset, and to end."""

    parameter: str
    start: float | None
    end: float


def follow_along(
    model: Model, kind: str, way: Way, *, converge: bool, title: str
) -> tuple[Answer, Branch[Any] | StraightBranch | None]:
    """Follow a state; return the answer, and the branch unless there is no state to begin at.

    Raises
    ------
    InputError
        There is no such kind or parameter, or a value is out of its range.
    """
    value_of(model, way.parameter)
    if kind == "straight":
        return _straight(model, way, converge=converge, title=title)
    with interruptible() as interrupted:
        if way.start is None:
            found = _from_onset(model, kind, way, interrupted)
        else:
            found = _between(model, kind, way, way.start, interrupted)
        early = interrupted()
    if isinstance(found, NotFound):
        return not_found(found, f"{title}: {kind}", model.units), None
    answer = branch_answer(found, model.units, converge=converge and not early)
    if early:
        answer["status"] = "interrupted"
    if way.start is None and len(found.values) > 1:
        answer["birth"] = "subcritical" if found.values[1] < found.values[0] else "supercritical"
    return _told(answer, f"{title}: {kind}", model.units), found


def _straight(
    model: Model, way: Way, *, converge: bool, title: str
) -> tuple[Answer, StraightBranch]:
    if converge:
        raise InputError("the straight state is converged already; leave --converge out")
    if way.start is None:
        raise InputError("the straight state ends at its onset; give a number to start at")
    straight = follow_straight(model, way.parameter, way.start, way.end)
    answer = straight_answer(straight, model)
    return _told(answer, f"{title}: straight state", model.units), straight


def _from_onset(
    model: Model, kind: str, way: Way, stop: Callable[[], bool]
) -> Branch[Any] | NotFound:
    if way.parameter != FORCE:
        raise InputError(f"an onset is a value of {FORCE}; start {way.parameter} at a number")
    with approached(f"following {kind}", 0.0, way.end) as tell:
        return follow_from_onset(model, kind, way.end, progress=tell, stop=stop)


def _between(
    model: Model, kind: str, way: Way, start: float, stop: Callable[[], bool]
) -> Branch[Any] | NotFound:
    chosen = kind_by_name(kind)
    along = model_along(model, kind, way.parameter, (start, way.end))
    begun = chosen.find(changed(along, way.parameter, start))
    if isinstance(begun, NotFound):
        return begun
    with approached(f"following {kind}", start, way.end) as tell:
        return follow(begun, way.parameter, way.end, progress=tell, stop=stop)


def branch_answer(branch: Branch[Any], units: Units, *, converge: bool) -> dict[str, Any]:
    """Return a branch in plain JSON types, its bifurcations in the limit of many links if asked."""
    points = []
    for value, state in zip(branch.values, branch.states, strict=True):
        told = state_answer(state)
        kept = {key: told[key] for key in _KEPT if key in told}
        points.append({branch.parameter: float(value)} | kept)
    return {
        "status": "done" if branch.complete else "stopped early",
        "units": units.names(),
        "parameter": branch.parameter,
        "points": points,
        "bifurcations": [
            _with_force(_bifurcation_answer(branch.parameter, one, converge=converge), units)
            for one in branch.bifurcations
        ],
    }


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


def _bifurcation_answer(parameter: str, one: Bifurcation[Any], *, converge: bool) -> dict[str, Any]:
    answer = {
        "kind": one.kind,
        "value": one.value,
        parameter: one.value,
        "error": one.error,
        "error_of": BODY if links_are_body(one.state.model) else LINKS,
        "links": one.state.model.links,
        "frequency": one.frequency,
        "second_frequency": one.second_frequency,
        "stability": "lost" if one.loses else "gained" if one.gains else "unchanged",
    }
    limit = limit_of(one, parameter) if converge else None
    if isinstance(limit, Converged):
        answer |= dict(limit.values) | {
            parameter: limit.values["value"],
            "error": limit.errors["value"] + one.error,
            "error_of": BODY,
            "links": list(limit.links),
        }
    elif limit is not None:
        answer |= {"not_converged": limit.reason}
    return answer


def _with_force(bifurcation: dict[str, Any], units: Units) -> dict[str, Any]:
    """Return a bifurcation, with its force in further units if it is a value of the force."""
    return bifurcation | force_in(units, bifurcation.get(FORCE))


def _told(answer: dict[str, Any], title: str, units: Units) -> Answer:
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
        *(_bifurcation_line(one, units) for one in answer["bifurcations"]),
        *([f"  born {answer['birth']}ly at the onset"] if "birth" in answer else []),
    ]
    return Answer(answer, "\n".join(lines))


def _bifurcation_line(one: dict[str, Any], units: Units) -> str:
    further = "force_in" in one
    unit = units.force if further else ""
    at = f"{one['value']:.10g} {unit}".rstrip()
    if one["error"] is not None or one["error_of"] == LINKS:
        cure = "" if "not_converged" in one else CURE
        at = told_of(one["value"], one["error"], one, unit, cure).rstrip()
    at += units.beside(one["value"]) if further else ""
    second = one["second_frequency"]
    beside = f", second frequency {second:.6g}" if second is not None else ""
    stability = f", stability {one['stability']}" if "stability" in one else ""
    left = f" (not converged: {one['not_converged']})" if "not_converged" in one else ""
    return f"  {one['kind']} at {at}: {one['frequency']:.7g} cycles per T{beside}{stability}{left}"
