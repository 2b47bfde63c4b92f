"""Motions that are made up, noted as a run would note them, and whether they count as settled."""

import itertools

import numpy as np
import pytest

import undula as un
from undula.analysis.run_settings import Schedule
from undula.analysis.runs.settled_motion import Settled
from undula.analysis.runs.settling import (
    NOISE_IN_RTOL,
    NOISE_REPETITIONS,
    REPETITIONS,
    TOLERANCE_IN_RTOL,
    MotionRates,
    SettlingDetector,
)
from undula.analysis.runs.stop_rule import OBSERVED_CYCLES, OBSERVED_CYCLES_AT_NOISE, observation_of

RTOL, BEAT = 1e-6, 0.01
#: A change of shape that counts neither as settled by its decay nor as an error of the integration.
VISIBLE = 3.0 * NOISE_IN_RTOL * RTOL


def shape(off: float) -> np.ndarray:
    """A bent shape, off by so much of its displacement from that of the attractor."""
    s = np.linspace(0.0, 1.0, 11)
    bend, other = 0.3 * s**2, 0.3 * np.sin(np.pi * s) * s
    return np.stack([bend, off * other, s], axis=-1)


def watched(offs: list[float], every: float = BEAT) -> SettlingDetector:
    """A watch that has seen these shapes at maxima of the energy."""
    watch = SettlingDetector(RTOL, 0.1)
    for number, off in enumerate(offs):
        time = (number + 1) * every
        pace = MotionRates(time, shape_speed=50.0, displacement=0.3, turn_rate=0.0)
        watch.note(pace, [(time, shape(off))])
    return watch


def told(offs: list[float]) -> Settled | None:
    return watched(offs).settled()


def noise(size: float, count: int = 2 * NOISE_REPETITIONS) -> list[float]:
    return (size * np.random.default_rng(3).uniform(-1.0, 1.0, count)).tolist()


def test_what_hovers_for_long_about_one_shape_has_settled_to_that_much() -> None:
    found = told(noise(VISIBLE))
    assert found is not None
    assert found.kind == "periodic"
    assert found.period == pytest.approx(BEAT)
    # Uniform numbers up to a size are at most twice as far apart; the shapes are some tenths long.
    assert 0.1 * VISIBLE < found.remaining < 2.0 * VISIBLE


def test_what_hovers_farther_than_the_tolerance_has_not_settled() -> None:
    assert told(noise(3.0 * TOLERANCE_IN_RTOL * RTOL)) is None


def test_what_creeps_has_not_settled() -> None:
    # Each step is an error of the integration, all of them together are more than the tolerance.
    offs = np.linspace(0.0, 3.0 * TOLERANCE_IN_RTOL * RTOL, 2 * NOISE_REPETITIONS)
    assert told(offs.tolist()) is None


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_what_grows_is_not_taken_for_hovering(sign: float) -> None:
    # From the size of errors on, to either side or to both in turn, as where a period doubles.
    growth = 1.06 ** np.arange(2 * NOISE_REPETITIONS)
    offs = VISIBLE * growth / growth[-1] * sign ** np.arange(growth.size)
    assert told(offs.tolist()) is None


def test_a_beat_that_is_seen_to_come_back_after_two_has_the_period_of_one() -> None:
    # In step with every other beat: the shape comes back better after two.
    fall = 3.0 * VISIBLE * 0.8 ** np.arange(3 * REPETITIONS)
    offs = [off * sign for off, sign in zip(fall, itertools.cycle((1.0, -1.0)), strict=False)]
    found = told(offs)
    assert found is not None
    assert found.period == pytest.approx(BEAT)


def test_what_still_settles_is_shown_for_longer_than_what_has_arrived() -> None:
    slow = [20.0 * NOISE_IN_RTOL * RTOL * 0.9**k for k in range(3 * REPETITIONS)]
    still, arrived = told(slow), told([0.0] * (3 * REPETITIONS))
    assert still is not None
    assert arrived is not None
    schedule = Schedule("settled", rtol=RTOL)
    longer, shorter = (observation_of(settled, schedule) for settled in (still, arrived))
    assert (longer.cycles, shorter.cycles) == (OBSERVED_CYCLES, OBSERVED_CYCLES_AT_NOISE)
    # Two mirror images a beat.
    shown = shorter.until - arrived.since
    assert shown == pytest.approx(2.0 * OBSERVED_CYCLES_AT_NOISE * BEAT)


def test_a_beat_with_which_the_steps_keep_step_settles_at_once() -> None:
    # Its shapes come back to some 30 rtol, neither nearer nor farther, however long one waits.
    model = un.Filament(20, un.TipLoad(274.0))
    run = un.integrate(model, un.kicked(model), until="settled", samples=400, limit=1.0)
    assert run.ending.value == "settled"
    assert run.verdict.name == "planar flapping"
    assert run.motion.time[-1] < 0.2
