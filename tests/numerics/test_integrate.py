"""The time loop on exactly known systems: accuracy, frames, memory, sections, failures."""

import math
from typing import Any

import numpy as np
import pytest

from systems import (
    ALL_STEPS,
    BEAD,
    FOLLOWER,
    SPINNER,
    Known,
    begin,
    choices,
    copied,
    exact,
    follow,
    sections_of,
)
from uncached import uncached
from undula.numerics.integration.schemes import SCHEMES, BackwardDifferentiation
from undula.numerics.integration.status import Status
from undula.numerics.integration.step_size import rescale
from undula.numerics.integration.step_size import turn_history as turn_history_as_written
from undula.numerics.integration.stepper_state import (
    FRAME_CHANGES,
    IN_FRAME,
    STEP,
    STEPS,
    TIME,
    StepperState,
)
from undula.numerics.integration.system import RATES

turn_history = uncached(turn_history_as_written)

#: From rtol 1e-4, where the errors of the first steps no longer matter, down to where round-off in
#: the times of a stiff system does not matter yet.
TOLERANCES = 10.0 ** -np.arange(4.0, 9.1, 0.5)
TIMES = np.linspace(0.0, 6.0, 121)

FAST_SPINNER = Known(SPINNER, 1e3, growth=1.0, turning=5.0, twist=1.0)
FADING_SPINNER = Known(SPINNER, 1e3, growth=-1.0, turning=5.0)
WAVE = Known(SPINNER, 1e3, growth=1.0, turning=20.0, twist=3.0)


def largest_error(system: Known, radius: float, **told: Any) -> float:
    """Return the largest error of the positions, over rtol the error that a step may make."""
    options = choices(system, **told)
    status, rows = follow(system, begin(system, radius=radius), options, TIMES)
    assert status is Status.DONE
    known = exact(system, TIMES, radius)[:, :-RATES] * options.mask
    wrong = np.linalg.norm(rows[:, :-RATES] * options.mask - known, axis=1)
    return float((wrong / (options.atol / options.rtol + np.linalg.norm(known, axis=1))).max())


@pytest.mark.parametrize("scheme", SCHEMES, ids=lambda scheme: scheme.name)
@pytest.mark.parametrize(
    ("system", "radius", "told", "expected"),
    [
        # Errors that are damped at once are those of the last step: proportional to rtol.
        pytest.param(Known(FOLLOWER, 1e6), 1.0, {}, 1.0, id="stiff follower"),
        pytest.param(Known(BEAD, 1e4), 1.0, {}, 1.0, id="stiff bead"),
        # Errors of a phase add up over steps whose number grows as rtol^(-1/6) at order 5.
        pytest.param(FAST_SPINNER, 0.3, {"frame": False}, 5.0 / 6.0, id="spinner in the lab"),
        pytest.param(FAST_SPINNER, 0.3, {"frame": True}, 5.0 / 6.0, id="spinner in the frame"),
        pytest.param(FADING_SPINNER, 1.0, {"atol": 0.0}, 5.0 / 6.0, id="fading spinner"),
    ],
)
def test_the_global_error_follows_the_tolerance(
    system: Known,
    radius: float,
    told: dict[str, Any],
    expected: float,
    scheme: BackwardDifferentiation,
) -> None:
    errors = [
        largest_error(system, radius, scheme=scheme, rtol=rtol, **told) for rtol in TOLERANCES
    ]
    slope = np.polyfit(np.log(TOLERANCES), np.log(errors), 1)[0]
    assert slope == pytest.approx(expected, abs=0.15)


@pytest.mark.parametrize(("rtol", "atol"), [(1e-3, 1e-3), (1e-9, 1e-9), (1e-6, 1e-2)])
def test_the_constraint_is_kept_to_tolerance_even_where_positions_may_be_rough(
    rtol: float, atol: float
) -> None:
    system = Known(BEAD, 1e4)
    memory, told = begin(system), choices(system, rtol=rtol, atol=atol)
    while memory.real[TIME] < 6.0:
        follow(system, memory, told, [6.0], most_steps=1)
        # Newton's method ends below twice rtol; round-off of a unit circle comes on top.
        assert abs(np.hypot(*memory.differences[0, :2]) - 1.0) < 2.0 * rtol + 1e-15


@pytest.mark.parametrize("rtol", [1e-4, 1e-6, 1e-8])
def test_the_frame_gives_the_output_of_the_lab_to_tolerance(rtol: float) -> None:
    system, radius = Known(SPINNER, 1e3, growth=1.0, turning=5.0), 0.3
    rows, changes = [], []
    for frame in (False, True):
        memory = begin(system, radius=radius)
        rows.append(follow(system, memory, choices(system, rtol=rtol, frame=frame), TIMES)[1])
        changes.append(memory.count[FRAME_CHANGES])
    assert changes[0] == 0
    assert changes[1] >= 1
    # In the lab errors of some hundred steps add up, each of rtol (1 + size of the state).
    np.testing.assert_allclose(rows[1], rows[0], atol=500.0 * rtol)


