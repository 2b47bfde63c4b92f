"""Lyapunov exponents of a model's motion: how fast neighbouring motions part.

Two of them are known: a shift in time and a turn about the axis neither grow nor decay. They are 0
up to the errors of the method; what is left when they are taken out tells whether a motion is
chaotic.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from undula.analysis.run_settings import Schedule
from undula.arrays import Array, State
from undula.errors import InputError, is_number
from undula.models.model import Model
from undula.numerics.integration.lyapunov import BLOCKS, TURNING_IN, growth, mean_rates
from undula.numerics.integration.schemes import NDF
from undula.numerics.integration.status import Status
from undula.numerics.integration.stepper_state import TIME, StepperState, start
from undula.numerics.integration.system import RATES

# Velocity and turning are one direction if the sine of their angle stays below this: they agree to
# the errors of the integration in spinning, and differ by far more in any other motion.
_PARALLEL = 1e-3
# A speed below this is round-off [L/T].
_AT_REST = 1e-9
# A first step that moves no position by more than this part of the length.
_FIRST_MOVE = 1e-6


@dataclass(frozen=True)
class Lyapunov:
    """The leading Lyapunov exponents of a motion.

    Attributes
    ----------
    exponents, errors : ndarray, shape (k,)
        The leading exponents [1/T], not rising, and their errors: see
        `undula.numerics.integration.lyapunov`.
    symmetries : int
        How many of them belong to shifts in time and turns about the axis and are 0.
    duration : float
        Time over which they were taken [T].
    """

    exponents: Array
    errors: Array
    symmetries: int
    duration: float

    @property
    def value(self) -> float:
        """The largest exponent, 0 within its error for every regular motion [1/T]."""
        return float(self.exponents[0])

    @property
    def error(self) -> float:
        """Its error [1/T]."""
        return float(self.errors[0])

    @property
    def _others(self) -> Array:
        """Indices of the exponents that are left without the ones nearest to 0."""
        known = np.argsort(np.abs(self.exponents))[: self.symmetries]
        return np.setdiff1d(np.arange(self.exponents.size), known)

    @property
    def beyond_symmetry(self) -> float:
        """The largest exponent when those of the symmetries are taken out [1/T]."""
        return float(self.exponents[self._others[0]])

    @property
    def beyond_symmetry_error(self) -> float:
        """Its error [1/T]."""
        return float(self.errors[self._others[0]])

    def as_dict(self) -> dict[str, Any]:
        """Return all of it in plain JSON types."""
        return {
            "value": self.value,
            "error": self.error,
            "beyond_symmetry": self.beyond_symmetry,
            "beyond_symmetry_error": self.beyond_symmetry_error,
            "exponents": self.exponents.tolist(),
            "errors": self.errors.tolist(),
            "symmetries": self.symmetries,
            "duration": self.duration,
        }


@dataclass(frozen=True)
class NotFollowed:
    """No exponents, because the motion could not be followed; `reason` says why and what to do."""

    reason: str


def lyapunov(
    model: Model,
    state: State,
    duration: float,
    *,
    rtol: float = 1e-6,
    atol: float = 1e-10,
    seed: int = 1,
    progress: Callable[[int, int], None] | None = None,
) -> Lyapunov | NotFollowed:
    """Return the leading Lyapunov exponents of the motion that goes on from a state.

    Parameters
    ----------
    model : Model
    state : ndarray, shape (model.size,) or (n,)
        A state on the attractor, such as the last one of a run, or the integrator's vector there,
        which knows how far joints have wound up.
    duration : float
        Time to follow the motion [T], some hundred beats or more; the first quarter is not counted.
    rtol, atol : float
        Tolerances of the integration.
    seed : int
        Seed of the first small changes.
    progress : callable, optional
        Called with the number of blocks done and of all.

    Returns
    -------
    Lyapunov or NotFollowed

    Raises
    ------
    InputError
        The duration is not positive, or the state does not move.
    """
    if not (is_number(duration) and duration > 0.0):
        raise InputError(f"duration = {duration!r} has to be a positive finite number")
    memory = _begin(model, state, duration)
    options = Schedule(until=duration, rtol=rtol, atol=atol).options(model)
    blocks, symmetries = [], 0
    # One more than there are symmetries.
    changes = model.dimension
    for block in growth(model.system, memory, options, count=changes, duration=duration, seed=seed):
        if block.status is not Status.DONE:
            reached = float(memory.real[TIME])
            return NotFollowed(
                f"the motion could not be followed beyond t = {reached:.6g}: {block.status.advice}"
            )
        blocks.append(block)
        symmetries = max(symmetries, _directions(model, memory))
        if progress:
            progress(len(blocks), BLOCKS)
    values, errors = mean_rates(blocks, rtol)
    return Lyapunov(values, errors, symmetries, duration * (1.0 - TURNING_IN))


def _begin(model: Model, state: Array, duration: float) -> StepperState:
    known = state.shape == model.position_mask.shape
    x = model.positions(state) if known else model.admissible(state)
    rates = model.rates(x)
    speed = float(np.abs(model.positions(rates[:-RATES])).max())
    if speed < _AT_REST:
        raise InputError("a state at rest has no motion to take Lyapunov exponents of")
    unknowns = state if known else model.unknowns(x)
    step = min(duration / BLOCKS, _FIRST_MOVE / speed)
    return start(model.system, NDF, unknowns, rates, 0.0, step)


def _directions(model: Model, memory: StepperState) -> int:
    """Return how many directions the velocity and the turning span."""
    x = model.positions(memory.differences[0, :-RATES])
    velocity, turning = model.rhs(x), model.rotation_generator(x)
    sizes = np.linalg.norm(velocity), np.linalg.norm(turning)
    if min(sizes) == 0.0:
        return int(max(sizes) > 0.0)
    cosine = float(velocity @ turning / (sizes[0] * sizes[1]))
    return 2 if np.sqrt(max(0.0, 1.0 - cosine**2)) > _PARALLEL else 1
