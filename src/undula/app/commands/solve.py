"""`undula solve`: parameters at which a target is met, in plain JSON types and as text."""

from typing import Any

from undula.analysis.parameters import FORCE
from undula.analysis.solvers.inverse.solutions import Solution, Solutions
from undula.analysis.solvers.inverse.solve_for import solve_for
from undula.analysis.states.branch_json import extents_as_json
from undula.interrupts import interruptible
from undula.models.model import Model
from undula.models.scales import Scales
from undula.models.units import Units
from undula.terminal.numbers import BODY, digits, on_links, with_error
from undula.terminal.output import Answer
from undula.terminal.physical import of_parameter, scales_lines, with_physical
from undula.terminal.progress import located
from undula.terminal.units_text import force_in, units_lines


def answer_solve(
    model: Model,
    kind: str,
    target: tuple[str, float],
    parameter: str,
    between: tuple[float, float] | None,
    *,
    title: str,
    scales: Scales | None = None,
) -> Answer:
    """Return the answer to an inverse question.

    Parameters
    ----------
    model : Model
        The model; its own value of the parameter is where a branch begins.
    kind : str
        Kind of state, or name of a threshold.
    target : (str, float)
        Name of the quantity, and its value.
    parameter : str
        Name of the parameter to solve for.
    between : (float, float) or None
        Range of the parameter; None for the default.
    title : str
        Beginning of the text.
    scales : Scales or None
        SI values of the dimensionless units; None for an answer without physical units.

    Raises
    ------
    InputError
        The question cannot be asked of the model.
    """
    with interruptible() as interrupted, located(f"solving {kind}", parameter) as progress:
        solutions = solve_for(
            model,
            kind,
            by=parameter,
            between=between,
            progress=progress,
            stop=interrupted,
            **dict([target]),
        )
        early = interrupted()
    status = "interrupted" if early else "done" if solutions else "not found"
    answer = {"status": status, **solutions_answer(solutions, model.units)}
    text = _text(title, solutions, model.units, scales)
    return Answer(with_physical(answer, "solve", scales), text)


def solutions_answer(solutions: Solutions, units: Units) -> dict[str, Any]:
    """Return the solutions of a question in plain JSON types."""
    least, most = solutions.quantity_range or (None, None)
    return {
        "units": units.names(),
        "kind": solutions.kind,
        "quantity": solutions.quantity,
        "target": solutions.target,
        "parameter": solutions.parameter,
        "between": list(solutions.between),
        "least": least,
        "most": most,
        "solutions": [_solution_answer(solution, units) for solution in solutions],
        "reason": solutions.reason,
        "not_searched": solutions.not_searched,
    }


def _solution_answer(solution: Solution, units: Units) -> dict[str, Any]:
    further = force_in(units, solution.value) if solution.parameter == FORCE else {}
    shared = {
        solution.parameter: solution.value,
        "value": solution.value,
        **further,
        "error": solution.error,
        "error_of": BODY,
        "solver_error": solution.solver_error,
        "links": solution.links,
        "slope": solution.slope,
    }
    if solution.threshold is not None:
        return shared | {
            "force": solution.threshold.value,
            "frequency": solution.threshold.frequency,
            "second_frequency": solution.threshold.second_frequency,
            "bifurcation": solution.threshold.bifurcation,
        }
    state = solution.state
    assert state is not None  # a solution is either a threshold or a state
    return shared | {
        "frequency": state.frequency,
        "stable": state.stable,
        "leading_rate": state.leading_rate,
        **extents_as_json(state),
    }


def _text(title: str, solutions: Solutions, units: Units, scales: Scales | None) -> str:
    low, high = solutions.between
    lines = [
        f"{title}: {solutions.kind} with {solutions.quantity} {solutions.target:.8g}, solved for"
        f" {solutions.parameter} between {low:.6g} and {high:.6g}",
        *units_lines(units.names(), units.forces if solutions.parameter == FORCE else ()),
        *scales_lines(scales),
        *(_line(solution, units, scales) for solution in solutions),
    ]
    if solutions.reason is not None:
        lines.append(f"  none: {solutions.reason}")
    elif solutions.not_searched is not None:
        lines.append(f"  not searched: {solutions.not_searched}")
    return "\n".join(lines)


def _line(solution: Solution, units: Units, scales: Scales | None) -> str:
    """Return a solution with its error, against the body if that is known, and its state."""
    of_force = solution.parameter == FORCE
    place = _place(solution, units.force if of_force else "")
    bracketed = units.bracketed(solution.value) if of_force else ""
    bracketed += of_parameter(scales, solution.parameter, solution.value, error=solution.error)
    line = f"  {solution.parameter} {place}{bracketed}: {_motion(solution)}"
    if solution.error in (None, solution.solver_error):
        return line
    number = digits(solution.value, solution.solver_error)
    return f"{line}; on {solution.links} links {number}, solved to {solution.solver_error:.1g}"


def _place(solution: Solution, unit: str) -> str:
    if solution.error is None and solution.links is not None:
        return on_links(solution.value, solution.solver_error, solution.links, unit)
    return f"{with_error(solution.value, solution.error)} {unit}".rstrip()


def _motion(solution: Solution) -> str:
    """Return the state or the threshold of a solution in a few words."""
    if solution.threshold is not None:
        found = solution.threshold
        return f"force {found.value:.8g} ({found.bifurcation}), {found.frequency:.7g} cycles per T"
    state = solution.state
    assert state is not None  # a solution is either a threshold or a state
    word = f", {'stable' if state.stable else 'unstable'}, leading rate {state.leading_rate:.5g} /T"
    # Where the leading rate is 0 its sign is round-off.
    further = "" if solution.quantity.startswith("leading_rate") else word
    return f"{state.frequency:.7g} cycles per T{further}"
