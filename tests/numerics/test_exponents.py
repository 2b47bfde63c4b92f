"""Lyapunov exponents of systems in which they are known."""

import math

import numpy as np
import pytest

from attractors import BETA, SIGMA
from systems import LORENZ, TORUS, Known, carry_changes
from undula.numerics.integration.lyapunov import BLOCKS, TRANSIENT_SHARE, Block, growth, mean_rates
from undula.numerics.integration.schemes import NDF
from undula.numerics.integration.status import Status
from undula.numerics.integration.step import options
from undula.numerics.integration.stepper_state import start
from undula.numerics.integration.system import RATES

#: Sprott (2003), Chaos and Time-Series Analysis, Oxford University Press: exponents of the Lorenz
#: system with its first parameters.
PUBLISHED = (0.9056, 0.0, -14.5723)
TRACE = -SIGMA - 1.0 - BETA
ON_THE_BUTTERFLY = [-8.0, -7.0, 27.0]
#: A true value is farther off than so many statistical errors once in 400 times.
ERRORS = 3.0


def followed(
    system: Known, y: list[float], count: int, duration: float, rtol: float = 1e-8
) -> list[Block]:
    """Return the growth of so many changes along the trajectory that starts at y."""
    n = len(y)
    memory = start(system, NDF, np.array(y), np.zeros(n + RATES), 0.0, 1e-6)
    told = options(
        NDF,
        np.ones(n),
        np.zeros(n),
        rtol=rtol,
        atol=rtol,
        stale_after=0.1,
        longest_step=math.inf,
        frame=False,
    )
    blocks = growth(system, memory, told, count=count, duration=duration, advance=carry_changes)
    return list(blocks)


@pytest.mark.slow
def test_the_exponents_of_lorenz_are_the_published_ones() -> None:
    blocks = followed(Known(LORENZ), ON_THE_BUTTERFLY, 3, 2000.0)
    values, errors = mean_rates(blocks, 1e-8)
    assert np.all(np.abs(values - PUBLISHED) < ERRORS * errors)
    # The errors mean something: one per cent of the largest exponent.
    assert errors.max() < 0.01


@pytest.mark.parametrize(
    "rtol",
    [pytest.param(1e-5, marks=pytest.mark.slow), 1e-7, pytest.param(1e-9, marks=pytest.mark.slow)],
)
def test_the_exponents_of_lorenz_add_up_to_the_trace(rtol: float) -> None:
    blocks = followed(Known(LORENZ), ON_THE_BUTTERFLY, 3, 300.0, rtol)
    steps = sum(block.steps for block in blocks) / sum(block.time for block in blocks)
    # Whatever the attractor does, the trace is constant, so that nothing but the integration errs.
    assert abs(mean_rates(blocks, rtol)[0].sum() - TRACE) < 10.0 * rtol * steps
    assert 10.0 * rtol * steps < 0.01 * (rtol / 1e-5) ** 0.8  # the order of the steps is some 5


@pytest.mark.parametrize("rtol", [1e-5, 1e-7, 1e-9])
def test_the_exponents_of_a_torus_are_known_to_their_errors(rtol: float) -> None:
    blocks = followed(Known(TORUS, growths=(1.0, 2.0)), [0.5, 0.2, 1.0, -0.3], 4, 400.0, rtol)
    values, errors = mean_rates(blocks, rtol)
    assert np.all(np.abs(values - [0.0, 0.0, -2.0, -4.0]) <= errors)
    assert errors.max() < 0.02 * (rtol / 1e-5) ** 0.8


def test_fewer_changes_give_the_leading_exponents() -> None:
    all_of_them = mean_rates(followed(Known(LORENZ), ON_THE_BUTTERFLY, 3, 50.0), 1e-8)[0]
    two = mean_rates(followed(Known(LORENZ), ON_THE_BUTTERFLY, 2, 50.0), 1e-8)[0]
    # The same first changes in the same motion, but for round-off, which grows as they turn in and
    # then does no more.
    np.testing.assert_allclose(two, all_of_them[:2], atol=1e-9)


@pytest.mark.slow
def test_changes_stay_independent_in_blocks_of_any_length() -> None:
    # In a block of 12 units of time the third change shrinks by exp(-190) against the first.
    blocks = followed(Known(LORENZ), ON_THE_BUTTERFLY, 3, 12.0 * BLOCKS)
    values, errors = mean_rates(blocks, 1e-8)
    assert abs(values[2] - PUBLISHED[2]) < ERRORS * errors[2]


def test_a_block_says_how_long_it_was() -> None:
    blocks = followed(Known(TORUS), [1.0, 0.2, 1.0, 0.0], 1, 40.0)
    assert len(blocks) == BLOCKS
    assert all(block.status is Status.DONE for block in blocks)
    # Each ends with the step that passes its end, a hundredth of a turn or less beyond.
    assert sum(block.time for block in blocks) == pytest.approx(40.0, abs=0.1)


def test_a_trajectory_that_cannot_be_followed_says_why_and_ends() -> None:
    blocks = followed(Known(LORENZ), [1e200, 0.0, 0.0], 3, 1.0)
    assert [block.status for block in blocks] == [Status.NOT_FINITE]


def test_the_error_is_the_scatter_of_batches_or_the_drift_between_halves() -> None:
    random = np.random.default_rng(0)
    noise = random.normal(size=(BLOCKS, 1))
    steady = [Block(1.0, 1, one, Status.DONE) for one in noise]
    value, error = mean_rates(steady, 0.0)
    counted = BLOCKS * (1.0 - TRANSIENT_SHARE)
    # From ten batches the scatter is known to a quarter, three times over.
    assert error[0] == pytest.approx(1.0 / np.sqrt(counted), rel=0.75)
    assert abs(value[0]) < ERRORS * error[0]
    drifting = [Block(1.0, 1, np.array([k / BLOCKS]), Status.DONE) for k in range(BLOCKS)]
    # Of a line from 1/4 to 1 the halves differ by 3/8.
    assert mean_rates(drifting, 0.0)[1][0] == pytest.approx(3.0 / 16.0, rel=1e-2)
