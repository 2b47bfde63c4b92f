"""Inverse questions: each answer put back in gives the target, and no solution is missed."""

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import undula as un
from refusal import complaint
from undula.analysis.parameters import changed
from undula.analysis.solvers.inverse.solutions import Solution, Solutions
from undula.analysis.solvers.inverse.solve_for import solve_for

SIX = un.Filament(6, un.TipLoad(75.0))
FOUR = SIX.with_(segments=4)
# Its spinning begins downwards at 101.7 and turns in a fold at 90.5.
FOLDED = un.Filament(12, un.PointLoad(97.0, 0.4))
CURVED = un.Filament(6, un.TipLoad(20.0), natural_curvature=(1.0, 0.0))
#: Relative difference of an answer that is put back in from its target.
ACCURACY = 1e-8


def put_back(model: Any, kind: str, solution: Solution) -> Any:
    """Return the state that is solved for at a solution, without a guess."""
    state = un.find(changed(model, solution.parameter, solution.value), kind)
    assert state, state.reason
    return state


def quantity(state: Any, name: str) -> float:
    value = getattr(state, name)
    return float(getattr(value, "mean", value))


def random_targets() -> Iterator[tuple[str, float, str]]:
    """Yield twenty quantities with a value within their range over forces, or drag ratios."""
    rng = np.random.default_rng(1)
    low, high = (un.find(SIX.with_(force=force), "spinning") for force in (50.0, 110.0))
    few, much = (un.find(SIX.with_(drag_ratio=ratio), "spinning") for ratio in (1.2, 3.0))
    names = ("frequency", "period", "bending_energy", "tip_height", "tip_radius")
    for name in names:
        for parameter, ends in (("load.force", (low, high)), ("model.drag_ratio", (few, much))):
            first, last = (quantity(state, name) for state in ends)
            for share in rng.uniform(0.05, 0.95, size=2):
                yield name, first + share * (last - first), parameter


@pytest.fixture(scope="module")
def targets() -> list[tuple[str, float, str]]:
    return list(random_targets())


def test_twenty_answers_put_back_in_give_their_targets(
    targets: list[tuple[str, float, str]],
) -> None:
    ranges = {"load.force": (40.0, 120.0), "model.drag_ratio": (1.1, 3.5)}
    assert len(targets) == 20
    for name, target, parameter in targets:
        solutions = solve_for(
            SIX, "spinning", by=parameter, between=ranges[parameter], **{name: target}
        )
        assert solutions, str(solutions)
        for solution in solutions:
            state = put_back(SIX, "spinning", solution)
            assert quantity(state, name) == pytest.approx(target, rel=ACCURACY), solution
            assert quantity(solution.state, name) == pytest.approx(target, rel=ACCURACY)
            assert solution.solver_error < 1e-6 * solution.value


def test_a_target_on_both_sides_of_a_fold_has_two_solutions() -> None:
    solutions = solve_for(FOLDED, "spinning", leading_rate=30.0, by="load.force", between=(60, 110))
    assert len(solutions) == 2
    values = [solution.value for solution in solutions]
    assert values == sorted(values)
    # Between the fold and the onset there are two states, of which the lower one is unstable.
    assert 90.45 < values[0] < values[1] < 101.71
    for solution in solutions:
        assert solution.state.leading_rate == pytest.approx(30.0, rel=ACCURACY)
    slopes = [solution.slope for solution in solutions]
    assert slopes[0] * slopes[1] < 0.0


def test_the_change_of_stability_at_a_fold_is_the_fold() -> None:
    (solution,) = solve_for(
        FOLDED, "spinning", leading_rate=0.0, by="load.force", between=(60.0, 110.0)
    )
    branch = un.follow_from_onset(FOLDED, "spinning", 105.0)
    (fold,) = (point for point in branch.bifurcations if point.kind == "fold")
    # The fold is located to 1e-9 of its way.
    assert solution.value == pytest.approx(fold.value, abs=1e-7)
    assert solution.error is not None


def test_targets_next_to_an_extremum_between_points_are_met_on_both_sides() -> None:
    branch = un.follow_from_onset(FOLDED, "spinning", 110.0)
    largest = max(state.leading_rate for state in branch.states)
    question = {"by": "load.force", "between": (92.0, 110.0)}
    # The largest rate lies between the points of the branch, above that at any of them.
    near = [
        solve_for(FOLDED, "spinning", leading_rate=largest + more, **question)
        for more in (0.01, 1.0)
    ]
    assert [len(solutions) for solutions in near] == [2, 0]
    for solution in near[0]:
        assert solution.state.leading_rate == pytest.approx(largest + 0.01, rel=ACCURACY)


def test_the_change_of_stability_is_the_threshold() -> None:
    model = SIX.with_(segments=10)
    question = {"by": "load.force", "between": (100.0, 200.0)}
    (solution,) = solve_for(model, "spinning", leading_rate=0.0, **question)
    lost = un.threshold(model, "spinning-lost")
    # The threshold is located to 1e-9 of the way to 20 times the onset.
    assert solution.value == pytest.approx(lost.value, abs=1e-6)
    # Both errors are those of the links, by different searches.
    assert solution.error == pytest.approx(lost.error, rel=1e-2)


