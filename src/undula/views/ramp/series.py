"""Stored ramps in the form that figures use."""

import json
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from undula.errors import InputError
from undula.views.common import style
from undula.views.common.verdict_styles import look_of
from undula.views.run.scene import Floats

#: Variables of a stored ramp that figures need.
NEEDED = ("value", "direction", "verdict", "bending_energy_min", "bending_energy_max", "shapes")

# Margin at both ends of the parameter axis, as a fraction of its span.
_MARGIN = 0.02


@dataclass(frozen=True)
class StepSeries:
    """A ramp in the form that figures use.

    Attributes
    ----------
    load : str
        Model and load in words.
    parameter : str
        Name of the varied parameter.
    units : mapping of str to str
        Names of units by quantity.
    values : ndarray of shape (m,)
        Values of the parameter.
    up : ndarray of shape (m,)
        True for steps with rising parameter.
    verdicts : tuple of str
        Verdict of each step.
    low, high : ndarray of shape (m,)
        Least and greatest bending energy.
    shapes : ndarray of shape (m, k, n, 3)
        Shapes of each step, in the order of time [L].
    """

    load: str
    parameter: str
    units: style.UnitNames
    values: Floats
    up: NDArray[np.bool_]
    verdicts: tuple[str, ...]
    low: Floats
    high: Floats
    shapes: Floats

    @property
    def there_and_back(self) -> bool:
        """True if the ramp returns."""
        return bool(np.any(self.up != self.up[0]))

    @property
    def span(self) -> tuple[float, float]:
        """Ends of the parameter axis."""
        low, high = float(self.values.min()), float(self.values.max())
        margin = _MARGIN * (high - low) or max(0.1 * abs(low), 0.1)
        return low - margin, high + margin


def read_series(datasets: Sequence[xr.Dataset]) -> list[StepSeries]:
    """Return stored ramps in the form that figures use.

    Raises
    ------
    InputError
        No ramp is given, a variable is missing, or the ramps are along different parameters.
    """
    series = [_read(dataset) for dataset in datasets]
    parameters = sorted({ramp.parameter for ramp in series})
    if not parameters:
        raise InputError("datasets is empty: give at least one series of steps")
    if len(parameters) > 1:
        raise InputError(
            f"the series are along {' and '.join(parameters)}: give series along one parameter"
        )
    return series


def verdict_colours(verdicts: Sequence[str]) -> dict[str, str]:
    """Return the colours of verdicts by name, in the order of appearance."""
    return {verdict: look_of(verdict).colour for verdict in dict.fromkeys(verdicts)}


def _read(dataset: xr.Dataset) -> StepSeries:
    missing = [name for name in NEEDED if name not in dataset]
    if missing or "parameter" not in dataset.attrs or dataset.sizes["step"] == 0:
        raise InputError(
            f"the series lacks {', '.join(missing) or 'steps or its parameter'}: give a result of"
            " `undula step`"
        )
    values, directions, verdicts, low, high, shapes = (dataset[name].values for name in NEEDED)
    return StepSeries(
        str(dataset.attrs.get("load", "")),
        str(dataset.attrs["parameter"]),
        dict(style.FILAMENT) | json.loads(dataset.attrs.get("units", "{}")),
        values,
        directions == "up",
        tuple(map(str, verdicts)),
        low,
        high,
        shapes,
    )
