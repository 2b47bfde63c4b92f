"""Leading Lyapunov exponents: mean rates at which small changes of a trajectory grow.

Changes propagated with a trajectory (`undula.numerics.integration.variational`) all align with the
direction of fastest growth. They are orthonormalised every few steps. The logarithms of the factors
that this removes, summed over time, are the growth of lengths, areas and volumes, which gives one
exponent after the other.

Source: Benettin, Galgani, Giorgilli & Strelcyn (1980), Meccanica 15, 9.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from undula.arrays import Array
from undula.numerics.integration.matrices import derivative_half_bandwidth
from undula.numerics.integration.status import Status
from undula.numerics.integration.step import Options
from undula.numerics.integration.stepper_state import STEPS, TIME, StepperState
from undula.numerics.integration.variational import advance_with_changes

#: Number of blocks of a trajectory.
BLOCKS = 400
#: Share of the blocks that is left out at the beginning, while the changes align.
TRANSIENT_SHARE = 0.25
#: Number of batches of blocks, whose means give the statistical error.
BATCHES = 10
#: Largest number of steps between orthonormalisations. A step is a few per cent of the time scale
#: of the motion, so that leading changes do not become parallel to all digits.
STEPS_BETWEEN_ORTHONORMALISATIONS = 50
#: Bound on the error of the logarithm of a change in one step, in units of rtol: systems with known
#: exponents show four to nine (tests/numerics/test_exponents.py).
STEP_ERROR_IN_RTOL = 10.0


@dataclass(frozen=True)
class Block:
    """A part of a trajectory.

    Attributes
    ----------
    time : float
        Duration.
    steps : int
        Number of steps.
    logs : ndarray, shape (k,)
        Logarithms of the factors by which k changes grew, each orthogonal to those before it.
    status : Status
        DONE, or the reason why the integration ended before the end of the block.
    """

    time: float
    steps: int
    logs: Array
    status: Status


def growth(
    system: Any,
    stepper: StepperState,
    options: Options,
    *,
    count: int,
    duration: float,
    seed: int = 1,
    advance: Callable[..., int] = advance_with_changes,
) -> Iterator[Block]:
    """Integrate a trajectory with random small changes, block by block.

    Parameters
    ----------
    system, stepper, options
        As for `undula.numerics.integration.time_loop.advance`; the stepper is changed in place. The
        lab frame is used throughout.
    count : int
        Number of changes, at most the number of degrees of freedom.
    duration : float
        Duration of the trajectory, above 0.
    seed : int
        Seed of the changes.
    advance : callable
        `undula.numerics.integration.variational.advance_with_changes`, compiled.

    Yields
    ------
    Block
        `BLOCKS` blocks; a block whose integration failed is the last.
    """
    longest_step = min(options.longest_step, duration / BLOCKS)  # so that no block is empty
    moving, options = options.mask == 1.0, options._replace(frame=0, longest_step=longest_step)
    changes = np.zeros((count, *stepper.differences[:, : moving.size].shape))
    random = np.random.default_rng(seed)
    changes[:, 0, moving] = random.normal(size=(count, int(moving.sum())))
    half = derivative_half_bandwidth(type(system))
    band = np.zeros((moving.size, 2 * half + 1))
    start = float(stepper.real[TIME])
    for block in range(1, BLOCKS + 1):
        end, logs, status = start + duration * block / BLOCKS, np.zeros(count), Status.PAUSED
        time, steps = float(stepper.real[TIME]), int(stepper.count[STEPS])
        while status is Status.PAUSED:
            status = Status(
                advance(
                    system, stepper, options, changes, band, end, STEPS_BETWEEN_ORTHONORMALISATIONS
                )
            )
            logs += _orthonormalise(changes, moving)
        yield Block(stepper.real[TIME] - time, stepper.count[STEPS] - steps, logs, status)
        if status is not Status.DONE:
            return


def mean_rates(blocks: list[Block], rtol: float) -> tuple[Array, Array]:
    """Return mean growth rates in descending order, and their errors.

    An error is the largest of three: the statistical error, from means over batches; half the
    difference between the two halves of the time; the error of the integration.

    Parameters
    ----------
    blocks : list of Block
        The whole trajectory.
    rtol : float
        Relative tolerance of its steps.

    Returns
    -------
    rates, errors : ndarray, shape (k,)
        The exponents, in units of one over time.
    """
    counted = blocks[round(TRANSIENT_SHARE * len(blocks)) :]
    rates = _mean_rates(counted)
    order = np.argsort(-rates)
    batches = np.array([_mean_rates(batch) for batch in _split(counted, BATCHES)])
    statistical = batches.std(axis=0, ddof=1) / np.sqrt(BATCHES)
    first, last = (_mean_rates(half) for half in _split(counted, 2))
    steps, time = sum(block.steps for block in counted), sum(block.time for block in counted)
    integration = STEP_ERROR_IN_RTOL * rtol * steps / time
    errors = np.maximum(np.maximum(statistical, 0.5 * np.abs(first - last)), integration)
    return rates[order], errors[order]


def _mean_rates(blocks: list[Block]) -> Array:
    return np.asarray(sum(block.logs for block in blocks) / sum(block.time for block in blocks))


def _split(blocks: list[Block], parts: int) -> list[list[Block]]:
    ends = np.linspace(0, len(blocks), parts + 1).round().astype(int)
    return [blocks[first:last] for first, last in pairwise(ends)]


def _orthonormalise(changes: Array, moving: Array) -> Array:
    """Orthonormalise the changes (k, rows, n) in place; return the logarithms (k,) of their norms.

    The linear combinations that orthonormalise the first rows are applied to all rows.
    """
    triangle = np.linalg.qr(changes[:, 0, moving].T)[1]
    histories = changes.reshape(len(triangle), -1)
    changes[:] = np.linalg.solve(triangle.T, histories).reshape(changes.shape)
    return np.log(np.abs(np.diag(triangle)))
