"""`undula find`: a state solved for, in plain JSON types and for people."""

from typing import Any

from undula.analysis.solvers.state_kinds import Solved, extrapolate, kind_by_name, with_error
from undula.analysis.states.branch_json import extents_as_json
from undula.analysis.states.extrapolation import Converged, links_are_body
from undula.analysis.states.not_found import NotFound
from undula.analysis.states.periodic_record import Periodic
from undula.analysis.states.records import Equilibrium, Spinning
from undula.app.commands.find_start import Beginning
from undula.models.units import Units
from undula.terminal.numbers import BODY, CURE
from undula.terminal.numbers import with_error as with_digits
from undula.terminal.output import Answer
from undula.terminal.progress import searching
from undula.terminal.units_text import force_in, units_lines

#: Units of what a state tells, by the beginning of its name; of energies they are the model's.
_UNITS = {
    "frequency": "cycles per T",
    "tip_radius": "L",
    "tip_height": "L",
    "leading_rate": "/T",
    "period": "T",
    "turn": "rad",
}


def find(asked: Beginning, kind: str, *, converge: bool) -> Answer:
    """Solve for a state; in the limit of many links if asked to.

    Raises
    ------
    InputError
        There is no such kind, or the model has no limit of many links.
    """
    model, title, chosen = asked.model, asked.title, kind_by_name(kind)
    with searching(f"finding {kind}") as tell:
        found: Any = asked.first()
        if converge and not isinstance(found, NotFound):
            found = extrapolate(model, kind, found, progress=tell)
        elif found is None:
            found = chosen.find(model)
    if isinstance(found, NotFound):
        return not_found(found, f"{title}: {kind}", model.units)
    answer = (
        _limit_answer(found) if isinstance(found, Converged) else state_answer(with_error(found))
    )
    return Answer(answer, _text(title, answer, body=links_are_body(model)))


def not_found(reason: NotFound, title: str, units: Units) -> Answer:
    """Return the answer that there is no state, with the advice what to try."""
    answer = {
        "status": "not found",
        "units": units.names(),
        "reason": reason.reason,
        "residual": reason.residual,
    }
    lines = [f"{title} not found: {reason.reason}", *units_lines(units.names())]
    return Answer(answer, "\n".join(lines))


def state_answer(state: Solved) -> dict[str, Any]:
    """Return a state in plain JSON types."""
    shared = {
        "status": "done",
        "units": state.model.units.names(),
        "force": state.force,
        **force_in(state.model.units, state.force),
        "links": state.model.links,
        "frequency": state.frequency,
        "error": state.error,
        "error_of": BODY,
        "solver_error": None if isinstance(state, Equilibrium) else state.solver_error,
        "stable": state.stable,
        "leading_rate": state.leading_rate,
        "residual": state.residual,
        "power_balance_error": state.power_balance_error,
    }
    extents = extents_as_json(state)
    if isinstance(state, Equilibrium):
        return shared | {"kind": "equilibrium"} | extents
    if isinstance(state, Spinning):
        return shared | {"kind": "spinning"} | extents | {"trivial_rate": abs(state.trivial)}
    swinging = extents | {"trivial_multiplier_error": max(state.trivial)}
    if isinstance(state, Periodic):
        period = {
            "period": state.period,
            "turn": state.angle,
            "time_error": state.time_error,
        }
        return shared | {"kind": "periodic"} | swinging | period
    return shared | {
        "kind": "flapping",
        **swinging,
        "leading_rate_in_plane": state.leading_rate_in_plane,
        "leading_rate_out_of_plane": state.leading_rate_out_of_plane,
        "time_error": state.time_error,
    }


def _limit_answer(limit: Converged[Any]) -> dict[str, Any]:
    """Return what a state converges to, named as for a single number of links."""
    answer = state_answer(limit.finest)
    for name, value in limit.values.items():
        owner, _, part = name.rpartition("_")
        if part in ("min", "max", "mean"):
            answer[owner] = answer[owner] | {part: value}
        else:
            answer[name] = value
    rates = [value for name, value in limit.values.items() if name.startswith("leading_rate")]
    error = limit.errors["frequency"] + (answer["solver_error"] or 0.0)
    return answer | {
        "leading_rate": max(rates),
        "stable": max(rates) < 0.0,
        "links": list(limit.links),
        "error": error,
        "errors": {**limit.errors, "frequency": error},
    }


def _links(links: int | list[int], *, body: bool) -> str:
    if isinstance(links, list):
        return f"extrapolated from {', '.join(map(str, links))}"
    return f"{links}" if body else f"{links}; {CURE}"


def _text(title: str, answer: dict[str, Any], *, body: bool) -> str:
    errors = answer.get("errors", {}) | {"frequency": answer["error"]}
    word = "stable" if answer["stable"] else "unstable"
    lines = [f"{title}: {answer['kind']}, {word}", *units_lines(answer["units"])]
    known = _UNITS | {"bending_energy": answer["units"]["energy"]}
    for name, value in answer.items():
        unit = next((unit for start, unit in known.items() if name.startswith(start)), None)
        if unit is None or value is None:
            continue
        if isinstance(value, dict):
            parts = [
                f"{part} {with_digits(one, errors.get(f'{name}_{part}'))}"
                for part, one in value.items()
            ]
            said = ", ".join(parts)
        else:
            said = with_digits(value, errors.get(name))
        lines.append(f"  {name.replace('_', ' '):<26} {said} {unit}")
    lines.append(f"  {'links':<26} {_links(answer['links'], body=body)}")
    lines.append(f"  {'residual':<26} {answer['residual']:.1g}")
    return "\n".join(lines)