@pytest.mark.parametrize(
    ("by", "between"),
    [
        ("load.force", (60.0, 90.0)),
        pytest.param("model.drag_ratio", (1.5, 2.5), marks=pytest.mark.slow),
    ],
)
def test_the_error_is_about_the_distance_to_many_links(
    by: str, between: tuple[float, float]
) -> None:
    few, many = (
        solve_for(SIX.with_(segments=count), "spinning", frequency=85.0, by=by, between=between)[0]
        for count in (10, 40)
    )
    # The leading term of the error alone, with a sixteenth of it left in the other.
    assert few.error == pytest.approx(abs(few.value - many.value), rel=0.3)
    assert many.error < 0.1 * few.error


def test_the_target_of_a_threshold_is_met() -> None:
    by, between = "model.drag_ratio", (1.5, 2.5)
    model = SIX.with_(segments=10)
    target = 1.05 * un.threshold(model, "spinning-lost").value
    (solution,) = solve_for(model, "spinning-lost", value=target, by=by, between=between)
    again = un.threshold(changed(model, by, solution.value), "spinning-lost")
    assert again.value == pytest.approx(target, rel=ACCURACY)
    assert solution.threshold.value == pytest.approx(target, rel=ACCURACY)
    # The error of the force over the slope.
    assert solution.error == pytest.approx(again.error / abs(solution.slope), rel=1e-2)


def test_an_onset_of_the_continuum_is_solved_for_to_round_off() -> None:
    model = un.Filament(8, un.LinearLoad(75.0, slope=0.0))
    half = un.onset(model.with_(slope=0.5)).force
    (solution,) = solve_for(model, "onset", value=half, by="load.slope", between=(-1.0, 1.0))
    assert solution.value == pytest.approx(0.5, abs=1e-9)
    assert solution.links is None
    assert solution.error < 1e-8
    assert solution.state is None


def test_a_bent_equilibrium_is_solved_for() -> None:
    for by, between in (("load.force", (0.0, 30.0)), ("model.natural_curvature.k1", (0.2, 3.0))):
        (solution,) = solve_for(CURVED, "equilibrium", tip_radius=0.3, by=by, between=between)
        state = put_back(CURVED, "equilibrium", solution)
        assert state.tip_radius.mean == pytest.approx(0.3, rel=ACCURACY)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "target", "accuracy"),
    # An extreme over a period depends on the instants of its samples.
    [
        ("frequency", 50.0, ACCURACY),
        ("bending_energy_mean", 2.0, ACCURACY),
        ("tip_height_min", 0.7, 1e-6),
    ],
)
def test_flapping_is_solved_for(name: str, target: float, accuracy: float) -> None:
    solutions = solve_for(FOUR, "flapping", by="load.force", between=(36.0, 70.0), **{name: target})
    assert len(solutions) == 1, str(solutions)
    state = un.find(FOUR.with_(force=solutions[0].value), "flapping")
    achieved = {
        "frequency": state.frequency,
        "bending_energy_mean": state.bending_energy.mean,
        "tip_height_min": state.tip_height.min,
    }
    assert achieved[name] == pytest.approx(target, rel=accuracy)


def test_a_target_at_an_end_of_the_range_or_at_the_own_value_is_one_solution() -> None:
    for force in (60.0, 75.0, 90.0):
        frequency = un.find(SIX.with_(force=force), "spinning").frequency
        question = {"by": "load.force", "between": (60.0, 90.0)}
        (solution,) = solve_for(SIX, "spinning", frequency=frequency, **question)
        assert solution.value == pytest.approx(force, rel=1e-9)
    own = un.find(SIX, "spinning").frequency
    (solution,) = solve_for(SIX, "spinning", frequency=own, by="model.drag_ratio")
    assert solution.value == pytest.approx(2.0, rel=1e-9)


# ---------------------------------------------------------------- targets that are not met


def test_a_target_that_is_not_met_is_an_answer_with_the_range_of_the_quantity() -> None:
    none = solve_for(SIX, "spinning", frequency=1200.0, by="load.force", between=(50.0, 90.0))
    assert not none
    assert (len(none), list(none)) == (0, [])
    ends = [un.find(SIX.with_(force=force), "spinning").frequency for force in (50.0, 90.0)]
    assert none.quantity_range == pytest.approx(ends, rel=1e-9)
    assert none.reason.startswith(
        f"spinning between load.force 50 and 90 has frequency {ends[0]:.6g} to {ends[1]:.6g}"
    )
    assert none.not_searched is None


def test_a_range_below_the_onset_says_where_the_states_begin() -> None:
    none = solve_for(SIX, "spinning", frequency=30.0, by="load.force", between=(10.0, 20.0))
    onset = un.onset(SIX, method="discrete").force
    assert none.reason.startswith("spinning begins at load.force ")
    begins = float(none.reason.split("load.force ")[1].split(";")[0])
    assert begins == pytest.approx(onset, rel=1e-3)


