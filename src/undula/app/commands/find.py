"""`undula find`: solve for a state, and answer in plain JSON types and for people."""

from typing import Any

from undula.analysis.solvers.state_kinds import Solved, extrapolate, kind_by_name, with_error
from undula.analysis.states.branch_json import extents_as_json
from undula.analysis.states.extrapolation import Converged, links_are_body
from undula.analysis.states.not_found import NotFound
from undula.analysis.states.periodic_record import Periodic
from undula.analysis.states.records import Equilibrium, Spinning
from undula.app.commands.find_start import SearchStart
from undula.models.scales import Quantity, Scales
from undula.models.units import FILAMENT_UNITS, Units
from undula.terminal.numbers import BODY, CURE
from undula.terminal.numbers import with_error as with_digits
from undula.terminal.output import Answer
from undula.terminal.physical import bracketed, scales_lines, with_physical
from undula.terminal.progress import searching
from undula.terminal.sensitivities_text import with_sensitivities
from undula.terminal.units_text import force_in, units_lines

#: Units of quantities by the beginning of their names; those of energies depend on the model.
_UNITS = {
    "frequency": "cycles per T",
    "tip_radius": "L",
    "tip_height": "L",
    "leading_rate": "/T",
    "period": "T",
    "turn": "rad",
}
#: Quantities with a physical unit, by the unit of a filament.
_QUANTITIES: dict[str, Quantity] = {
    "cycles per T": "frequency",
    "L": "length",
    "/T": "rate",
    "T": "time",
    FILAMENT_UNITS.energy: "energy",
}


def find_state(
    start: SearchStart, kind: str, *, converge: bool, derivatives: bool = False
) -> Answer:
    """Solve for a state.

    Parameters
    ----------
    start
        The model and the start of the search.
    kind
        Name of the kind of state.
    converge
        If true, extrapolate to many links.
    derivatives
        If true, add the derivatives of all numbers by all parameters, on the finest links.

    Raises
    ------
    InputError
        The kind is unknown, or the model has no limit of many links.
    """
    model, title, solver = start.model, start.title, kind_by_name(kind)
    with searching(f"finding {kind}") as show:
        result: Any = start.motion()
        if converge and not isinstance(result, NotFound):
            result = extrapolate(model, kind, result, progress=show)
        elif result is None:
            result = solver.find(model)
    if isinstance(result, NotFound):
        return _with_physical(not_found(result, f"{title}: {kind}", model.units), start.scales)
    answer = (
        _limit_answer(result) if isinstance(result, Converged) else state_answer(with_error(result))
    )
    text = _text(title, answer, start.scales, body=links_are_body(model))
    whole = Answer(answer, text)
    if derivatives:
        solved = result.finest if isinstance(result, Converged) else result
        whole = with_sensitivities(whole, solved)
    return _with_physical(whole, start.scales)


def _with_physical(answer: Answer, scales: Scales | None) -> Answer:
    return Answer(with_physical(answer.answer, "find", scales), answer.text)


def not_found(failure: NotFound, title: str, units: Units) -> Answer:
    """Return the answer on a failed search, with its advice."""
    answer = {
        "status": "not found",
        "units": units.names(),
        "reason": failure.reason,
        "residual": failure.residual,
    }
    lines = [f"{title} not found: {failure.reason}", *units_lines(units.names())]
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
    """Return the limit of a state in plain JSON types, under the keys of a single state."""
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


def _text(title: str, answer: dict[str, Any], scales: Scales | None, *, body: bool) -> str:
    errors = answer.get("errors", {}) | {"frequency": answer["error"]}
    word = "stable" if answer["stable"] else "unstable"
    units = [*units_lines(answer["units"]), *scales_lines(scales)]
    lines = [f"{title}: {answer['kind']}, {word}", *units]
    by_name = _UNITS | {"bending_energy": answer["units"]["energy"]}
    for name, value in answer.items():
        unit = next((unit for start, unit in by_name.items() if name.startswith(start)), None)
        if unit is None or value is None:
            continue
        if isinstance(value, dict):
            parts = [
                f"{part} {with_digits(number, errors.get(f'{name}_{part}'))}"
                for part, number in value.items()
            ]
            numbers, shown, error = ", ".join(parts), [value["min"], value["max"]], None
        else:
            error = errors.get(name)
            numbers, shown = with_digits(value, error), [value]
        quantity = _QUANTITIES.get(unit)
        physical = bracketed(scales, quantity, *shown, error=error) if quantity else ""
        lines.append(f"  {name.replace('_', ' '):<26} {numbers} {unit}{physical}")
    lines.append(f"  {'links':<26} {_links(answer['links'], body=body)}")
    lines.append(f"  {'residual':<26} {answer['residual']:.1g}")
    return "\n".join(lines)
