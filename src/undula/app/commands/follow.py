"""`undula follow`: a branch of states along a parameter, in plain JSON types and as text."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from undula.analysis.linear.straight_branch import (
    StraightBranch,
    follow_straight,
    straight_at_values,
)
from undula.analysis.parameters import FORCE, changed, value_of
from undula.analysis.solvers.branches import follow, follow_from_onset
from undula.analysis.solvers.refind import limit_of
from undula.analysis.solvers.state_kinds import kind_by_name
from undula.analysis.solvers.states_at_values import states_at_values
from undula.analysis.states.along_parameter import model_along
from undula.analysis.states.branch import Bifurcation, Branch
from undula.analysis.states.branch_json import bifurcation_as_json, points_as_json
from undula.analysis.states.extrapolation import Converged, links_are_body
from undula.analysis.states.not_found import NotFound
from undula.app.commands.find import not_found
from undula.app.commands.follow_text import branch_text
from undula.errors import InputError
from undula.inputs.ranges import Way
from undula.interrupts import interruptible
from undula.models.model import Model
from undula.models.scales import Scales
from undula.models.units import Units
from undula.terminal.numbers import BODY, LINKS
from undula.terminal.output import Answer
from undula.terminal.physical import with_physical
from undula.terminal.progress import approached
from undula.terminal.units_text import force_in

# Statuses of one branch; several have the first one that any of them has.
_WORST_FIRST = ("interrupted", "not found", "stopped early", "done")


def follow_along(
    model: Model,
    kind: str,
    way: Way,
    *,
    converge: bool,
    title: str,
    scales: Scales | None = None,
) -> tuple[Answer, Branch[Any] | StraightBranch | None]:
    """Follow a state along a parameter.

    Parameters
    ----------
    model : Model
        The model; its own value of the parameter is not used.
    kind : str
        Kind of state, or "straight".
    way : Way
        The parameter with its first and last value, and the values to answer for.
    converge : bool
        If true, extrapolate bifurcations to the limit of many links.
    title : str
        Beginning of the text.
    scales : Scales or None
        SI values of the dimensionless units; None for a text without physical units.

    Returns
    -------
    tuple of Answer and (Branch, StraightBranch or None)
        The branch is None if there is no state to begin at.

    Raises
    ------
    InputError
        There is no such kind or parameter, or a value is out of its range.
    """
    value_of(model, way.parameter)
    if kind == "straight":
        return _straight(model, way, scales, converge=converge, title=title)
    with interruptible() as interrupted:
        if way.start is None:
            branch = _from_onset(model, kind, way, interrupted)
        else:
            branch = _between(model, kind, way, way.start, interrupted)
        early = interrupted()
    if isinstance(branch, NotFound):
        return not_found(branch, f"{title}: {kind}", model.units), None
    shown = branch if early or way.values is None else _at_values(branch, kind, way.values)
    answer = branch_answer(shown, model.units, converge=converge and not early)
    if early:
        answer["status"] = "interrupted"
    return branch_text(answer, f"{title}: {kind}", model.units, scales), branch


def follow_kinds(
    model: Model,
    kinds: Sequence[str],
    way: Way,
    *,
    converge: bool,
    title: str,
    scales: Scales | None = None,
) -> tuple[Answer, list[Any]]:
    """Follow states of one kind or of several kinds along a parameter.

    Parameters
    ----------
    model, way, converge, title, scales
        As for `follow_along`; with scales the answer has physical numbers.
    kinds : sequence of str
        The kinds, at least one; each of several has its own answer in the list `branches`.

    Returns
    -------
    tuple of Answer and list
        Branches of the kinds for which there was a state to begin at.

    Raises
    ------
    InputError
        As for `follow_along`.
    """
    answers, branches = {}, []
    for kind in kinds:
        answers[kind], branch = follow_along(
            model, kind, way, converge=converge, title=title, scales=scales
        )
        branches += [] if branch is None else [branch]
        if answers[kind].answer["status"] == "interrupted":
            break
    whole = answers[kinds[0]] if len(kinds) == 1 else _several(answers, model, way)
    return Answer(with_physical(whole.answer, "follow", scales), whole.text), branches


def _several(answers: Mapping[str, Answer], model: Model, way: Way) -> Answer:
    """Return the answers on several kinds as one."""
    statuses = {answer.answer["status"] for answer in answers.values()}
    several = {
        "status": next(status for status in _WORST_FIRST if status in statuses),
        "units": model.units.names(),
        "parameter": way.parameter,
        "branches": [{"kind": kind} | answer.answer for kind, answer in answers.items()],
    }
    return Answer(several, "\n\n".join(answer.text for answer in answers.values()))


def _straight(
    model: Model, way: Way, scales: Scales | None, *, converge: bool, title: str
) -> tuple[Answer, StraightBranch]:
    if converge:
        raise InputError("the straight state is converged already; leave --converge out")
    if way.start is None:
        raise InputError("the straight state ends at its onset; give a number to start at")
    straight = follow_straight(model, way.parameter, way.start, way.end)
    shown = straight
    if way.values is not None:
        shown = straight_at_values(model, straight, way.values)
    answer = straight_answer(shown, model)
    return branch_text(answer, f"{title}: straight state", model.units, scales), straight


def _from_onset(
    model: Model, kind: str, way: Way, stop: Callable[[], bool]
) -> Branch[Any] | NotFound:
    if way.parameter != FORCE:
        raise InputError(f"an onset is a value of {FORCE}; start {way.parameter} at a number")
    with approached(f"following {kind}", 0.0, way.end) as progress:
        return follow_from_onset(model, kind, way.end, progress=progress, stop=stop)


def _between(
    model: Model, kind: str, way: Way, start: float, stop: Callable[[], bool]
) -> Branch[Any] | NotFound:
    chosen = kind_by_name(kind)
    along = model_along(model, kind, way.parameter, (start, way.end))
    state = chosen.find(changed(along, way.parameter, start))
    if isinstance(state, NotFound):
        return state
    with approached(f"following {kind}", start, way.end) as progress:
        return follow(state, way.parameter, way.end, progress=progress, stop=stop)


def _at_values(branch: Branch[Any], kind: str, values: Sequence[float]) -> Branch[Any]:
    with approached(f"{kind} at {len(values)} values", values[0], values[-1]) as progress:
        return states_at_values(branch, values, progress=progress)


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
