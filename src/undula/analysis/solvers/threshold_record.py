"""A threshold as a record: a force at which stability changes, or why there is no such force."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import pandas as pd
import xarray as xr

from undula.analysis.record import Fact, Record
from undula.analysis.solvers.threshold_search import Missed
from undula.analysis.states.branch import Bifurcation
from undula.analysis.states.not_found import NotFound
from undula.arrays import Array
from undula.models.model import Model


@dataclass(frozen=True, repr=False)
class Threshold(Record):
    """A force at which stability changes.

    Attributes
    ----------
    kind : {"onset", "spinning-lost", "flapping-gained", "flapping-lost"}
        The change of stability.
    value : float or None
        The force [B/L^2]: of the continuous body if `links` are several or empty, else on these
        links. None if the threshold was not found.
    error : float or None
        Estimated error of the value against the body that the links stand for, of links and solver
        together [B/L^2]; None if it could not be estimated.
    frequency : float or None
        Of the state there [cycles per T].
    second_frequency : float or None
        Of the disturbance that changes from decay to growth or back [cycles per T].
    bifurcation : str or None
        The kind of bifurcation.
    reason : str or None
        Why there is no value.
    at : Bifurcation or None
        The bifurcation itself, on the finest links.
    links : tuple of int
        Numbers of links on which the threshold was solved for; empty for the continuum.
    solver_error : float or None
        Estimated error of the value on these links [B/L^2].
    searched_to : float or None
        The force at which the search ended without a threshold, if a farther search might find one.
    """

    kind: str
    value: float | None
    error: float | None = None
    frequency: float | None = None
    second_frequency: float | None = None
    bifurcation: str | None = None
    reason: str | None = None
    at: Bifurcation[Any] | None = None
    links: tuple[int, ...] = ()
    solver_error: float | None = None
    searched_to: float | None = None
    model: Model | None = None

    def facts(self) -> dict[str, Fact]:
        """Return value, frequencies and bifurcation by name."""
        unit = "" if self.model is None else self.model.units.force
        return {
            "threshold": Fact(self.kind),
            "value": Fact(self.value, unit, self.error),
            "solver_error": Fact(self.solver_error, unit),
            "frequency": Fact(self.frequency, "cycles per T"),
            "second_frequency": Fact(self.second_frequency, "cycles per T"),
            "bifurcation": Fact(self.bifurcation or ""),
            "links": Fact(", ".join(map(str, self.links)) or "continuum"),
            "reason": Fact(self.reason or ""),
        }

    def __bool__(self) -> bool:
        """Return True if the threshold exists."""
        return self.value is not None

    def __str__(self) -> str:
        """Return the threshold in one line."""
        if self.value is None:
            farther = "" if self.searched_to is None else "; a larger up_to looks farther"
            return f"no {self.kind}: {self.reason}{farther}"
        error = "" if self.error is None else f" ± {self.error:.1g}"
        links = ""
        if len(self.links) == 1 and self.error != self.solver_error:
            links = f" ({self.links[0]} links, solved to {self.solver_error:.1g})"
        return (
            f"{self.kind} at force {self.value:.10g}{error}{links}, {self.bifurcation},"
            f" {self.frequency:.8g} cycles per T"
        )


@dataclass(frozen=True, repr=False)
class ThresholdCurve(Record):
    """A threshold along a parameter; a sequence of thresholds.

    Attributes
    ----------
    kind : str
        Name of the threshold.
    parameter : str
        Name of the parameter.
    parameter_values : ndarray of shape (m,)
        Its values.
    thresholds : tuple of Threshold
        One at each value.
    """

    kind: str
    parameter: str
    parameter_values: Array
    thresholds: tuple[Threshold, ...]

    _figure: ClassVar[str] = "undula.views.records.linear:curve"

    @property
    def forces(self) -> Array:
        """The forces (m,) [B/L^2], NaN where the threshold does not exist."""
        return np.array([np.nan if t.value is None else t.value for t in self.thresholds])

    @property
    def errors(self) -> Array:
        """The errors of the forces (m,) [B/L^2], NaN where unknown."""
        return np.array([np.nan if t.error is None else t.error for t in self.thresholds])

    @property
    def frequencies(self) -> Array:
        """The frequencies there (m,) [cycles per T], NaN where unknown."""
        return np.array([np.nan if t.frequency is None else t.frequency for t in self.thresholds])

    def __len__(self) -> int:
        """Return the number of thresholds."""
        return len(self.thresholds)

    def __getitem__(self, index: int) -> Threshold:
        """Return a threshold by its number."""
        return self.thresholds[index]

    def __iter__(self) -> Iterator[Threshold]:
        """Return the thresholds in their order."""
        return iter(self.thresholds)

    def facts(self) -> dict[str, Fact]:
        """Return parameter, and ends of the forces, by name."""
        known = self.forces[np.isfinite(self.forces)]
        ends = (float(known.min()), float(known.max())) if known.size else (None, None)
        error = float(np.nanmax(self.errors)) if np.isfinite(self.errors).any() else None
        return {
            "threshold": Fact(self.kind),
            "parameter": Fact(self.parameter),
            "values": Fact(len(self)),
            "least": Fact(ends[0], "B/L^2", error),
            "largest": Fact(ends[1], "B/L^2", error),
        }

    def to_xarray(self) -> xr.Dataset:
        """Return forces, errors and frequencies along the parameter, as a dataset."""
        columns = {
            "force": ("value", self.forces, {"units": "B/L^2"}),
            "error": ("value", self.errors, {"units": "B/L^2"}),
            "frequency": ("value", self.frequencies, {"units": "cycles per T"}),
        }
        along = {"value": ("value", self.parameter_values, {"long_name": self.parameter})}
        return xr.Dataset(columns, coords=along)

    def to_dataframe(self) -> pd.DataFrame:
        """Return a row for each value of the parameter."""
        return self.to_xarray().to_dataframe().reset_index(names=self.parameter)

    def __str__(self) -> str:
        """Return parameter and ends of the forces, with the largest error, in one line."""
        facts = self.facts()
        return (
            f"{self.kind} at {len(self)} values of {self.parameter}: force from"
            f" {facts['least']} to {facts['largest']}"
        )


def without_value(kind: str, failure: NotFound) -> Threshold:
    """Return the record of a threshold that was not found."""
    searched_to = failure.searched_to if isinstance(failure, Missed) else None
    return Threshold(kind, None, reason=failure.reason, searched_to=searched_to)
