"""Sensitivities: derivatives of a state's or a threshold's numbers by every parameter of its model.

Source: the implicit-function theorem on the solved equations, see `state_slopes`.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import pandas as pd
import xarray as xr

from undula.analysis.linear.results import Method
from undula.analysis.one_thread import on_one_thread
from undula.analysis.parameters import (
    FORCE,
    changed,
    continuous_parameters,
    table_entries,
    value_of,
)
from undula.analysis.record import Fact, Record
from undula.analysis.sensitivity.onset_slopes import onset_slopes
from undula.analysis.sensitivity.state_slopes import RELATIVE_STEP, fold_slope, state_slopes
from undula.analysis.solvers.quantities import quantities_of
from undula.analysis.solvers.state_kinds import Solved
from undula.analysis.solvers.threshold_record import Threshold
from undula.analysis.states.state import State
from undula.errors import InputError
from undula.models.model import Model


@dataclass(frozen=True, repr=False)
class Sensitivities(Record, Mapping[str, Mapping[str, float]]):
    """Derivatives by parameter and quantity: a mapping of mappings.

    Attributes
    ----------
    of : str
        The kind of state, or the name of the threshold.
    links : int
        Number of links of the model that was differentiated.
    quantities : mapping of str to float
        The quantities themselves, by name, in the model's units.
    slopes : mapping of str to mapping of str to float
        By name of the parameter the derivative of each quantity.

    Examples
    --------
    >>> import undula as un
    >>> state = un.find(un.Filament(8, un.TipLoad(75.0)), "spinning")
    >>> slopes = un.sensitivities(state)
    >>> f"{slopes['load.force']['frequency']:.3f} turns per T for each B/L^2"
    '1.626 turns per T for each B/L^2'
    """

    of: str
    links: int
    quantities: Mapping[str, float]
    slopes: Mapping[str, Mapping[str, float]]

    def __getitem__(self, parameter: str) -> Mapping[str, float]:
        """Return the derivatives of all quantities by a parameter."""
        if parameter not in self.slopes:
            raise KeyError(f"{parameter}; there are {', '.join(self.slopes)}")
        return self.slopes[parameter]

    def __iter__(self) -> Iterator[str]:
        """Return the names of the parameters, in their order."""
        return iter(self.slopes)

    def __len__(self) -> int:
        """Return the number of parameters."""
        return len(self.slopes)

    def facts(self) -> dict[str, Fact]:
        """Return the derivatives of the first quantity by parameter."""
        first = next(iter(self.quantities))
        return {name: Fact(row[first]) for name, row in self.slopes.items()}

    def to_dataframe(self) -> pd.DataFrame:
        """Return a row for each parameter and a column for each quantity."""
        return pd.DataFrame.from_dict(dict(self.slopes), orient="index")

    def to_xarray(self) -> xr.Dataset:
        """Return the derivative of each quantity along the parameters, as a dataset."""
        return xr.Dataset.from_dataframe(self.to_dataframe().rename_axis("parameter"))

    def __str__(self) -> str:
        """Return the derivatives of the first quantity in one line."""
        name = next(iter(self.quantities))
        parts = [f"{parameter} {row[name]:.5g}" for parameter, row in self.slopes.items()]
        shown = ", ".join(parts[:4]) + (f", {len(parts) - 4} more" if len(parts) > 4 else "")
        return f"d {name} of {self.of} ({self.links} links) by {shown}"


@on_one_thread
def sensitivities(
    solved: Solved | Threshold, *, parameters: Sequence[str] | None = None
) -> Sensitivities:
    """Return the derivatives of the numbers of a state or a threshold by its parameters.

    They are those of the solved equations, by the implicit-function theorem: one linear solve a
    parameter.

    Parameters
    ----------
    solved : Spinning, Flapping, Equilibrium, Periodic or Threshold
        Of a state frequency, energy, extents of the tip and leading growth rates are
        differentiated; of a threshold its force and the frequency there. A threshold in the limit
        of many links is differentiated on the finest of them.
    parameters : sequence of str, optional
        Names such as "load.force", "model.drag_ratio" or "load.density[2]"; by default all numbers
        of model and load and all values of their tables, but for those that change the symmetry of
        the body.

    Returns
    -------
    Sensitivities

    Raises
    ------
    InputError
        The argument is no state and no threshold with a value, or a parameter is not one of the
        model, is whole, or changes the symmetry of the body.

    Examples
    --------
    >>> import undula as un
    >>> onset = un.threshold(un.Filament(20, un.LinearLoad(75.0, slope=0.5)), "onset")
    >>> slopes = un.sensitivities(onset)
    >>> slopes["load.slope"]["value"] < 0.0 < onset.value
    True
    """
    if isinstance(solved, Threshold):
        return _of_threshold(solved, parameters)
    if not isinstance(solved, State):
        raise InputError(
            f"{type(solved).__name__} is no state and no threshold; give what find or threshold"
            " returns"
        )
    names = _names(solved.model, parameters)
    slopes = {name: state_slopes(solved, name) for name in names}
    return Sensitivities(solved.kind, solved.model.links, quantities_of(solved), slopes)


def _of_threshold(threshold: Threshold, parameters: Sequence[str] | None) -> Sensitivities:
    if threshold.value is None or threshold.model is None:
        raise InputError(f"this threshold has no value to differentiate: {threshold.reason}")
    model = threshold.model if threshold.at is None else threshold.at.state.model
    names = [name for name in _names(model, parameters) if name != FORCE]
    values = {"value": threshold.value, "frequency": threshold.frequency or 0.0}
    if threshold.at is None:
        method: Method | None = "discrete" if threshold.links else None
        slopes = {name: onset_slopes(model, name, method) for name in names}
    else:
        state, is_fold = threshold.at.state, threshold.at.kind == "fold"
        by_force = None if is_fold else state_slopes(state, FORCE, _critical)
        slopes = {name: _along(state, name, by_force) for name in names}
    return Sensitivities(threshold.kind, model.links, values, slopes)


def _along(state: Solved, parameter: str, by_force: Mapping[str, float] | None) -> dict[str, float]:
    """Return the slopes of the force at which the leading rate is 0, or which is a fold."""
    if by_force is None:
        return {"value": fold_slope(state, parameter)}
    here = state_slopes(state, parameter, _critical)
    force = -here["leading_rate"] / by_force["leading_rate"]
    return {"value": force, "frequency": here["frequency"] + by_force["frequency"] * force}


def _critical(state: State) -> dict[str, float]:
    """Return the rate that is 0 at a threshold, and the frequency that a threshold reports."""
    if state.frequency == 0.0:
        return {
            "leading_rate": state.leading_rate,
            "frequency": abs(float(state.exponents[0].imag)) / (2.0 * math.pi),
        }
    return {"leading_rate": state.leading_rate, "frequency": state.frequency}


def _names(model: Model, parameters: Sequence[str] | None) -> list[str]:
    """Return the parameters by which the model can be differentiated."""
    if parameters is None:
        every = [*continuous_parameters(model), *table_entries(model)]
        return [name for name in every if _keeps_symmetry(model, name)]
    for name in parameters:
        value_of(model, name)  # refuses what is no parameter
        if not _keeps_symmetry(model, name):
            raise InputError(
                f"{name} takes the rotational symmetry from the body, so that the state does not"
                " go on along it; take another parameter"
            )
    return list(parameters)


def _keeps_symmetry(model: Model, parameter: str) -> bool:
    value = value_of(model, parameter)
    step = RELATIVE_STEP * max(1.0, abs(value))
    for side in (value + step, value - step):
        try:
            other: Any = changed(model, parameter, side)
        except InputError:
            continue
        return bool(other.axisymmetric == model.axisymmetric)
    return False
