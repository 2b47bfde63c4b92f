"""Lyapunov exponents: how fast neighbouring motions part, from the variational equations.

A few small changes of the state are carried along with the motion (`undula.numerics.tangents`) and
made orthonormal again every now and then; what that takes out grows at the Lyapunov exponents. Two
of these are known: a shift in time and a turn about the axis neither grow nor decay. They are 0 up
to the errors of the method; what is left when they are taken out tells whether a motion is chaotic.

Source: Benettin, Galgani, Giorgilli & Strelcyn (1980), Meccanica 15, 9.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from undula.analysis.schedule import Schedule
from undula.arrays import Array, State
from undula.errors import InputError, is_number
from undula.models.model import Model
from undula.numerics.memory import TIME, Memory, start
from undula.numerics.results import Status
from undula.numerics.schemes import NDF
from undula.numerics.system import RATES, derivative_half_bandwidth
from undula.numerics.tangents import advance_with_changes

#: Blocks that a motion is cut into; changes are made orthonormal at the end of each.
BLOCKS = 400
#: The first part of them turns the changes into their directions and is not counted.
TURNING_IN = 0.25
#: Batches of blocks whose means give the statistical error.
BATCHES = 10
# Velocity and turning are one direction if the sine of their angle stays below this: they agree to
# the errors of the integration in spinning, and differ by far more in any other motion.
_PARALLEL = 1e-3
# A first step that moves no position by more than this part of the length.
_FIRST_MOVE = 1e-6


@dataclass(frozen=True)
class Lyapunov:
    """The leading Lyapunov exponents of a motion.

    Attributes
    ----------
    exponents, errors : ndarray, shape (k,)
        The leading exponents [1/T], not rising, and their errors: statistical, from means over
        batches, or half the difference between the two halves of the motion if that is more.
    symmetries : int
        How many of them belong to shifts in time and turns about the axis and are 0.
    duration : float
        Time over which they were taken [T].
    maxima : int
        Maxima of the elastic energy in that time.
    """

    exponents: Array
    errors: Array
    symmetries: int
    duration: float
    maxima: int

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


def lyapunov(
    model: Model,
    state: State,
    duration: float,
    *,
    rtol: float = 1e-6,
    atol: float = 1e-10,
    seed: int = 1,
    progress: Callable[[int, int], None] | None = None,
) -> Lyapunov:
    """Return the leading Lyapunov exponents of the motion that goes on from a state.

    Parameters
    ----------
    model : Model
    state : ndarray, shape (model.size,)
        A state on the attractor, such as the last one of a run.
    duration : float
        Time to follow the motion [T], some hundred beats or more.
    rtol, atol : float
        Tolerances of the integration.
    seed : int
        Seed of the first small changes.
    progress : callable, optional
        Called with the number of blocks done and of all.

    Raises
    ------
    InputError
        The duration is not positive, or the motion cannot be followed.
    """
    if not (is_number(duration) and duration > 0.0):
        raise InputError(f"duration = {duration!r} has to be a positive finite number")
    following = _Following.begin(model, state, duration, rtol, atol, seed)
    growth, maxima = [], 0
    for block in range(BLOCKS):
        grown, found = following.through(duration * (block + 1) / BLOCKS)
        growth.append(grown)
        maxima += found
        if progress:
            progress(block + 1, BLOCKS)
    rates = np.array(growth)[round(TURNING_IN * BLOCKS) :] / (duration / BLOCKS)
    values = rates.mean(axis=0)
    order = np.argsort(-values)
    return Lyapunov(
        exponents=values[order],
        errors=_errors(rates)[order],
        symmetries=following.symmetries,
        duration=duration * (1.0 - TURNING_IN),
        maxima=round(maxima * (1.0 - TURNING_IN)),
    )


def _errors(rates: Array) -> Array:
    """Return the errors of the means of rates (blocks, k)."""
    batches = np.array([part.mean(axis=0) for part in np.array_split(rates, BATCHES)])
    statistical = batches.std(axis=0, ddof=1) / np.sqrt(BATCHES)
    halves = np.array_split(rates, 2)
    drift = 0.5 * np.abs(halves[0].mean(axis=0) - halves[1].mean(axis=0))
    return np.asarray(np.maximum(statistical, drift))


@dataclass
class _Following:
    """A motion with its small changes."""

    model: Model
    memory: Memory
    options: Any
    changes: Array
    band: Array
    symmetries: int = 0

    @classmethod
    def begin(
        cls, model: Model, state: State, duration: float, rtol: float, atol: float, seed: int
    ) -> "_Following":
        x = model.admissible(state)
        unknowns, rates = model.unknowns(x), model.rates(x)
        speed = float(np.abs(model.positions(rates[:-RATES])).max())
        step = min(duration / BLOCKS, _FIRST_MOVE / speed if speed > 0.0 else duration)
        memory = start(model.system, NDF, unknowns, rates, 0.0, step)
        options = Schedule(until=duration, rtol=rtol, atol=atol).options(model)._replace(frame=0)
        moving = model.position_mask == 1.0
        count = model.dimension  # one more than there are symmetries
        first = np.zeros((count, memory.differences.shape[0], unknowns.size))
        random = np.random.default_rng(seed)
        first[:, 0, moving] = random.normal(size=(count, int(moving.sum())))
        half = derivative_half_bandwidth(type(model.system))
        return cls(model, memory, options, first, np.zeros((unknowns.size, 2 * half + 1)))

    def through(self, end: float) -> tuple[Array, int]:
        """Go on to a time; return by what logarithm each change has grown, and energy maxima."""
        code, maxima = advance_with_changes(
            self.model.system, self.memory, self.options, self.changes, self.band, end
        )
        if Status(code) is not Status.DONE:
            raise InputError(
                f"the motion could not be followed beyond t = {self.memory.real[TIME]:.6g}:"
                f" {Status(code).name}; take a smaller rtol"
            )
        moving = self.model.position_mask == 1.0
        triangle = np.linalg.qr(self.changes[:, 0, moving].T)[1]
        # The same combinations that make the last row orthonormal, for the whole history.
        flat = self.changes.reshape(len(triangle), -1)
        self.changes[:] = np.linalg.solve(triangle.T, flat).reshape(self.changes.shape)
        self.symmetries = max(self.symmetries, self._directions())
        return np.log(np.abs(np.diag(triangle))), int(maxima)

    def _directions(self) -> int:
        """Return how many directions the velocity and the turning span."""
        x = self.model.positions(self.memory.differences[0, :-RATES])
        velocity, turning = self.model.rhs(x), self.model.rotation_generator(x)
        sizes = np.linalg.norm(velocity), np.linalg.norm(turning)
        if min(sizes) == 0.0:
            return int(max(sizes) > 0.0)
        cosine = float(velocity @ turning / (sizes[0] * sizes[1]))
        return 2 if np.sqrt(max(0.0, 1.0 - cosine**2)) > _PARALLEL else 1
