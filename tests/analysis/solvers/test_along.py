"""A branch keeps its unknowns wherever its parameter leads, or is refused before anything runs."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from commands import Ask, refused
from refusal import complaint
from undula.analysis.linear.straight_branch import follow_straight
from undula.analysis.parameters import changed, value_of
from undula.analysis.ramps.ramp import Ramp
from undula.analysis.solvers import branches
from undula.analysis.solvers.branches import follow
from undula.analysis.solvers.equilibrium import find_equilibrium
from undula.analysis.solvers.spinning import find_spinning
from undula.analysis.solvers.state_kinds import Kind
from undula.analysis.solvers.thresholds import threshold_curve
from undula.analysis.states.records import Spinning
from undula.analysis.states.relative_equilibrium import TurningShape
from undula.app.commands import follow as following
from undula.app.commands.follow import follow_along
from undula.errors import InputError
from undula.inputs.ranges import Way
from undula.models.chain import Chain
from undula.models.filament import Filament
from undula.models.loads.analytic import LinearLoad, PointLoad, TipLoad
from undula.models.loads.beads import BeadLoad
from undula.models.loads.power import PowerLoad

LINKS = 6
BODIES = {
    "tip": Filament(LINKS, TipLoad(60.0)),
    "point": Filament(LINKS, PointLoad(60.0, 0.8)),
    "linear": Filament(LINKS, LinearLoad(120.0, 0.0)),
    "power": Filament(LINKS, PowerLoad(120.0, 1.0)),
    "weak": Filament(LINKS, TipLoad(60.0), inextensibility="weak"),
    "curved": Filament(LINKS, TipLoad(60.0), twist="elastic", natural_curvature=(1.0, 0.0)),
    "chain": Chain(4, TipLoad(20.0)),
    "beads": Chain(4, BeadLoad(20.0)),
}
#: Ways through special values of each parameter, and to the ends of its range.
WAYS = {
    "load.force": [(60.0, 0.0), (60.0, 70.0)],
    "load.position": [(0.5, 1.0), (1.0, 0.5)],
    "load.slope": [(-1.0, 1.0), (1.0, -1.0)],
    "load.exponent": [(0.0, 2.0), (2.0, 0.0)],
    "model.drag_ratio": [(2.0, 1.0), (1.0, 2.0)],
    "model.tensile_stiffness": [(4e4, 100.0), (200.0, 4e4)],
    "model.twist_stiffness": [(1.0, 0.1), (0.1, 1.0)],
    "model.base_spring": [(1.0, 0.1), (0.1, 1.0)],
    "model.bead_drag": [(1.0, 2.0), (2.0, 1.0)],
    "model.bending_ratio": [(1.0, 1.5), (1.5, 1.0), (0.9, 1.1), (1.1, 0.9)],
    "model.natural_curvature.k1": [(0.0, 1.0), (1.0, 0.0), (-1.0, 1.0)],
    "model.natural_curvature.k2": [(0.0, 1.0), (1.0, 0.0), (1.0, -1.0)],
}
#: Those that hold a filament in one direction, but at one value.
HOLDING = [name for name in WAYS if name.startswith(("model.bending", "model.natural"))]
holding = pytest.mark.parametrize(
    ("parameter", "start", "end"), [(name, *way) for name in HOLDING for way in WAYS[name]]
)


def offered(body: Any) -> list[str]:
    """Return the parameters that a body is said to be followed along, by the complaint itself."""
    told = complaint(lambda: value_of(body, "nothing"))
    return told.partition("take ")[2].split(" or ")


def ways() -> Iterator[tuple[str, str, float, float]]:
    for name, body in BODIES.items():
        for parameter in offered(body):
            for start, end in WAYS[parameter]:
                yield name, parameter, start, end


def told(body: Any, kind: str, parameter: str, start: float, end: float) -> str:
    """Return how following ended, having checked that all states are of one size."""
    try:
        answer, branch = follow_along(
            body, kind, Way(parameter, start, end), converge=False, title="a body"
        )
    except InputError:
        return "refused"
    if branch is not None and hasattr(branch, "states"):
        shapes = {np.shape(state.unknowns)[-1] for state in branch.states}
        models = {type(state.model.system) for state in branch.states}
        assert len(shapes) == len(models) == 1
        assert all(np.isfinite(state.unknowns).all() for state in branch.states)
    return str(answer.answer["status"])


@pytest.mark.parametrize(("name", "parameter", "start", "end"), list(ways()))
def test_what_is_offered_can_be_followed_or_is_refused(
    name: str, parameter: str, start: float, end: float
) -> None:
    body = BODIES[name]
    held = parameter in HOLDING or name == "curved"
    for kind in ("spinning", "equilibrium"):
        found = told(body, kind, parameter, start, end)
        if kind == "spinning":
            assert (found == "refused") == held, kind
        else:
            # Weak links have no directors.
            assert (found == "done") == (held and name != "weak"), kind


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["flapping", "periodic", "straight"])
@pytest.mark.parametrize(("name", "parameter", "start", "end"), list(ways()))
def test_the_same_of_states_that_take_long(
    kind: str, name: str, parameter: str, start: float, end: float
) -> None:
    assert told(BODIES[name], kind, parameter, start, end) in (
        "done",
        "stopped early",
        "not found",
        "refused",
    )


@holding
@pytest.mark.parametrize("kind", ["straight", "spinning", "flapping"])
def test_what_is_no_state_of_a_held_body_is_refused_before_anything_runs(
    kind: str, parameter: str, start: float, end: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    def never(*_: Any) -> Any:
        raise AssertionError("something ran")

    for module in (following, branches):
        monkeypatch.setattr(module, "kind_by_name", lambda _: Kind(*[never] * 5))
    told = complaint(
        lambda: follow_along(
            BODIES["tip"], kind, Way(parameter, start, end), converge=False, title=""
        )
    )
    assert parameter in told
    assert "follow equilibrium or periodic" in told


@holding
def test_an_equilibrium_is_the_same_on_a_branch_as_by_itself(
    parameter: str, start: float, end: float
) -> None:
    body = changed(BODIES["tip"].with_(keep_directors=True), parameter, start)
    branch = follow(find_equilibrium(body), parameter, end)
    assert branch.complete
    alone = changed(BODIES["tip"], parameter, end)
    if alone.axisymmetric:
        # A shape at rest without curvature is straight.
        assert branch.states[-1].tip_radius.max < 1e-12
    else:
        found = find_equilibrium(alone)
        # Newton's method leaves round-off of both.
        assert branch.states[-1].tip_radius.mean == pytest.approx(found.tip_radius.mean, abs=1e-9)
        assert branch.states[-1].leading_rate == pytest.approx(found.leading_rate, rel=1e-6)


def test_a_state_without_directors_gets_them_or_cannot_be_followed() -> None:
    state = find_spinning(BODIES["tip"])
    assert isinstance(state, Spinning)
    assert "model.bending_ratio" in complaint(lambda: follow(state, "model.bending_ratio", 1.5))


def test_equations_of_another_size_are_refused_and_not_evaluated() -> None:
    state = find_spinning(BODIES["tip"])
    problem = TurningShape(state.model, "model.bending_ratio", state.unknowns, 1.0)
    with pytest.raises(ValueError, match="not fit"):
        problem.evaluate(np.append(state.unknowns, state.rate), 1.0)


def test_directors_that_are_not_needed_change_nothing_about_a_body() -> None:
    plain = Filament(8, TipLoad(75.0))
    with_directors = Filament(8, TipLoad(75.0), keep_directors=True)
    assert type(plain.system) is not type(with_directors.system)
    x = plain.straight() + 0.01 * np.tile([1.0, -0.5, 0.0], 8) * np.arange(1.0, 25.0)
    x = plain.admissible(x)
    # Both to round-off of rates of this size.
    assert with_directors.rhs(x) == pytest.approx(plain.rhs(x), rel=1e-9, abs=1e-8)
    assert with_directors.energy(x) == pytest.approx(plain.energy(x), rel=1e-12)
    for one, other in zip(with_directors.linearised(), plain.linearised(), strict=True):
        np.testing.assert_array_equal(one, other)


def test_a_curve_of_onsets_is_smooth_through_the_body_that_bends_alike() -> None:
    values = (-0.5, 0.0, 0.5)
    found = threshold_curve(BODIES["tip"], "onset", "model.natural_curvature.k1", values)
    forces = [one.value for one in found]
    assert forces[0] == pytest.approx(forces[2], rel=1e-8)  # located to 1e-9 of some hundreds
    # A curvature changes it by its square, not by another number of links.
    assert abs(forces[1] / forces[0] - 1.0) < 0.01


@pytest.mark.parametrize("name", ["spinning-lost", "flapping-gained", "flapping-lost"])
def test_thresholds_of_turned_states_are_refused_before_the_first(name: str) -> None:
    told = complaint(
        lambda: threshold_curve(BODIES["tip"], name, "model.bending_ratio", (1.0, 1.2))
    )
    assert "model.bending_ratio" in told


@holding
def test_the_straight_state_and_its_thresholds_name_the_parameter(
    parameter: str, start: float, end: float
) -> None:
    from undula.analysis.linear.stability import critical_curve

    body = BODIES["tip"]
    assert parameter in complaint(lambda: follow_straight(body, parameter, start, end))
    assert parameter in complaint(lambda: critical_curve(body, parameter, [start, end]))


@holding
def test_steps_along_a_parameter_are_runs_by_themselves(
    parameter: str, start: float, end: float
) -> None:
    course = Ramp(parameter, (start, end))
    alone = [changed(BODIES["tip"], parameter, value) for value in (start, end)]
    assert course.models(BODIES["tip"]) == alone


@pytest.mark.parametrize("way", ["model.bending_ratio=1:1.5", "model.natural_curvature.k1=0:1"])
def test_the_command_refuses_in_one_sentence(way: str, ask: Ask) -> None:
    told = refused(ask("follow", "spinning", "--set", "model.segments=12", "--along", way))
    assert way.partition("=")[0] in told