def test_a_motion_that_does_not_turn_is_never_seen_from_a_frame() -> None:
    system = Known(SPINNER, 1e3, growth=1.0)
    memory = begin(system, radius=0.3)
    follow(system, memory, choices(system, frame=True), TIMES)
    assert memory.count[FRAME_CHANGES] == 0


def test_the_frame_is_left_when_the_turning_has_ended() -> None:
    system = Known(SPINNER, 1e3, growth=1.0, turning=5.0)
    memory, told = begin(system), choices(system, frame=True)
    follow(system, memory, told, [1.0])
    assert memory.count[IN_FRAME] == 1
    standing = system._replace(turning=0.0)
    memory.differences[0, :2] *= 0.1
    follow(standing, memory, told, [4.0])
    assert memory.count[IN_FRAME] == 0


@pytest.mark.parametrize("rtol", [1e-4, 1e-6])
def test_on_a_rotating_wave_the_step_grows_without_bound_and_the_angle_stays_exact(
    rtol: float,
) -> None:
    rate = WAVE.turning + WAVE.twist * WAVE.growth
    period = 2.0 * math.pi / rate
    memory, told = begin(WAVE), choices(WAVE, rtol=rtol, frame=True)
    follow(WAVE, memory, told, [10.0 * period])
    early = np.array(follow(WAVE, memory, told, [100.0 * period])[1][0])
    steps = memory.count[STEPS]
    _, rows = follow(WAVE, memory, told, [1e6 * period])
    assert memory.real[STEP] > 1e3 * period
    assert memory.count[STEPS] - steps < 50
    # A million turns add nothing but round-off to the phase lost while the frame was found.
    lost = early[3] - rate * 100.0 * period
    assert abs(lost) < 10.0 * rtol
    assert rows[0, 3] - rate * 1e6 * period == pytest.approx(lost, abs=1e-2 * rtol + 1e-8)
    np.testing.assert_allclose(np.hypot(*rows[0, :2]), 1.0, atol=rtol)


def same(one: StepperState, other: StepperState) -> bool:
    return all(np.array_equal(a, b) for a, b in zip(one, other, strict=True))


SPLIT_SYSTEMS = [Known(FOLLOWER, 1e4), Known(BEAD, 1e4), FAST_SPINNER]
every_system = pytest.mark.parametrize("system", SPLIT_SYSTEMS, ids=["follower", "bead", "spinner"])


@every_system
@pytest.mark.parametrize("cut", [1, 37, 120])
def test_a_run_cut_at_an_asked_time_is_the_whole_run_bit_for_bit(system: Known, cut: int) -> None:
    told, whole = choices(system, frame=True), begin(system, radius=0.3)
    _, rows = follow(system, whole, told, TIMES)
    part = begin(system, radius=0.3)
    _, first = follow(system, part, told, TIMES[:cut])
    part = copied(part)
    _, second = follow(system, part, told, TIMES[cut:])
    assert np.array_equal(np.concatenate([first, second]), rows)
    assert same(part, whole)


@every_system
@pytest.mark.parametrize("most_steps", [1, 7])
def test_a_run_that_pauses_every_few_steps_is_the_whole_run_bit_for_bit(
    system: Known, most_steps: int
) -> None:
    told, whole = choices(system, frame=True), begin(system, radius=0.3)
    _, rows = follow(system, whole, told, TIMES)
    part, parts, filled, status = begin(system, radius=0.3), [], 0, Status.PAUSED
    while status is Status.PAUSED:
        part = copied(part)
        before = part.count[STEPS]
        status, found = follow(system, part, told, TIMES[filled:], most_steps)
        assert part.count[STEPS] - before <= most_steps
        filled += len(found)
        parts.append(found)
    assert np.array_equal(np.concatenate(parts), rows)
    assert same(part, whole)


