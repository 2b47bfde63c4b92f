"""Sensitivities against central differences of converged solutions."""

import time
from typing import Any

import numpy as np
import pytest

import undula as un
from refusal import complaint
from undula.analysis.parameters import changed, value_of
from undula.analysis.sensitivity.sensitivities import sensitivities
from undula.analysis.solvers.quantities import quantities_of
from undula.analysis.solvers.state_kinds import kind_of_state
from undula.numerics.continuation.arclength import solve_at

TABLE = un.TableLoad(75.0, s=(0.0, 0.5, 1.0), density=(1.0, 1.5, 2.0))
#: Agreement with differences of the fourth order, relative to the derivative or to 1 per cent of
#: the quantity: both sides have an error of some 1e-8 by round-off of exponents.
AGREEMENT = 1e-7
#: Step of the differences, relative to the parameter or to 1.
STEP = 1e-3


def fourth_order(values: list[float], step: float) -> float:
    low, below, above, high = values
    return (low - 8.0 * below + 8.0 * above - high) / (12.0 * step)


def solved_nearby(state: Any, parameter: str) -> dict[str, float]:
    """Return the derivatives of a state by differences of states that are solved for anew."""
    kind, value = kind_of_state(state), value_of(state.model, parameter)
    step = STEP * max(1.0, abs(value))
    family, u = kind.family(state, parameter, 1.0), kind.unknowns(state)
    rows = []
    for place in (-2, -1, 1, 2):
        there = value + place * step
        solution = solve_at(family.problem, u, there)
        assert solution is not None
        rows.append(quantities_of(family.judge(family.problem, solution[0], there)))
    return {name: fourth_order([row[name] for row in rows], step) for name in rows[0]}


def assert_alike(slopes: Any, expected: dict[str, float], quantities: Any) -> None:
    for name, value in expected.items():
        scale = max(abs(value), 0.01 * abs(quantities[name]))
        assert abs(slopes[name] - value) <= AGREEMENT * scale, name


def found(model: Any, kind: str) -> Any:
    state = un.find(model, kind)
    assert state
    return state


def test_of_a_spinning_state_by_every_parameter_of_model_load_and_table() -> None:
    state = found(un.Filament(8, TABLE), "spinning")
    slopes = sensitivities(state)
    assert {"load.force", "model.drag_ratio", "load.density[1]"} <= set(slopes)
    for parameter in slopes:
        assert_alike(slopes[parameter], solved_nearby(state, parameter), slopes.quantities)


@pytest.mark.slow
def test_of_a_bent_filament_by_its_curvature_and_its_anisotropy() -> None:
    curved = un.Filament(6, un.TipLoad(10.0), natural_curvature=(1.0, 0.0), bending_ratio=1.2)
    state = found(curved, "equilibrium")
    names = ["model.natural_curvature.k1", "model.bending_ratio", "load.force"]
    slopes = sensitivities(state, parameters=names)
    for parameter in names:
        assert_alike(slopes[parameter], solved_nearby(state, parameter), slopes.quantities)


@pytest.mark.slow
def test_of_flapping() -> None:
    state = found(un.Filament(8, un.LinearLoad(120.0, 0.5)), "flapping")
    slopes = sensitivities(state)
    for parameter in ("load.force", "load.slope", "model.drag_ratio"):
        expected = solved_nearby(state, parameter)
        # The least energy lies between the instants at which it is known.
        del expected["bending_energy_min"]
        assert_alike(slopes[parameter], expected, slopes.quantities)


def test_of_the_onset_of_the_continuum_and_of_links() -> None:
    model = un.Filament(8, TABLE)
    for method in (None, "discrete"):
        onset = un.threshold(model, "onset", method=method)
        slopes = sensitivities(onset, parameters=["load.density[0]", "load.density[1]"])
        for parameter, row in slopes.items():
            value = value_of(model, parameter)
            places = [value + place * STEP for place in (-2, -1, 1, 2)]
            nearby = [
                un.threshold(changed(model, parameter, place), "onset", method=method)
                for place in places
            ]
            for name in ("value", "frequency"):
                expected = fourth_order([getattr(one, name) for one in nearby], STEP)
                assert row[name] == pytest.approx(expected, rel=AGREEMENT, abs=1e-7)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["spinning-lost", "flapping-gained"])
def test_of_a_threshold_of_solved_states(kind: str) -> None:
    model = un.Filament(6, un.TipLoad(75.0))
    known = un.threshold(model, kind)
    row = sensitivities(known, parameters=["model.drag_ratio"])["model.drag_ratio"]
    places = [2.0 + place * 0.01 for place in (-2, -1, 1, 2)]
    nearby = [
        un.threshold(changed(model, "model.drag_ratio", place), kind, near=known)
        for place in places
    ]
    # A bifurcation is located to 1e-9 of the force's scale of some 20.
    expected = fourth_order([float(one.value or np.nan) for one in nearby], 0.01)
    assert row["value"] == pytest.approx(expected, rel=1e-5)


def test_the_cost_of_a_parameter_is_that_of_a_few_newton_steps() -> None:
    state = found(un.Filament(16, un.TipLoad(75.0)), "spinning")
    kind, near = kind_of_state(state), changed(state.model, "load.force", 75.01)

    def seconds(work: Any) -> float:
        begin = time.process_time()
        for _ in range(5):
            work()
        return time.process_time() - begin

    work = lambda: sensitivities(state, parameters=["load.force"])  # noqa: E731
    again = lambda: kind.find(near, state)  # noqa: E731
    seconds(work), seconds(again)
    # Measured 1.0 to 1.1; a busy machine has been seen to double a ratio.
    assert min(seconds(work) for _ in range(3)) < 3.0 * min(seconds(again) for _ in range(3))


def test_what_cannot_be_differentiated_is_refused_in_a_sentence() -> None:
    state = found(un.Filament(6, un.TipLoad(75.0)), "spinning")
    assert "take load.force" in complaint(lambda: sensitivities(state, parameters=["load.tip"]))
    assert "rotational symmetry" in complaint(
        lambda: sensitivities(state, parameters=["model.natural_curvature.k1"])
    )
    assert "no state and no threshold" in complaint(lambda: sensitivities(state.model))  # type: ignore[arg-type]
    never = un.threshold(un.Filament(6, un.TipLoad(75.0)), "onset", up_to=10.0)
    assert "no value" in complaint(lambda: sensitivities(never))
