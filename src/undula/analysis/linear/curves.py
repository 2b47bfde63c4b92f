"""Curves of linear stability: the leading eigenvalue over forces, thresholds over a parameter."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pandas as pd
import xarray as xr

from undula.analysis.linear.results import Method, Onset
from undula.analysis.record import Fact, Record
from undula.arrays import Array


@dataclass(frozen=True, repr=False)
class GrowthCurve(Record):
    """The leading eigenvalue against the force, and against a second parameter if one was given.

    Attributes
    ----------
    forces : ndarray of shape (m,)
        Total forces [B/L^2].
    rates, frequencies, errors : ndarray of shape (m,), or (k, m) with a parameter
        Rate [1/T], frequency [cycles/T] and estimated error of the eigenvalue [1/T].
    method : {"spectral", "modes", "discrete"}
        Discretisation.
    parameter : str or None
        Name of the second parameter, such as "load.slope".
    values : ndarray of shape (k,) or None
        Values of the second parameter, in its unit.
    paper_time : bool
        True if rates and frequencies are smaller by the drag ratio, as in the printed equation.
    """

    forces: Array
    rates: Array
    frequencies: Array
    errors: Array
    method: Method
    parameter: str | None = None
    values: Array | None = None
    paper_time: bool = False

    _figure: ClassVar[str] = "undula.views.records.linear:growth"

    def facts(self) -> dict[str, Fact]:
        """Return the range of forces and the largest rate in it, by name."""
        return {
            "force_from": Fact(float(self.forces[0]), "B/L^2"),
            "force_to": Fact(float(self.forces[-1]), "B/L^2"),
            "largest_rate": Fact(float(self.rates.max()), "1/T", float(self.errors.max())),
            "method": Fact(self.method),
        }

    def to_xarray(self) -> xr.Dataset:
        """Return rates, frequencies and errors over the forces, as a dataset."""
        dims = ("force",) if self.values is None else ("value", "force")
        coords = {"force": ("force", self.forces, {"units": "B/L^2"})}
        if self.values is not None:
            coords["value"] = ("value", self.values, {"long_name": str(self.parameter)})
        columns = {
            "rate": (dims, self.rates, {"units": "1/T"}),
            "frequency": (dims, self.frequencies, {"units": "cycles per T"}),
            "error": (dims, self.errors, {"units": "1/T"}),
        }
        return xr.Dataset(columns, coords=coords)

    def to_dataframe(self) -> pd.DataFrame:
        """Return a row for each force, and each value of the parameter if there is one."""
        return self.to_xarray().to_dataframe().reset_index()

    def __str__(self) -> str:
        """Return the range of forces and the largest rate in one line."""
        along = "" if self.values is None else f", {len(self.values)} values of {self.parameter}"
        return (
            f"leading rate at {len(self.forces)} forces from {self.forces[0]:.6g} to"
            f" {self.forces[-1]:.6g}{along}: up to {self.rates.max():.6g} ±"
            f" {self.errors.max():.1g} /T ({self.method})"
        )


@dataclass(frozen=True, repr=False)
class CriticalCurve(Record):
    """Thresholds against a parameter; NaN where the straight state stays stable.

    Attributes
    ----------
    parameter : str
        Name of the parameter, such as "load.slope".
    values : ndarray of shape (k,)
        Values of the parameter, in its unit.
    onsets : tuple of Onset
        The onset at each value.
    """

    parameter: str
    values: Array
    onsets: tuple[Onset, ...]

    @property
    def forces(self) -> Array:
        """Hopf forces [B/L^2], of shape (k,)."""
        return self._of_hopf("force")

    @property
    def frequencies(self) -> Array:
        """Frequencies at the Hopf forces [cycles/T], of shape (k,)."""
        return self._of_hopf("frequency")

    @property
    def errors(self) -> Array:
        """Estimated errors of the Hopf forces [B/L^2], of shape (k,)."""
        return self._of_hopf("error")

    @property
    def growth_slopes(self) -> Array:
        """Change of the growth rate with the force [1/T per B/L^2], of shape (k,)."""
        return self._of_hopf("growth_slope")

    @property
    def oscillatory_forces(self) -> Array:
        """Least forces at which the leading eigenvalue is complex [B/L^2], of shape (k,)."""
        return np.array(
            [
                np.nan if onset.oscillatory_force is None else onset.oscillatory_force
                for onset in self.onsets
            ]
        )

    @property
    def method(self) -> Method:
        """Discretisation by which the thresholds were computed."""
        return self.onsets[0].method

    def _of_hopf(self, name: str) -> Array:
        return np.array([getattr(onset.hopf, name, np.nan) for onset in self.onsets])

    _figure: ClassVar[str] = "undula.views.records.linear:critical"

    def facts(self) -> dict[str, Fact]:
        """Return the least and the largest force, with the largest error, by name."""
        known = self.forces[np.isfinite(self.forces)]
        error = float(np.nanmax(self.errors)) if known.size else None
        return {
            "parameter": Fact(self.parameter),
            "values": Fact(len(self.values)),
            "least_force": Fact(float(known.min()) if known.size else None, "B/L^2", error),
            "largest_force": Fact(float(known.max()) if known.size else None, "B/L^2", error),
            "method": Fact(self.method),
        }

    def to_xarray(self) -> xr.Dataset:
        """Return forces and frequencies of the onset along the parameter, as a dataset."""
        columns = {
            "force": ("value", self.forces, {"units": "B/L^2"}),
            "error": ("value", self.errors, {"units": "B/L^2"}),
            "frequency": ("value", self.frequencies, {"units": "cycles per T"}),
            "oscillatory_force": ("value", self.oscillatory_forces, {"units": "B/L^2"}),
        }
        along = {"value": ("value", self.values, {"long_name": self.parameter})}
        return xr.Dataset(columns, coords=along)

    def to_dataframe(self) -> pd.DataFrame:
        """Return a row for each value of the parameter."""
        return self.to_xarray().to_dataframe().reset_index(names=self.parameter)

    def __str__(self) -> str:
        """Return parameter and range of the forces in one line."""
        facts = self.facts()
        return (
            f"onset at {len(self.values)} values of {self.parameter}: force from"
            f" {facts['least_force']} to {facts['largest_force']} ({self.method})"
        )
