"""What a run has come to, solved for: the answer is the run's own motion, or says why it is not."""

from typing import Any

import numpy as np
import pytest

import undula as un
from commands import Ask, answer, refused
from refusal import complaint
from undula.analysis.observables.alignment import aligned_distance
from undula.analysis.regimes.recurrence import recurrence
from undula.analysis.solvers.periodic_guesses import Seen
from undula.analysis.solvers.periodic_search import reached
from undula.analysis.states.not_found import NotFound

THREE = un.Chain(3, un.TipLoad(100.0))
WINDMILL = ["--set", "model.kind=chain", "--set", "model.links=3", "--set", "load.force=100"]


@pytest.fixture(scope="module")
def settled() -> un.Run:
    """Give a run that ends in windmilling: its mirror image comes back after half its period."""
    return un.integrate(THREE, un.kicked(THREE), until="settled")


def found(state: un.Periodic | NotFound) -> un.Periodic:
    assert not isinstance(state, NotFound), state.reason
    return state


def check(state: un.Periodic, run: un.Run) -> None:
    """Check that a state is what a run has come to."""
    back = recurrence(run.shown.time, run.shown.nodes)
    assert back is not None
    # The shape comes back to 1e-5 of the displacement, from one sample in fifty to another.
    assert state.period == pytest.approx(back.period, rel=1e-4)
    assert state.stable
    assert run.frequency is not None
    # The frequencies are those of the same line; the steps of the run leave 1e-6 of it.
    allowed = run.frequency.error + 1e-5 * state.frequency
    assert state.frequency == pytest.approx(abs(run.frequency.value), abs=allowed)
    # The orbit passes through the shape that the run ends with.
    start = THREE.nodes(state.start)
    assert aligned_distance(run.motion.nodes[-1], start).distance < 1e-3


def test_the_motion_found_from_a_run_is_that_of_the_run(settled: un.Run) -> None:
    assert settled.verdict.name == "windmilling"
    state = found(un.find(settled, "periodic"))
    check(state, settled)
    assert settled.shape_frequency is not None
    # Of double period: only mirror images are the same after half of it.
    assert state.shape_frequency == pytest.approx(0.5 * settled.shape_frequency.value, rel=1e-5)
    assert state.frequency == pytest.approx(2.0 * state.shape_frequency, rel=1e-12)


@pytest.mark.slow
def test_every_way_to_give_a_run_leads_to_the_same_motion(settled: un.Run) -> None:
    state = found(un.find(settled, "periodic"))
    stored = un.dataset_of(settled)
    for other in (
        un.find(THREE, "periodic", guess=settled),
        un.find(THREE, "periodic", guess=stored),
    ):
        assert found(other).frequency == state.frequency
    # Without one the run is that of the default start, which is the same.
    assert found(un.find(THREE, "periodic")).frequency == state.frequency
    again = found(un.find(THREE, "periodic", guess=state))
    assert again.period == pytest.approx(state.period, rel=1e-9)


@pytest.mark.parametrize("seed", [2, 5])
def test_the_motion_found_for_a_seed_is_that_of_the_run_from_it(seed: int) -> None:
    run = un.integrate(THREE, un.kicked(THREE, seed=seed), until="settled")
    check(found(un.find(THREE, "periodic", seed=seed)), run)


def test_an_answer_states_how_far_its_steps_in_time_leave_it(settled: un.Run) -> None:
    state = found(un.find(settled, "periodic"))
    finer = un.integrate(THREE, state.start, until=5.0 * state.period, rtol=1e-9, samples=6)
    apart = np.abs(finer.motion.nodes[-1] - finer.motion.nodes[0]).max()
    # Off by so much of a period after five of them, at a tip's speed of some 2 pi L a turn.
    allowed = 5.0 * 10.0 * state.time_error * state.period * 2.0 * np.pi * 0.6
    assert apart < max(allowed, 1e-5)
    assert 0.0 < state.time_error < 1e-5


def test_a_run_that_tells_half_its_period_is_solved_for_with_the_whole(settled: un.Run) -> None:
    assert settled.settled is not None
    assert settled.settled.period is not None
    # Of too few samples for a recurrence.
    last = settled.shown.time[-2:], settled.shown.nodes[-2:]
    seen = Seen(*last, "windmilling", 0.5 * settled.settled.period, 0.0)
    check(found(reached(THREE, seen)), settled)


@pytest.mark.slow
def test_another_motion_than_the_run_ends_with_is_no_answer(settled: un.Run) -> None:
    assert settled.settled is not None
    assert settled.settled.period is not None
    last = settled.shown.time[-2:], settled.shown.nodes[-2:]
    # Neither this nor its double is a period of the motion.
    state = reached(THREE, Seen(*last, "windmilling", 0.7 * settled.settled.period, 0.0))
    assert isinstance(state, NotFound)
    assert "guess" in state.reason or "is another one: its period is" in state.reason


def test_a_spinning_run_has_no_period_of_its_shape() -> None:
    slow = un.Chain(3, un.TipLoad(25.0))
    run = un.integrate(slow, un.kicked(slow, 0.3), until="settled")
    assert run.verdict.name == "spinning"
    state = un.find(run, "periodic")
    assert isinstance(state, NotFound)
    assert "does not repeat itself (spinning)" in state.reason


def test_a_guess_and_a_seed_are_refused_together(settled: un.Run) -> None:
    assert "leave one out" in complaint(lambda: un.find(THREE, "periodic", guess=settled, seed=2))


@pytest.mark.slow
@pytest.mark.usefixtures("own_folder")
def test_the_command_takes_a_stored_run(ask: Ask) -> None:
    settle = ["--set", 'time.until="settled"', "--no-movie", "--out", "r", "--json"]
    run = answer(ask("run", *WINDMILL, *settle))

    def asked(*words: str) -> dict[str, Any]:
        return answer(ask("find", "periodic", *words, "--json"))

    state = asked("--run", "r/run.nc")
    assert (state["force"], state["links"], state["stable"]) == (100.0, 3, True)
    assert state["frequency"] == pytest.approx(run["frequency"], abs=run["frequency_error"])
    assert state["period"] == pytest.approx(run["settled"]["period"], rel=1e-5)
    for name in ("bending_energy", "tip_radius", "tip_height"):
        for part in ("min", "max", "mean"):
            # Extremes are read between samples, those of the run of a spline.
            assert state[name][part] == pytest.approx(run[name][part], abs=5e-3), (name, part)
    # Without a run it makes the same one.
    assert asked(*WINDMILL)["period"] == state["period"]
    nearby = asked("--run", "r/run.nc", "--set", "load.force=101")
    assert (nearby["force"], nearby["stable"]) == (101.0, True)
    assert state["frequency"] < nearby["frequency"] < 1.02 * state["frequency"]


@pytest.mark.parametrize(
    ("words", "cure"),
    [
        (["spinning", "--seed", "2"], "--seed is for periodic motions; leave it out for spinning"),
        (["flapping", "--run", "r.nc"], "--run is for periodic motions"),
        (["periodic", "--run", "r.nc", "--seed", "2"], "leave one of them out"),
        (["periodic", "in.toml", "--run", "r.nc"], "--run and in.toml both say"),
        (["periodic", "--run", "gone.nc"], "gone.nc"),
        (["periodic", "--seed", "-1"], "--seed"),
    ],
)
def test_options_that_do_not_go_together_are_refused(words: list[str], cure: str, ask: Ask) -> None:
    assert cure in refused(ask("find", *words))
