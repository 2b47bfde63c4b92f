"""Lyapunov exponents of a motion: rates of divergence of neighbouring motions.

Shifts in time and rotations about the axis neither grow nor decay: their exponents are 0 up to the
errors of the method. The largest of the other exponents is positive in chaos.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from undula.analysis.record import Fact, Record
from undula.analysis.run_settings import Schedule
from undula.arrays import Array, State
from undula.errors import InputError, is_number
from undula.models.model import Model
from undula.numerics.integration.lyapunov import BLOCKS, TRANSIENT_SHARE, growth, mean_rates
from undula.numerics.integration.schemes import NDF
from undula.numerics.integration.status import Status
from undula.numerics.integration.stepper_state import TIME, StepperState, start
from undula.numerics.integration.system import RATES

# Largest sine of the angle between velocity and rotation at which they are one direction: in
# spinning they agree to the errors of the integration, in other motions they differ by far more.
_MAX_PARALLEL_SINE = 1e-3
# Least speed of a motion above round-off [L/T].
_MIN_SPEED = 1e-9
# Largest displacement of a position in the first step [L].
_FIRST_DISPLACEMENT = 1e-6


@dataclass(frozen=True, repr=False)
class Lyapunov(Record):
    """The leading Lyapunov exponents of a motion.

    Attributes
    ----------
    exponents, errors : ndarray, shape (k,)
        The leading exponents [1/T], not rising, and their errors: see
        `undula.numerics.integration.lyapunov`.
    symmetries : int
        Number of exponents of shifts in time and rotations about the axis, which are 0.
    duration : float
        Time over which they were averaged [T].
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
        """Error of the largest exponent [1/T]."""
        return float(self.errors[0])

    @property
    def _others(self) -> Array:
        """Indices of the exponents without those nearest to 0, which are the symmetries'."""
        symmetric = np.argsort(np.abs(self.exponents))[: self.symmetries]
        return np.setdiff1d(np.arange(self.exponents.size), symmetric)

    @property
    def beyond_symmetry(self) -> float:
        """The largest exponent without those of the symmetries [1/T]."""
        return float(self.exponents[self._others[0]])

    @property
    def beyond_symmetry_error(self) -> float:
        """Error of that exponent [1/T]."""
        return float(self.errors[self._others[0]])

    def facts(self) -> dict[str, Fact]:
        """Return the largest exponents and their duration by name."""
        return {
            "largest": Fact(self.value, "1/T", self.error),
            "beyond_symmetry": Fact(self.beyond_symmetry, "1/T", self.beyond_symmetry_error),
            "symmetries": Fact(self.symmetries),
            "duration": Fact(self.duration, "T"),
        }

    def to_dataframe(self) -> pd.DataFrame:
        """Return a row for each exponent, with its error."""
        return pd.DataFrame({"exponent": self.exponents, "error": self.errors})

    def __str__(self) -> str:
        """Return the largest exponents with their errors in one line."""
        return (
            f"largest Lyapunov exponent {self.value:.4g} ± {self.error:.1g} /T, beyond the"
            f" symmetries {self.beyond_symmetry:.4g} ± {self.beyond_symmetry_error:.1g} /T, over"
            f" {self.duration:.4g} T"
        )

    def as_dict(self) -> dict[str, Any]:
        """Return all fields in plain JSON types."""
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
    """Failure of an integration along a motion.

    Attributes
    ----------
    reason : str
        Cause and remedy in one sentence.
    """

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
    """Return the leading Lyapunov exponents of the motion from a state.

    Parameters
    ----------
    model : Model
        Model of the filament or chain.
    state : ndarray, shape (model.size,) or (n,)
        A state on the attractor, such as the last one of a run, or the unknowns of the integrator
        there, which include the turns of wound-up joints.
    duration : float
        Time to follow the motion [T], about a hundred beats or more. The first quarter, in which
        the perturbations align, is not counted.
    rtol, atol : float
        Relative and absolute [rad] error tolerance of a step, as in `integrate`.
    seed : int
        Seed of the random first perturbations.
    progress : callable, optional
        Called with the number of blocks done and the number of all blocks.

    Returns
    -------
    Lyapunov or NotFollowed
        NotFollowed if the integration fails.

    Raises
    ------
    InputError
        The duration is not positive, or the state is at rest.

    Examples
    --------
    A spinning chain returns to its shape: without the exponent of its rotation, which is a shift in
    time as well, the largest is negative.

    >>> import undula as un
    >>> model = un.Filament(6, load=un.TipLoad(80.0))
    >>> run = un.integrate(model, un.helix(model), until=0.3)
    >>> exponents = un.lyapunov(model, model.from_nodes(run.last_shape), 0.2)
    >>> bool(exponents.beyond_symmetry < 0.0)
    True
    """
    if not (is_number(duration) and duration > 0.0):
        raise InputError(f"duration = {duration!r} has to be a positive finite number")
    integrator = _begin(model, state, duration)
    options = Schedule(until=duration, rtol=rtol, atol=atol).options(model)
    blocks, symmetries = [], 0
    # One more than the symmetries of the model.
    count = model.dimension
    for block in growth(
        model.system, integrator, options, count=count, duration=duration, seed=seed
    ):
        if block.status is not Status.DONE:
            reached = float(integrator.real[TIME])
            return NotFollowed(
                f"the motion could not be followed beyond t = {reached:.6g}: {block.status.advice}"
            )
        blocks.append(block)
        symmetries = max(symmetries, _directions(model, integrator))
        if progress:
            progress(len(blocks), BLOCKS)
    values, errors = mean_rates(blocks, rtol)
    return Lyapunov(values, errors, symmetries, duration * (1.0 - TRANSIENT_SHARE))


def _begin(model: Model, state: Array, duration: float) -> StepperState:
    in_integrator_form = state.shape == model.position_mask.shape
    x = model.positions(state) if in_integrator_form else model.admissible(state)
    rates = model.rates(x)
    speed = float(np.abs(model.positions(rates[:-RATES])).max())
    if speed < _MIN_SPEED:
        raise InputError("a state at rest has no motion to take Lyapunov exponents of")
    unknowns = state if in_integrator_form else model.unknowns(x)
    step = min(duration / BLOCKS, _FIRST_DISPLACEMENT / speed)
    return start(model.system, NDF, unknowns, rates, 0.0, step)


def _directions(model: Model, memory: StepperState) -> int:
    """Return the dimension of the span of velocity and rotation."""
    x = model.positions(memory.differences[0, :-RATES])
    velocity, turning = model.rhs(x), model.rotation_generator(x)
    norms = np.linalg.norm(velocity), np.linalg.norm(turning)
    if min(norms) == 0.0:
        return int(max(norms) > 0.0)
    cosine = float(velocity @ turning / (norms[0] * norms[1]))
    return 2 if np.sqrt(max(0.0, 1.0 - cosine**2)) > _MAX_PARALLEL_SINE else 1
