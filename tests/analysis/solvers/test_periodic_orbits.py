"""Motions that repeat themselves up to a turn: from runs, and born from planar flapping."""

import numpy as np
import pytest

from refusal import complaint
from undula.analysis.runs.integrate import integrate
from undula.analysis.runs.run import Run
from undula.analysis.solvers.branches import follow_from_onset
from undula.analysis.solvers.criticality import Criticality, criticality
from undula.analysis.solvers.periodic_orbits import follow_from_bifurcation
from undula.analysis.solvers.periodic_search import find_periodic
from undula.analysis.solvers.spinning import find_spinning
from undula.analysis.solvers.threshold_record import Threshold
from undula.analysis.solvers.thresholds import single_threshold
from undula.analysis.states.branch import Bifurcation
from undula.analysis.states.not_found import NotFound
from undula.analysis.states.periodic_record import Periodic
from undula.analysis.states.records import Flapping
from undula.models.filament import Filament
from undula.models.initial_states import from_state, kicked
from undula.models.loads.analytic import LinearLoad, PointLoad, TipLoad

STRONG = Filament(12, TipLoad(350.0))


@pytest.fixture(scope="module")
def settled() -> Run:
    """Give a run that spins with a changing shape."""
    return integrate(STRONG, kicked(STRONG, 0.1), until="settled", limit=8.0)


@pytest.fixture(scope="module")
def gained() -> Threshold:
    """Give the force at which planar flapping becomes stable in space, with few links."""
    return single_threshold(Filament(12, TipLoad(1.0)), "flapping-gained")


def known(threshold: Threshold) -> Bifurcation[Flapping]:
    assert threshold.at is not None
    return threshold.at


def test_a_run_whose_shape_repeats_itself_turned_is_solved_for(settled: Run) -> None:
    state = find_periodic(STRONG, settled)
    assert isinstance(state, Periodic)
    assert settled.shape_frequency is not None
    # The run's steps at the default tolerance leave some 1e-5 of the frequency.
    assert state.shape_frequency == pytest.approx(settled.shape_frequency.value, rel=1e-4)
    assert state.residual < 1e-10
    assert max(state.trivial) < 1e-6
    # Stages of order 5 balance the power to what they leave of the motion.
    assert state.power_balance_error < 1e-5
    # A kicked run cannot stay at what is unstable.
    assert state.stable


def test_the_state_comes_back_turned_by_its_angle(settled: Run) -> None:
    state = find_periodic(STRONG, settled)
    assert isinstance(state, Periodic)
    start = STRONG.rotate(STRONG.positions(state.unknowns[-1]), -state.angle)
    run = integrate(STRONG, start, until=state.period, samples=2, rtol=1e-9)
    there = STRONG.from_nodes(run.motion.nodes[-1])
    # The period's own error by the steps in time, times the speed of the tip, some 1e3.
    assert np.abs(there - STRONG.positions(state.unknowns[-1])).max() < 1e-4


def test_a_run_whose_shape_does_not_change_gives_no_such_state() -> None:
    slow = Filament(12, TipLoad(60.0))
    run = integrate(slow, kicked(slow, 0.1), until="settled", limit=3.0)
    found = find_periodic(slow, run)
    assert isinstance(found, NotFound)
    assert "does not repeat" in found.reason


def test_a_confined_model_has_no_such_state(settled: Run) -> None:
    assert "confined" in complaint(lambda: find_periodic(STRONG.with_(confined=True), settled))


@pytest.mark.slow
def test_what_flapping_gives_birth_to_ends_where_spinning_is_lost(gained: Threshold) -> None:
    lost = single_threshold(Filament(12, TipLoad(1.0)), "spinning-lost")
    assert gained.value is not None
    assert lost.value is not None
    branch = follow_from_bifurcation(known(gained), lost.value + 5.0)
    assert all(state.leading_rate > 0.0 for state in branch.states[1:])
    # It begins with the beat's frequency and turns back at the spinning state's, where the change
    # of its shape dies out; both only differ by the steps in time.
    assert branch.states[0].frequency == pytest.approx(gained.frequency, rel=1e-6)
    fold = next(one for one in branch.bifurcations if one.kind == "fold")
    assert fold.value == pytest.approx(lost.value, rel=1e-6)
    assert fold.state.frequency == pytest.approx(lost.frequency, rel=1e-5)
    assert fold.state.shape_frequency == pytest.approx(lost.second_frequency, rel=1e-5)


def test_only_a_symmetry_breaking_of_flapping_gives_birth() -> None:
    spinning = single_threshold(Filament(12, TipLoad(1.0)), "spinning-lost")
    assert "torus of Spinning" in complaint(lambda: follow_from_bifurcation(known(spinning), 300.0))


def bends(load: TipLoad | LinearLoad | PointLoad, **changes: float) -> dict[str, Criticality]:
    found = criticality(Filament(16, load, **changes))  # type: ignore[arg-type]
    assert not isinstance(found, NotFound)
    return {birth.kind: birth for birth in found}


def test_the_bend_at_birth_is_that_of_the_branch() -> None:
    bend = bends(TipLoad(1.0))["spinning"]
    state = find_spinning(Filament(16, TipLoad(1.0005 * bend.force)))
    assert not isinstance(state, NotFound)
    across = state.nodes[1:, :2]
    away = np.sum(across**2) / (3 * len(across))
    # The distance along the axis is of higher order, the next term of the series of 1 per cent.
    assert 0.0005 * bend.force / away == pytest.approx(bend.quadratic_coefficient, rel=0.05)


def test_spinning_under_a_low_force_is_born_downwards_and_turns_in_a_fold() -> None:
    load = PointLoad(1.0, 0.4)
    born = bends(load)
    assert born["flapping"].supercritical
    assert not born["spinning"].supercritical
    branch = follow_from_onset(Filament(16, load), "spinning", 130.0)
    assert not isinstance(branch, NotFound)
    assert branch.values[1] < branch.values[0]
    fold = next(one for one in branch.bifurcations if one.kind == "fold")
    assert fold.value < born["spinning"].force
    assert fold.gains


def test_between_fold_and_onset_the_filament_keeps_what_it_does() -> None:
    model = Filament(16, PointLoad(97.0, 0.4))
    rest = integrate(model, kicked(model, 1e-3), until=1.0)
    assert rest.verdict.name == "straight"
    state = find_spinning(model)
    assert not isinstance(state, NotFound)
    assert state.stable
    pushed = from_state(model, state.nodes, 0.98)
    spun = integrate(model, pushed, until="settled", limit=3.0)
    assert spun.verdict.name == "spinning"
    assert spun.frequency is not None
    # The run's own error of its frequency is some 1e-6 of it.
    assert abs(spun.frequency.value) == pytest.approx(state.frequency, rel=1e-5)
