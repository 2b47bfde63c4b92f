"""Targets of inverse questions: a quantity of a state or of a threshold, and its value."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from operator import attrgetter
from typing import Any

from undula.analysis.solvers.state_kinds import KINDS, Solved
from undula.analysis.solvers.thresholds import THRESHOLDS
from undula.analysis.states.records import Flapping
from undula.errors import InputError, is_number
from undula.models.model import Model

_RANGES = ("bending_energy", "tip_radius", "tip_height")
_MOVING = ("frequency", "period", "leading_rate")
_PARTS = ("min", "max", "mean")
#: Quantities of a state whose shape is constant; at rest it has no frequency and no period.
_STEADY = {name: f"{name}.mean" for name in _RANGES}
#: Quantities of a state whose shape changes over a period.
_SHAPE_CHANGES = {f"{name}_{part}": f"{name}.{part}" for name in _RANGES for part in _PARTS}
_OUT_OF_PLANE = "leading_rate_out_of_plane"
#: Attribute of a state by the name of a quantity, for each kind of state.
_QUANTITIES: Mapping[str, Mapping[str, str]] = {
    "spinning": {name: name for name in _MOVING} | _STEADY,
    "flapping": {name: name for name in (*_MOVING, "leading_rate_in_plane", _OUT_OF_PLANE)}
    | _SHAPE_CHANGES,
    "equilibrium": {"leading_rate": "leading_rate"} | _STEADY,
    "periodic": {name: name for name in _MOVING} | _SHAPE_CHANGES,
}
# Relative error of an extreme over a period, which depends on the instants of its samples.
_EXTREMUM_ERROR = 1e-6
#: Quantities of a threshold.
_OF_THRESHOLDS = {"value": "value", "frequency": "frequency"}


@dataclass(frozen=True)
class Target:
    """The value that a quantity is to have.

    Attributes
    ----------
    kind : str
        Kind of state, or name of a threshold.
    quantity : str
        Name of the quantity.
    value : float
        Its value.
    """

    kind: str
    quantity: str
    value: float

    @property
    def of(self) -> Callable[[Any], float]:
        """Function from a state or a threshold to the quantity."""
        return attrgetter(_quantities_of(self.kind)[self.quantity])

    def __str__(self) -> str:
        """Return kind, quantity and value in a few words."""
        return f"{self.kind} with {self.quantity} {self.value:.6g}"


def target_of(model: Model, kind: str, wanted: Mapping[str, float]) -> Target:
    """Return the target of a question.

    Parameters
    ----------
    model : Model
        A confined one has no growth rate out of its plane.
    kind : str
        Kind of state, or name of a threshold.
    wanted : mapping of str to float
        One quantity and its value.

    Raises
    ------
    InputError
        The kind or the quantity does not exist, there is not exactly one target, or its value is
        not a finite number.
    """
    names = [
        name
        for name in _quantities_of(kind)
        if not (name == _OUT_OF_PLANE and model.dimension == 2)
    ]
    choice = f"take {' or '.join(names)}"
    if len(wanted) != 1:
        given = " and ".join(wanted) or "no target"
        raise InputError(f"{given} given for {kind}; give exactly one target, {choice}")
    ((quantity, value),) = wanted.items()
    if quantity not in names:
        raise InputError(f"{quantity} is no quantity of {kind}; {choice}")
    if not is_number(value):
        raise InputError(f"target {quantity} = {value!r} has to be a finite number")
    return Target(kind, quantity, float(value))


def _quantities_of(kind: str) -> Mapping[str, str]:
    if kind in THRESHOLDS:
        return _OF_THRESHOLDS
    if kind not in KINDS:
        raise InputError(
            f"{kind!r} is no kind of state and no threshold; take {', '.join(KINDS)}, or"
            f" {', '.join(THRESHOLDS)}"
        )
    return _QUANTITIES[kind]


def solver_error_of(state: Solved, target: Target) -> float:
    """Return the estimated error of a quantity of a state on its links, in the quantity's unit.

    It is the relative error of the frequency, or at rest the residual. A growth rate also has the
    distance of trivial exponents from 0, and an extreme over a period the error of its samples.
    """
    value = target.of(state)
    relative = state.solver_error / state.frequency if state.frequency else state.residual
    error = abs(relative * value)
    if target.quantity.endswith(("_min", "_max")):
        error += _EXTREMUM_ERROR * abs(value)
    if target.quantity.startswith("leading_rate"):
        error += _error_of_rates(state)
    return float(error)


def _error_of_rates(state: Solved) -> float:
    """Return the distance of the trivial exponents from 0 [1/T]; of a map, by its multipliers."""
    trivial = getattr(state, "trivial", 0.0)
    if isinstance(trivial, tuple):
        half = 0.5 if isinstance(state, Flapping) else 1.0
        return float(max(trivial) / (half * state.period))
    return float(abs(trivial))
