"""Fine samples of the end of a run: noted on the way or computed once more, they are the same."""

import numpy as np

import undula as un
from undula.analysis.observables.frequency import whole_motion_frequency
from undula.analysis.run_settings import Schedule
from undula.analysis.runs.fine_tail import close_up
from undula.analysis.runs.run import Run
from undula.analysis.runs.sample_buffer import STORED_ROWS, SampleBuffer, parts_of
from undula.analysis.runs.simulation import Simulation


def counted(first: int, last: int) -> np.ndarray:
    """Rows that hold their own multiple."""
    return np.arange(first, last, dtype=float)[:, None]


def test_rows_are_had_at_multiples_of_an_interval_if_all_are_there() -> None:
    recent = SampleBuffer()
    recent.note(0.25, 3, counted(3, 10))
    recent.note(0.25, 10, counted(10, 18))
    assert recent.samples(0.25, 3, 17)[:, 0].tolist() == list(range(3, 18))
    assert recent.samples(1.0, 1, 4)[:, 0].tolist() == [4, 8, 12, 16]
    assert recent.samples(0.25, 2, 17) is None
    assert recent.samples(0.25, 3, 18) is None
    assert recent.samples(0.125, 8, 20) is None


def test_rows_with_a_gap_before_them_are_all_that_is_known() -> None:
    recent = SampleBuffer()
    recent.note(0.25, 3, counted(3, 10))
    recent.note(0.25, 11, counted(11, 15))
    assert recent.samples(0.25, 9, 14) is None
    assert recent.samples(0.25, 11, 14)[:, 0].tolist() == [11, 12, 13, 14]


def test_rows_are_thinned_for_a_longer_interval() -> None:
    for last in range(10, 18):
        recent = SampleBuffer()
        recent.note(0.25, 3, counted(3, last))
        following = recent.following(1.0)
        assert following == -(-last // 4)
        recent.note(1.0, following, 4.0 * counted(following, 6))
        assert recent.samples(1.0, 1, 5)[:, 0].tolist() == [4, 8, 12, 16, 20]


def test_rows_are_kept_up_to_a_number() -> None:
    recent = SampleBuffer()
    for first in range(0, 10 * STORED_ROWS, STORED_ROWS // 4):
        recent.note(0.25, first, counted(first, first + STORED_ROWS // 4))
    assert STORED_ROWS <= sum(map(len, recent.rows)) < STORED_ROWS + STORED_ROWS // 4


def test_an_interval_is_divided_by_a_power_of_two_and_then_left_alone() -> None:
    assert parts_of(1.0, 50.0, 0.0) == 1
    assert parts_of(1.0, 25.0, 0.0) == 2
    assert parts_of(1.0, 9.0, 0.0) == 8
    assert parts_of(1.0, 9.0, 0.25) == 4
    assert parts_of(1.0, 7.0, 0.25) == 8
    assert parts_of(2.0, 9.0, 0.25) == 8


def settled(model: un.Filament, samples: int) -> Simulation:
    schedule = Schedule(until="settled", samples=samples)
    simulation = Simulation.begin(model, un.kicked(model), schedule)
    while simulation.advance():
        pass
    return simulation


def test_what_was_noted_is_what_the_same_steps_would_give_again() -> None:
    model = un.Filament(segments=10, load=un.TipLoad(200.0), confined=True)
    for samples in (50, 200, 800):
        simulation = settled(model, samples)
        noted = close_up(simulation)
        assert noted.noted is not None
        simulation.recent.rows.clear()
        afresh = close_up(simulation)
        assert afresh.noted is None
        np.testing.assert_array_equal(noted.time, afresh.time)
        np.testing.assert_array_equal(noted.motion.nodes, afresh.motion.nodes)
        np.testing.assert_array_equal(noted.motion.work, afresh.motion.work)


def test_samples_of_a_run_do_not_depend_on_what_is_noted_besides() -> None:
    model = un.Filament(segments=10, load=un.TipLoad(200.0), confined=True)
    schedule = Schedule(until="settled", samples=100)
    with_notes, without = (Simulation.begin(model, un.kicked(model), schedule) for _ in range(2))
    without._parts = lambda: 0
    while all([with_notes.advance(), without.advance()]):
        pass
    assert with_notes.recent.rows
    np.testing.assert_array_equal(with_notes.states, without.states)
    assert with_notes.settled == without.settled


def test_spinning_is_told_without_a_close_up_and_as_with_one() -> None:
    model = un.Filament(segments=10, load=un.TipLoad(60.0))
    simulation = settled(model, 200)
    run = Run.of(simulation)
    assert run.closer is not None
    told, frequency = run.verdict, run.frequency
    assert told.name == "spinning"
    assert "motion" not in vars(run.closer)
    assert run.close_up.time.size > run.window.time.size
    closely = whole_motion_frequency(run.shown.time, run.shown.nodes)
    assert abs(frequency.value - closely.value) <= frequency.error + closely.error
