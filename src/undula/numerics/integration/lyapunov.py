"""How fast small changes of a trajectory grow, in the mean: its leading Lyapunov exponents.

Changes carried along with a trajectory (`undula.numerics.integration.variational`) all turn into
the direction that grows most. They are made orthonormal again every few steps; the logarithms of
what that takes out, added up over a time, are the growth of lengths, areas and volumes, and so of
one exponent after the other.

Source: Benettin, Galgani, Giorgilli & Strelcyn (1980), Meccanica 15, 9.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from undula.arrays import Array
from undula.numerics.integration.status import Status
from undula.numerics.integration.step import Options
from undula.numerics.integration.stepper_state import STEPS, TIME, StepperState
from undula.numerics.integration.system import derivative_half_bandwidth
from undula.numerics.integration.variational import advance_with_changes

#: Blocks that a trajectory is cut into.
BLOCKS = 400
#: The first part of them turns the changes into their directions and is not counted.
TURNING_IN = 0.25
#: Batches of blocks whose means give the statistical error.
BATCHES = 10
#: Changes are made orthonormal at least so often: in as many steps, each some per cent of the time
#: in which anything happens, leading ones do not become parallel to all digits.
MOST_STEPS = 50
#: A step takes the logarithm of a change off by less than so many rtol: systems with known
#: exponents show four to nine (tests/numerics/test_exponents.py).
STEP_ERROR_IN_RTOL = 10.0


@dataclass(frozen=True)
class Block:
    """A part of a trajectory.

    Attributes
    ----------
    time : float
        How long it was.
    steps : int
        Steps that it took.
    logs : ndarray, shape (k,)
        Logarithms of the factors by which k changes grew, each across those before it.
    status : Status
        DONE, or why it could not be followed to its end.
    """

    time: float
    steps: int
    logs: Array
    status: Status


def growth(
    system: Any,
    memory: StepperState,
    options: Options,
    *,
    count: int,
    duration: float,
    seed: int = 1,
    advance: Callable[..., int] = advance_with_changes,
) -> Iterator[Block]:
    """Follow a trajectory with random small changes, block by block.

    Parameters
    ----------
    system, memory, options
        As for `undula.numerics.integration.time_loop.advance`; the memory is changed in place. The
        frame is the lab's throughout.
    count : int
        Number of changes, at most that of the directions in which the system can move.
    duration : float
        Time to follow it.
    seed : int
        Seed of the changes.
    advance : callable
        `undula.numerics.integration.variational.advance_with_changes`, compiled.

    Yields
    ------
    Block
        `BLOCKS` of them; one that could not be followed to its end is the last.
    """
    longest = min(options.longest_step, duration / BLOCKS)  # so that no block is empty
    moving, options = options.mask == 1.0, options._replace(frame=0, longest_step=longest)
    changes = np.zeros((count, *memory.differences[:, : moving.size].shape))
    random = np.random.default_rng(seed)
    changes[:, 0, moving] = random.normal(size=(count, int(moving.sum())))
    half = derivative_half_bandwidth(type(system))
    band = np.zeros((moving.size, 2 * half + 1))
    start = float(memory.real[TIME])
    for block in range(1, BLOCKS + 1):
        end, logs, status = start + duration * block / BLOCKS, np.zeros(count), Status.PAUSED
        time, steps = float(memory.real[TIME]), int(memory.count[STEPS])
        while status is Status.PAUSED:
            status = Status(advance(system, memory, options, changes, band, end, MOST_STEPS))
            logs += _made_orthonormal(changes, moving)
        yield Block(memory.real[TIME] - time, memory.count[STEPS] - steps, logs, status)
        if status is not Status.DONE:
            return


def mean_rates(blocks: list[Block], rtol: float) -> tuple[Array, Array]:
    """Return the mean rates of growth, not rising, and their errors, each of shape (k,).

    The errors are the largest of three: the statistical one, from means over batches; half the
    difference between the two halves of the time; that of the integration, from the steps that a
    tolerance `rtol` took.
    """
    counted = blocks[round(TURNING_IN * len(blocks)) :]
    rates = _rate(counted)
    order = np.argsort(-rates)
    batches = np.array([_rate(batch) for batch in _cut(counted, BATCHES)])
    statistical = batches.std(axis=0, ddof=1) / np.sqrt(BATCHES)
    first, last = (_rate(half) for half in _cut(counted, 2))
    steps, time = sum(block.steps for block in counted), sum(block.time for block in counted)
    integration = STEP_ERROR_IN_RTOL * rtol * steps / time
    errors = np.maximum(np.maximum(statistical, 0.5 * np.abs(first - last)), integration)
    return rates[order], errors[order]


def _rate(blocks: list[Block]) -> Array:
    return np.asarray(sum(block.logs for block in blocks) / sum(block.time for block in blocks))


def _cut(blocks: list[Block], parts: int) -> list[list[Block]]:
    ends = np.linspace(0, len(blocks), parts + 1).round().astype(int)
    return [blocks[first:last] for first, last in pairwise(ends)]


def _made_orthonormal(changes: Array, moving: Array) -> Array:
    """Make the changes (k, rows, n) orthonormal in place; return logarithms of their sizes (k,).

    The combinations of them that make their first rows so are taken of their whole histories.
    """
    triangle = np.linalg.qr(changes[:, 0, moving].T)[1]
    histories = changes.reshape(len(triangle), -1)
    changes[:] = np.linalg.solve(triangle.T, histories).reshape(changes.shape)
    return np.log(np.abs(np.diag(triangle)))