@pytest.mark.parametrize("stiffness", [10.0, 1e4])
def test_sections_lie_at_the_maxima_of_the_energy(stiffness: float) -> None:
    system, tolerances = Known(FOLLOWER, stiffness), 10.0 ** -np.arange(4.0, 9.1)
    maxima = 2.0 * math.pi * np.arange(1, 5)
    errors = []
    for rtol in tolerances:
        found = sections_of(system, begin(system), choices(system, rtol=rtol), 28.0)
        assert len(found) == len(maxima)
        errors.append(np.abs(found[:, 0] - maxima).max())
        known = exact(system, found[:, 0])
        # The state at a section is output between steps like any other.
        np.testing.assert_allclose(found[:, 1:], known, atol=20.0 * rtol)
    # The time comes from a slope, which is worse by one step length: rtol^(5/6) at order 5.
    slope = np.polyfit(np.log(tolerances), np.log(errors), 1)[0]
    assert slope == pytest.approx(5.0 / 6.0, abs=0.15)


def test_an_equation_that_stops_making_sense_ends_the_run_at_its_last_good_step() -> None:
    system = Known(FOLLOWER, 10.0, ends=1.0)
    memory, told, status = begin(system), choices(system), Status.PAUSED
    while status is Status.PAUSED:
        before = copied(memory)
        status, rows = follow(system, memory, told, [2.0], most_steps=1)
    assert status is Status.STEP_TOO_SHORT
    assert len(rows) == 0
    assert memory.real[TIME] == before.real[TIME]
    assert np.array_equal(memory.differences[0], before.differences[0])
    # No step passes the end of the equation, and shorter and shorter ones come close to it.
    assert memory.real[TIME] == pytest.approx(1.0, abs=1e-12)
    assert memory.real[TIME] <= 1.0
    np.testing.assert_allclose(
        memory.differences[0], exact(system, [memory.real[TIME]])[0], atol=1e-5
    )


def test_a_state_that_overflows_ends_the_run_while_it_is_still_finite() -> None:
    system = Known(FOLLOWER, -5.0)
    memory = begin(system)
    memory.differences[0, 0] = 2.0
    status, rows = follow(system, memory, choices(system), [1.0, 1e3])
    assert status is Status.NOT_FINITE
    # u = cos t + e^(5 t), grown by the errors that an unstable system makes of its tolerance
    assert rows[0, 0] == pytest.approx(math.cos(1.0) + math.exp(5.0), rel=1e-3)
    assert np.isfinite(memory.differences).all()
    assert memory.differences[0, 0] > 1e145


def test_a_start_that_is_no_number_is_not_stepped_from() -> None:
    system = Known(FOLLOWER, 10.0)
    memory = begin(system)
    memory.differences[0, 0] = math.nan
    status, rows = follow(system, memory, choices(system), [1.0], ALL_STEPS)
    assert (status, len(rows), memory.count[STEPS]) == (Status.NOT_FINITE, 0, 0)


def test_the_past_turned_into_the_frame_is_the_past_seen_from_it() -> None:
    for order in range(1, 6):
        lab = begin(FAST_SPINNER, order=order, step=0.05, radius=0.3)
        frame = begin(FAST_SPINNER, order=order, step=0.05, radius=0.3, in_frame=True)
        turn_history(FAST_SPINNER, lab, -1.0)
        # Differences of numbers near 1 lose up to 2^order in round-off.
        size = order + 1
        np.testing.assert_allclose(lab.differences[:size], frame.differences[:size], atol=1e-13)


def test_turning_the_past_there_and_back_changes_nothing() -> None:
    rng = np.random.default_rng(1)
    memory = begin(FAST_SPINNER, order=5)
    memory.differences[:] = rng.normal(size=memory.differences.shape)
    before = memory.differences.copy()
    turn_history(FAST_SPINNER, memory, -1.0)
    assert not np.allclose(memory.differences, before)
    turn_history(FAST_SPINNER, memory, 1.0)
    # The values of the past are sums of up to 2^7 differences.
    np.testing.assert_allclose(memory.differences, before, atol=1e-12)


def polynomial(differences: np.ndarray, order: int, place: float) -> np.ndarray:
    """Return the interpolating polynomial at a time, in steps after the last one."""
    total, factor = differences[0].copy(), 1.0
    for j in range(1, order + 1):
        factor *= (place + j - 1) / j
        total += factor * differences[j]
    return total


@pytest.mark.parametrize("order", range(1, 6))
@pytest.mark.parametrize("ratio", [0.2, 0.93, 1.7, 10.0])
def test_another_step_length_leaves_the_interpolating_polynomial_as_it_was(
    order: int, ratio: float
) -> None:
    rng = np.random.default_rng(order)
    before = rng.normal(size=(order + 1, 4))
    after = before.copy()
    rescale(after, order, ratio, np.empty((2, order + 1)))
    for place in (-2.3, -1.0, -0.4, 0.0, 0.7):
        # Coefficients of up to ratio^order cancel.
        np.testing.assert_allclose(
            polynomial(after, order, place / ratio),
            polynomial(before, order, place),
            atol=1e-13 * max(1.0, ratio) ** order,
        )
