"""Results of linear stability: eigenvalues with modes, thresholds, and curves of both.

A small transverse displacement is a sum of modes y(s) exp(sigma t). `rate` is Re sigma [1/T],
`frequency` is |Im sigma| / (2 pi) [cycles/T]; a mode grows if its rate is positive.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from undula.arrays import Array, ComplexArray, Points

Method = Literal["spectral", "modes", "discrete"]


@dataclass(frozen=True)
class Spectrum:
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

    @property
    def rates(self) -> Array:
        """Growth rates [1/T], of shape (k,)."""
        return np.asarray(self.values.real)

    @property
    def frequencies(self) -> Array:
        """Frequencies [cycles/T], of shape (k,)."""
        return np.asarray(np.abs(self.values.imag) / (2.0 * np.pi))

    def __str__(self) -> str:
        """Return the leading eigenvalue in one line."""
        leading = f"{self.rates[0]:.6g} /T at {self.frequencies[0]:.6g} cycles per T"
        return f"force {self.force:.6g}: leading rate {leading} (to {self.errors[0]:.1g})"


@dataclass(frozen=True)
class Crossing:
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

    def __str__(self) -> str:
        """Return force and frequency with their errors in one line."""
        return (
            f"Hopf point at force {self.force:.12g} +- {self.error:.1g},"
            f" frequency {self.frequency:.12g} +- {self.frequency_error:.1g} cycles per T"
        )


@dataclass(frozen=True)
class Onset:
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

    def __str__(self) -> str:
        """Return the threshold in one line."""
        if self.hopf is None:
            return f"straight and stable at every force up to {self.searched_to:.4g}"
        ringing = self.oscillatory_force
        return str(self.hopf) + (f"; rings from {ringing:.12g} on" if ringing else "")


@dataclass(frozen=True)
class GrowthCurve:
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


@dataclass(frozen=True)
class CriticalCurve:
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