def test_a_state_that_does_not_exist_is_an_answer() -> None:
    weak = SIX.with_(force=10.0)
    none = solve_for(weak, "spinning", frequency=30.0, by="model.drag_ratio", between=(1.0, 3.0))
    assert not none
    assert "begins at force" in none.reason


def test_a_stopped_search_says_so() -> None:
    reached: list[float] = []
    stopped = solve_for(
        SIX,
        "spinning",
        frequency=1200.0,
        by="load.force",
        progress=reached.append,
        stop=lambda: len(reached) >= 3,
    )
    assert len(reached) == 3
    assert (bool(stopped), stopped.not_searched) == (False, "the search was stopped")


# ---------------------------------------------------------------- records


def solved() -> Solutions:
    return solve_for(SIX, "spinning", frequency=70.0, by="load.force", between=(50.0, 80.0))


def test_records_are_one_line_with_the_error_and_a_sequence() -> None:
    solutions = solved()
    none = solve_for(SIX, "spinning", tip_height=3.0, by="load.force", between=(50.0, 80.0))
    for record in (solutions, solutions[0], none):
        for line in (str(record), repr(record)):
            assert len(line) <= 200
            assert "\n" not in line
    assert f"± {solutions[0].error:.1g}" in repr(solutions)
    assert f"± {solutions[0].error:.1g}" in repr(solutions[0])
    assert solutions[0] is next(iter(solutions)) is solutions[-1]
    assert solutions[0] in solutions
    assert solutions[:1] == (solutions[0],)
    assert (solutions[0].quantity, solutions[0].target) == ("frequency", 70.0)


def test_a_long_reason_is_cut_in_the_line_alone() -> None:
    solutions = Solutions(
        "spinning", "frequency", 1.0, "load.force", (0, 1), None, (), "x" * 400, None
    )
    assert len(str(solutions)) == len(repr(solutions)) == 200
    assert len(solutions.reason) == 400


# ---------------------------------------------------------------- bad input


@pytest.mark.parametrize(
    ("kind", "asked", "said"),
    [
        ("spin", {"frequency": 1.0}, "no kind of state and no threshold; take spinning"),
        ("spinning", {"speed": 1.0}, "speed is no quantity of spinning; take frequency or"),
        ("flapping", {"bending_energy": 1.0}, "bending_energy_max"),
        ("equilibrium", {"frequency": 1.0}, "frequency is no quantity of equilibrium"),
        ("spinning-lost", {"leading_rate": 0.0}, "take value or frequency"),
        ("spinning", {}, "exactly one target"),
        ("spinning", {"frequency": 1.0, "period": 1.0}, "frequency and period given"),
        ("spinning", {"frequency": math.nan}, "has to be a finite number"),
        ("spinning", {"frequency": "120"}, "has to be a finite number"),
    ],
)
def test_a_question_that_cannot_be_asked_is_refused(
    kind: str, asked: dict[str, Any], said: str
) -> None:
    assert said in complaint(lambda: solve_for(SIX, kind, by="load.force", **asked))


@pytest.mark.parametrize(
    ("by", "between", "said"),
    [
        ("load.length", None, "take load.force or"),
        ("model.segments", None, "take load.force or"),
        ("load.force", (90.0, 40.0), "give the lower end first"),
        ("load.force", (40.0, 40.0), "give the lower end first"),
        ("load.force", (40.0, math.inf), "two finite numbers"),
        ("load.force", (40.0, 60.0, 80.0), "two numbers, as (40, 300)"),
        ("load.force", 40.0, "two numbers, as (40, 300)"),
        ("load.force", (-40.0, 40.0), "at least 0"),
        ("model.drag_ratio", (0.5, 2.0), "at least 1"),
        ("model.bending_ratio", (0.5, 2.0), "model.bending_ratio"),
        ("model.natural_curvature.k1", None, "give its ends as between"),
    ],
)
def test_a_parameter_or_range_that_does_not_exist_is_refused(
    by: str, between: Any, said: str
) -> None:
    assert said in complaint(
        lambda: solve_for(SIX, "spinning", frequency=60.0, by=by, between=between)
    )


def test_a_threshold_is_not_solved_for_by_the_force_it_is() -> None:
    told = complaint(lambda: solve_for(SIX, "spinning-lost", value=100.0, by="load.force"))
    assert "take another parameter" in told


def test_a_confined_filament_has_no_spinning_and_no_rate_out_of_its_plane() -> None:
    flat = un.Filament(6, un.TipLoad(75.0), confined=True)
    assert "confined" in complaint(
        lambda: solve_for(flat, "spinning", frequency=60.0, by="load.force")
    )
    told = complaint(
        lambda: solve_for(flat, "flapping", leading_rate_out_of_plane=0.0, by="load.force")
    )
    assert "no quantity of flapping" in told


def test_solutions_are_stored_and_read_back(tmp_path: Path) -> None:
    solutions = solved()
    solutions.save(tmp_path / "solutions.nc")
    again = un.load(tmp_path / "solutions.nc")
    assert str(again) == str(solutions)
    assert again[0].value == solutions[0].value
    assert solutions.to_dataframe()["value"].tolist() == [solutions[0].value]
    assert "<table" in solutions._repr_html_()
    assert "<table" in solutions[0]._repr_html_()
