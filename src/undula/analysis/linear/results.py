"""Results of linear stability: eigenvalues with modes, thresholds, and curves of both.

A small transverse displacement is a sum of modes y(s) exp(sigma t). `rate` is Re sigma [1/T],
`frequency` is |Im sigma| / (2 pi) [cycles/T]; a mode grows if its rate is positive.
"""

from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np
import pandas as pd
import xarray as xr

from undula.analysis.record import Fact, Record
from undula.arrays import Array, ComplexArray, Points

Method = Literal["spectral", "modes", "discrete"]


@dataclass(frozen=True, repr=False)
class Spectrum(Record):
    """Leading eigenvalues of the straight state under one force.

    Attributes
    ----------
    force : float
        Total follower force F [B/L^2].
    values : ndarray of shape (k,)
        Eigenvalues sigma [1/T], by falling real part, with both members of a complex pair.
    errors : ndarray of shape (k,)
        Estimated error of each [1/T].
    s : ndarray of shape (m,)
        Arc length [L], from the clamp to the tip.
    modes : ndarray of shape (k, m)
        Complex displacement y(s) of each mode, with a largest modulus of 1 and a phase by which it
        is real and positive at the tip.
    method : {"spectral", "modes", "discrete"}
        Discretisation.
    paper_time : bool
        True if rates and frequencies are smaller by the drag ratio, as in the printed equation.
    """

    force: float
    values: ComplexArray
    errors: Array
    s: Points
    modes: ComplexArray
    method: Method
    paper_time: bool = False

    _figure: ClassVar[str] = "undula.views.records.linear:spectrum"

    @property
    def rates(self) -> Array:
        """Growth rates [1/T], of shape (k,)."""
        return np.asarray(self.values.real)

    @property
    def frequencies(self) -> Array:
        """Frequencies [cycles/T], of shape (k,)."""
        return np.asarray(np.abs(self.values.imag) / (2.0 * np.pi))

    def facts(self) -> dict[str, Fact]:
        """Return force, and rate and frequency of the leading eigenvalue, by name."""
        return {
            "force": Fact(self.force, "B/L^2"),
            "leading_rate": Fact(float(self.rates[0]), "1/T", float(self.errors[0])),
            "frequency": Fact(float(self.frequencies[0]), "cycles per T"),
            "method": Fact(self.method),
        }

    def to_dataframe(self) -> pd.DataFrame:
        """Return a row for each eigenvalue: rate, frequency and error."""
        columns = {"rate": self.rates, "frequency": self.frequencies, "error": self.errors}
        return pd.DataFrame(columns)

    def to_xarray(self) -> xr.Dataset:
        """Return rates, frequencies, errors and modes as a dataset."""
        return xr.Dataset(
            {
                "rate": ("mode", self.rates, {"units": "1/T"}),
                "frequency": ("mode", self.frequencies, {"units": "cycles per T"}),
                "error": ("mode", self.errors, {"units": "1/T"}),
                "shape": (("mode", "s"), self.modes.real, {"long_name": "real part of the mode"}),
            },
            coords={"s": ("s", self.s, {"units": "L"})},
        )

    def __str__(self) -> str:
        """Return the leading eigenvalue in one line."""
        leading = f"{self.rates[0]:.6g} /T at {self.frequencies[0]:.6g} cycles per T"
        return f"force {self.force:.6g}: leading rate {leading} (to {self.errors[0]:.1g})"


@dataclass(frozen=True, repr=False)
class Crossing(Record):
    """A force at which a complex pair crosses the imaginary axis: a Hopf point.

    Attributes
    ----------
    force, error : float
        The force [B/L^2] and its estimated error.
    frequency, frequency_error : float
        Frequency of the pair [cycles/T] and its estimated error.
    growth_slope : float
        Change of the growth rate with the force [1/T per B/L^2]; negative where a pair becomes
        stable.
    round_off : float
        Part of the error of the force that does not depend on the resolution, or on the number of
        links [B/L^2].
    """

    force: float
    error: float
    frequency: float
    frequency_error: float
    growth_slope: float
    round_off: float = 0.0

    def facts(self) -> dict[str, Fact]:
        """Return force and frequency by name."""
        return {
            "force": Fact(self.force, "B/L^2", self.error),
            "frequency": Fact(self.frequency, "cycles per T", self.frequency_error),
            "growth_slope": Fact(self.growth_slope, "1/T per B/L^2"),
        }

    def __str__(self) -> str:
        """Return force and frequency with their errors in one line."""
        return (
            f"Hopf point at force {self.force:.12g} ± {self.error:.1g},"
            f" frequency {self.frequency:.12g} ± {self.frequency_error:.1g} cycles per T"
        )


@dataclass(frozen=True, repr=False)
class Onset(Record):
    """Loss of stability of the straight state as the force grows from 0.

    Attributes
    ----------
    hopf : Crossing or None
        The first crossing; None if the straight state stays stable.
    oscillatory_force, oscillatory_error : float or None
        The least force at which the leading eigenvalue is complex [B/L^2], so that disturbances
        oscillate, and its estimated error; None without such a force up to `searched_to`.
    later : tuple of Crossing
        The crossings after the first, by force.
    searched_to : float
        Largest force up to which all crossings are known [B/L^2].
    method : {"spectral", "modes", "discrete"}
        Discretisation.
    paper_time : bool
        True if rates and frequencies are smaller by the drag ratio, as in the printed equation.
    """

    hopf: Crossing | None
    oscillatory_force: float | None
    oscillatory_error: float | None
    later: tuple[Crossing, ...]
    searched_to: float
    method: Method
    paper_time: bool = False

    @property
    def force(self) -> float | None:
        """The Hopf force [B/L^2], None if the straight state stays stable."""
        return self.hopf.force if self.hopf else None

    @property
    def frequency(self) -> float | None:
        """The frequency at the Hopf force [cycles/T], None without one."""
        return self.hopf.frequency if self.hopf else None

    @property
    def error(self) -> float | None:
        """The estimated error of the Hopf force [B/L^2], None without one."""
        return self.hopf.error if self.hopf else None

    def facts(self) -> dict[str, Fact]:
        """Return the forces from which the straight state rings and oscillates, by name."""
        return {
            "force": Fact(self.force, "B/L^2", self.error),
            "frequency": Fact(
                self.frequency, "cycles per T", self.hopf.frequency_error if self.hopf else None
            ),
            "oscillatory_force": Fact(self.oscillatory_force, "B/L^2", self.oscillatory_error),
            "searched_to": Fact(self.searched_to, "B/L^2"),
            "method": Fact(self.method),
        }

    def __str__(self) -> str:
        """Return the threshold in one line."""
        if self.hopf is None:
            return f"straight and stable at every force up to {self.searched_to:.4g}"
        ringing = self.oscillatory_force
        return str(self.hopf) + (f"; rings from {ringing:.12g} on" if ringing else "")
