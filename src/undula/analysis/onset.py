"""The search for the forces at which the straight state starts to ring, and to oscillate.

All candidates come at once from a small pencil (`undula.numerics.bialternate`), are refined on the
whole one, and checked: at the first crossing no eigenvalue may lie beyond the axis. Should a check
fail, the sign change of the leading rate is bracketed and bisected instead.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from undula.analysis.linear_results import Crossing, Onset
from undula.analysis.linearisations import Linearisation
from undula.arrays import ComplexArray
from undula.numerics.bialternate import coalescences, crossings
from undula.numerics.pencil import Pencil, eigenvalues
from undula.numerics.singular import CriticalPair, refine_coalescence, refine_crossing

# Sizes of the small pencils, tried in turn.
_SIZES = (10, 16, 24)
_SIZE_TO_MEET = 8
# A better resolution is tried unless thresholds are settled to this relative error.
_SETTLED = 1e-12
# A rate this small beside the frequency counts as 0; a coalescence splits by the root of round-off.
_ON_AXIS, _TOGETHER = 1e-7, 1e-4
# Forces beyond this are searched only if a candidate lies there.
_FARTHEST = 2.0**14


def find_onset(linearisation: Linearisation, later: int) -> Onset:
    """Return the onset of a linearisation, resolved as finely as is worth it.

    Parameters
    ----------
    linearisation : Linearisation
    later : int
        How many crossings after the first are wanted.
    """
    pairs, searched_to = _first_pairs(linearisation, 1 + later)
    ringing = _ringing_force(linearisation, pairs[0].p if pairs else searched_to)
    while True:
        onset = _measured(linearisation, pairs, ringing, searched_to)
        finer = linearisation.finer()
        if finer is None or _settled(onset):
            return onset
        linearisation = finer


def leading(pencil: Pencil, force: float) -> complex:
    """Return the leading eigenvalue under a force; of a pair, the one above the real axis."""
    return complex(eigenvalues(pencil.stiffness(force), pencil.mass)[0])


@dataclass(frozen=True)
class _Ringing:
    """Where the leading eigenvalue turns complex: at a coalescence, or overtaken in a bracket."""

    force: float
    sigma: float | None = None
    bracket: tuple[float, float] = (0.0, 0.0)

    def on(self, pencil: Pencil) -> tuple[float, float]:
        """Return the force on a pencil, and its round-off; NaN if it is not found there."""
        if self.sigma is not None:
            refined = refine_coalescence(pencil, self.force, self.sigma)
            return (refined.p, refined.round_off) if refined else (np.nan, np.nan)
        ahead = [_lead_of_pairs(pencil, force) for force in self.bracket]
        if not ahead[0] < 0.0 < ahead[1]:
            return np.nan, np.nan
        round_off = 1e-13 * self.force
        at = brentq(lambda p: _lead_of_pairs(pencil, p), *self.bracket, xtol=round_off)
        return float(at), round_off


def _first_pairs(linearisation: Linearisation, count: int) -> tuple[list[CriticalPair], float]:
    """Return the first crossings, and the force up to which none was missed."""
    pencil = linearisation.pencil
    best: list[CriticalPair] = []
    # Later crossings want more of the small pencil than the first one does.
    for size in _SIZES if count == 1 else _SIZES[1:]:
        found = [refine_crossing(pencil, *guess) for guess in crossings(linearisation.coarse(size))]
        pairs = _distinct([pair for pair in found if pair is not None])
        best = max(best, _unbroken(pencil, pairs[:count]), key=len)
        if len(best) == count:
            break
    return (best, best[-1].p) if best else _bracketed(linearisation)


def _distinct(pairs: list[CriticalPair]) -> list[CriticalPair]:
    pairs = sorted(pairs, key=lambda pair: pair.p)
    # Two guesses that are refined to the same crossing agree to round-off.
    apart = [k == 0 or pair.p > pairs[k - 1].p * (1.0 + 1e-6) for k, pair in enumerate(pairs)]
    return [pair for pair, kept in zip(pairs, apart, strict=True) if kept]


def _unbroken(pencil: Pencil, pairs: list[CriticalPair]) -> list[CriticalPair]:
    """Return the first crossings, up to where the growing eigenvalues tell of one missed."""
    growing = 0
    for k, pair in enumerate(pairs):
        values = eigenvalues(pencil.stiffness(pair.p), pencil.mass)
        if np.count_nonzero(values.real > _ON_AXIS * pair.omega) != growing:
            return pairs[:k]
        growing += 2 if pair.slope > 0.0 else -2
    return pairs


def _bracketed(linearisation: Linearisation) -> tuple[list[CriticalPair], float]:
    """Return the crossing below the first of 1, 2, 4, ... at which a mode grows."""
    stable, force = 0.0, 1.0
    while force <= _FARTHEST:
        trusted = _trusted(linearisation, force)
        if trusted is None:
            break
        linearisation = trusted
        if leading(linearisation.pencil, force).real > 0.0:
            pairs = _bisected(linearisation.pencil, stable, force)
            return pairs, pairs[-1].p if pairs else stable
        stable, force = force, 2.0 * force
    return [], stable


def _trusted(linearisation: Linearisation | None, force: float) -> Linearisation | None:
    """Return a linearisation whose leading eigenvalue is right to a hundredth, None if too fine."""
    while linearisation is not None:
        compared = linearisation.companion()
        if compared is None:
            return linearisation
        one, two = (leading(each.pencil, force) for each in (linearisation, compared[0]))
        if compared[1] * abs(one - two) < 0.01 * abs(one):
            return linearisation
        linearisation = linearisation.finer()
    return None


def _bisected(pencil: Pencil, stable: float, unstable: float) -> list[CriticalPair]:
    force = brentq(lambda p: leading(pencil, p).real, stable, unstable)
    pair = refine_crossing(pencil, force, leading(pencil, force).imag)
    return [pair] if pair else []


def _ringing_force(linearisation: Linearisation, below: float) -> _Ringing | None:
    """Return where the leading eigenvalue first turns complex, up to a force."""
    pencil = linearisation.pencil
    meetings = [
        (p, sigma) for p, sigma in coalescences(linearisation.coarse(_SIZE_TO_MEET)) if p < below
    ]
    forces = [0.0, *(p for p, _ in meetings), below]
    last = 0.0
    for k in range(len(forces) - 1):
        middle = 0.5 * (forces[k] + forces[k + 1])
        if leading(pencil, middle).imag > 0.0:
            return _turning(pencil, meetings[k - 1] if k else None, (last, middle))
        last = middle
    if leading(pencil, below).imag > 0.0:
        # A little beyond, as another resolution has its crossing elsewhere.
        return _turning(pencil, None, (last, 1.01 * below))
    return None


def _turning(
    pencil: Pencil, meeting: tuple[float, float] | None, bracket: tuple[float, float]
) -> _Ringing:
    """Return how the leading eigenvalue turns complex in a bracket, which holds one meeting."""
    if meeting is not None:
        refined = refine_coalescence(pencil, *meeting)
        if refined is not None:
            rate = leading(pencil, refined.p).real
            if abs(rate - refined.sigma) < _TOGETHER * abs(rate):
                return _Ringing(refined.p, sigma=refined.sigma)
    return _Ringing(bracket[1], bracket=bracket)


def _lead_of_pairs(pencil: Pencil, force: float) -> float:
    """Return by how much the leading pair is ahead of the leading real eigenvalue."""
    values = eigenvalues(pencil.stiffness(force), pencil.mass)
    return _first_rate(values[values.imag > 0.0]) - _first_rate(values[values.imag == 0.0])


def _first_rate(values: ComplexArray) -> float:
    return float(values[0].real) if values.size else -np.inf


def _measured(
    linearisation: Linearisation,
    pairs: list[CriticalPair],
    ringing: _Ringing | None,
    searched_to: float,
) -> Onset:
    """Return the onset on a linearisation, with errors from its companion."""
    other, factor = linearisation.companion() or (None, 0.0)
    compared = other.pencil if other else None
    measured = [_crossing(linearisation.pencil, compared, factor, pair) for pair in pairs]
    resolved = [crossing for crossing in measured if crossing is not None]
    force, error = _ringing_measured(linearisation.pencil, compared, factor, ringing)
    return Onset(
        hopf=resolved[0] if resolved else None,
        oscillatory_force=force,
        oscillatory_error=error,
        later=tuple(resolved[1:]),
        searched_to=searched_to,
        method=linearisation.method,
    )


def _crossing(
    pencil: Pencil, compared: Pencil | None, factor: float, guess: CriticalPair
) -> Crossing | None:
    pair = refine_crossing(pencil, guess.p, guess.omega)
    other = pair and compared and refine_crossing(compared, pair.p, pair.omega)
    if pair is None or (compared is not None and other is None):
        return None
    force_error = factor * abs(pair.p - other.p) + pair.round_off if other else pair.round_off
    turns = 2.0 * np.pi
    swing = factor * abs(pair.omega - other.omega) if other else 0.0
    round_off = pair.round_off * pair.omega / pair.p
    return Crossing(
        force=pair.p,
        error=force_error,
        frequency=pair.omega / turns,
        frequency_error=(swing + round_off) / turns,
        growth_slope=pair.slope,
    )


def _ringing_measured(
    pencil: Pencil, compared: Pencil | None, factor: float, ringing: _Ringing | None
) -> tuple[float | None, float | None]:
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


def _settled(onset: Onset) -> bool:
    settled = all(
        crossing.error <= _SETTLED * crossing.force
        for crossing in (onset.hopf, *onset.later)
        if crossing is not None
    )
    if onset.oscillatory_force is None or onset.oscillatory_error is None:
        return settled
    return settled and onset.oscillatory_error <= _SETTLED * onset.oscillatory_force
