"""Force from which disturbances of the straight state ring: the leading eigenvalue is complex."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from undula.analysis.linear.pencils import Linearisation
from undula.analysis.linear.spectrum import leading_eigenvalue
from undula.arrays import ComplexArray
from undula.numerics.linalg.bialternate import coalescences
from undula.numerics.linalg.critical_points import refine_coalescence
from undula.numerics.linalg.pencil import Pencil, eigenvalues

# Number of unknowns of the small pencil for coalescences.
_COALESCENCE_PENCIL_SIZE = 8
# Largest relative gap of a coalescence, which the square root of round-off splits.
_MAX_COALESCENCE_GAP = 1e-4


@dataclass(frozen=True)
class Ringing:
    """Force at which the leading eigenvalue becomes complex.

    Either two real eigenvalues coalesce at `sigma`, or a pair overtakes the leading real eigenvalue
    in the bracket.
    """

    force: float
    sigma: float | None = None
    bracket: tuple[float, float] = (0.0, 0.0)

    def on(self, pencil: Pencil) -> tuple[float, float]:
        """Return the force on a pencil, and its round-off; NaN if this pencil has no such force."""
        if self.sigma is not None:
            refined = refine_coalescence(pencil, self.force, self.sigma)
            return (refined.p, refined.round_off) if refined else (np.nan, np.nan)
        ahead = [_lead_of_pairs(pencil, force) for force in self.bracket]
        if not ahead[0] < 0.0 < ahead[1]:
            return np.nan, np.nan
        round_off = 1e-13 * self.force
        crossing = brentq(lambda p: _lead_of_pairs(pencil, p), *self.bracket, xtol=round_off)
        return float(crossing), round_off


def ringing_force(linearisation: Linearisation, below: float) -> Ringing | None:
    """Return the first force up to a limit at which the leading eigenvalue becomes complex.

    Parameters
    ----------
    linearisation : Linearisation
        Linearised straight state.
    below : float
        Largest force of the search [B/L^2].

    Returns
    -------
    Ringing or None
        None if the leading eigenvalue stays real.
    """
    pencil = linearisation.pencil
    candidates = [
        (p, sigma)
        for p, sigma in coalescences(linearisation.coarse(_COALESCENCE_PENCIL_SIZE))
        if p < below
    ]
    forces = [0.0, *(p for p, _ in candidates), below]
    last = 0.0
    for k in range(len(forces) - 1):
        middle = 0.5 * (forces[k] + forces[k + 1])
        if leading_eigenvalue(pencil, middle).imag > 0.0:
            return _as_ringing(pencil, candidates[k - 1] if k else None, (last, middle))
        last = middle
    if leading_eigenvalue(pencil, below).imag > 0.0:
        # A margin of one per cent, as the crossing of another resolution differs.
        return _as_ringing(pencil, None, (last, 1.01 * below))
    return None


def measured_ringing(
    pencil: Pencil, compared: Pencil | None, factor: float, ringing: Ringing | None
) -> tuple[float | None, float | None]:
    """Return the force of ringing on a pencil, and its error by comparison with another pencil.

    Parameters
    ----------
    pencil : Pencil
        Pencil K(F) + sigma M.
    compared : Pencil or None
        Pencil at another resolution; None without one.
    factor : float
        Factor from the difference of the two to the error.
    ringing : Ringing or None
        From `ringing_force`.

    Returns
    -------
    force, error : float or None
        Force and error [B/L^2]; None without ringing.
    """
    if ringing is None:
        return None, None
    force, round_off = ringing.on(pencil)
    if not np.isfinite(force):
        return None, None
    if compared is None:
        return force, round_off
    other = ringing.on(compared)[0]
    low, high = ringing.bracket
    difference = abs(force - other) if np.isfinite(other) else high - low
    return force, factor * difference + round_off


def _as_ringing(
    pencil: Pencil, coalescence: tuple[float, float] | None, bracket: tuple[float, float]
) -> Ringing:
    """Return the coalescence in a bracket if it is one of the leading pair, else the bracket."""
    if coalescence is not None:
        refined = refine_coalescence(pencil, *coalescence)
        if refined is not None:
            rate = leading_eigenvalue(pencil, refined.p).real
            if abs(rate - refined.sigma) < _MAX_COALESCENCE_GAP * abs(rate):
                return Ringing(refined.p, sigma=refined.sigma)
    return Ringing(bracket[1], bracket=bracket)


def _lead_of_pairs(pencil: Pencil, force: float) -> float:
    """Return the rate of the leading pair minus that of the leading real eigenvalue."""
    values = eigenvalues(pencil.stiffness(force), pencil.mass)
    return _first_rate(values[values.imag > 0.0]) - _first_rate(values[values.imag == 0.0])


def _first_rate(values: ComplexArray) -> float:
    return float(values[0].real) if values.size else -np.inf
