"""The search for the forces at which the straight state starts to ring, and to oscillate.

All candidates come at once from a small pencil (`undula.numerics.linalg.bialternate`), are refined
on the whole one, and checked: at each crossing as many eigenvalues lie beyond the axis as earlier
ones have brought there. Should the first fail, or move with the resolution, the sign change of the
leading rate is bracketed and bisected instead.
"""

from dataclasses import dataclass, replace
from itertools import takewhile

import numpy as np
from scipy.optimize import brentq

from undula.analysis.linear.pencils import Linearisation
from undula.analysis.linear.results import Crossing, Onset
from undula.arrays import ComplexArray
from undula.numerics.linalg.bialternate import coalescences, crossings
from undula.numerics.linalg.critical_points import CriticalPair, refine_coalescence, refine_crossing
from undula.numerics.linalg.pencil import Pencil, eigenvalues

# Sizes of the small pencils, tried in turn; a smaller one where eigenvalues meet.
_SIZES, _SIZE_TO_MEET = (10, 16, 24), 8
# A better resolution is tried unless thresholds are settled to this relative error.
_SETTLED = 1e-12
# A rate this small beside the frequency, or the slowest decay without a force, counts as 0; a
# coalescence splits by the root of round-off.
_ON_AXIS, _TOGETHER = 1e-7, 1e-4
# A threshold or eigenvalue of an approximation is believed if it is right to this share.
_BELIEVED = 0.01
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
    pairs = _first_pairs(linearisation, 1 + later)
    if pairs:
        onset = _resolved(linearisation, pairs, pairs[-1].p)
        if onset.hopf is not None:
            return onset
    return _resolved(*_bracketed(linearisation))


def first_pair(linearisation: Linearisation) -> CriticalPair | None:
    """Return the pair that crosses the axis first, None if none is found."""
    pairs = _first_pairs(linearisation, 1) or _bracketed(linearisation)[1]
    return pairs[0] if pairs else None


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


def _first_pairs(linearisation: Linearisation, count: int) -> list[CriticalPair]:
    """Return the first crossings, at most `count`; none if the first was not found for certain."""
    best: list[CriticalPair] = []
    # Later crossings want more of the small pencil than the first one does.
    for size in _SIZES if count == 1 else _SIZES[1:]:
        guesses = crossings(linearisation.coarse(size))[: 2 * count + 1]
        found = [refine_crossing(linearisation.pencil, *guess) for guess in guesses]
        pairs = _distinct([pair for pair in found if pair is not None])
        best = max(best, _unbroken(linearisation.pencil, pairs[:count]), key=len)
        if len(best) == count:
            break
    return best


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
        noise = abs(pair.slope) * pair.round_off
        if np.count_nonzero(values.real > max(_ON_AXIS * pair.omega, noise)) != growing:
            return pairs[:k]
        growing += 2 if pair.slope > 0.0 else -2
    return pairs


def _bracketed(linearisation: Linearisation) -> tuple[Linearisation, list[CriticalPair], float]:
    """Return the crossing below the first of 1, 2, 4, ... at which a mode grows, if there is one.

    With it come the linearisation that it was found on, and the force up to which was searched.
    """
    stable, force = 0.0, 1.0
    while force <= _FARTHEST and np.isfinite(linearisation.pencil.stiffness(force)).all():
        trusted = _trusted(linearisation, force)
        if trusted is None:
            break
        linearisation = trusted
        if _growth(linearisation.pencil, force) > 0.0:
            pairs = _bisected(linearisation.pencil, stable, force)
            return linearisation, pairs, pairs[-1].p if pairs else stable
        stable, force = force, 2.0 * force
    return linearisation, [], stable


def _trusted(linearisation: Linearisation | None, force: float) -> Linearisation | None:
    """Return a linearisation whose leading eigenvalue is right, None if it would be too fine."""
    while linearisation is not None:
        compared = linearisation.companion()
        # Links are the model itself, not an approximation of it.
        if compared is None or linearisation.method == "discrete":
            return linearisation
        one, two = (leading(each.pencil, force) for each in (linearisation, compared[0]))
        slow = max(abs(one), abs(leading(linearisation.pencil, 0.0)))
        if compared[1] * abs(one - two) < _BELIEVED * slow:
            return linearisation
        linearisation = linearisation.finer()
    return None


def _growth(pencil: Pencil, force: float) -> float:
    """Return the leading rate, less what round-off may make of one that is nearly 0."""
    return leading(pencil, force).real - _ON_AXIS * abs(leading(pencil, 0.0))


def _bisected(pencil: Pencil, stable: float, unstable: float) -> list[CriticalPair]:
    force = brentq(lambda p: _growth(pencil, p), stable, unstable)
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


def _resolved(linearisation: Linearisation, pairs: list[CriticalPair], searched_to: float) -> Onset:
    """Return the onset with these crossings, on a finer linearisation where that is worth it."""
    ringing = _ringing_force(linearisation, pairs[0].p if pairs else searched_to)
    onset = _measured(linearisation, pairs, ringing, searched_to)
    while not _settled(onset) and (finer := linearisation.finer()) is not None:
        refined = [refine_crossing(finer.pencil, pair.p, pair.omega) for pair in pairs]
        pairs = [pair for pair in takewhile(bool, refined) if pair is not None]
        if not pairs:
            break
        linearisation = finer
        onset = _measured(linearisation, pairs, ringing, searched_to)
    return onset if linearisation.method == "discrete" else _believed(onset)


def _believed(onset: Onset) -> Onset:
    """Return an onset without crossings that the approximation has and the filament may not."""
    known = list(takewhile(_is_believed, _found(onset)))
    if known == _found(onset):
        return onset
    hopf, searched_to = (known[0], known[-1].force) if known else (None, 0.0)
    return replace(onset, hopf=hopf, later=tuple(known[1:]), searched_to=searched_to)


def _is_believed(one: Crossing) -> bool:
    return max(one.error / one.force, one.frequency_error / one.frequency) < _BELIEVED


def _measured(
    linearisation: Linearisation,
    pairs: list[CriticalPair],
    ringing: _Ringing | None,
    searched_to: float,
) -> Onset:
    """Return the onset on a linearisation, with errors from its companion."""
    other, factor = linearisation.companion() or (None, 0.0)
    compared = other.pencil if other else None
    measured = [_crossing(compared, factor, pair) for pair in pairs]
    force, error = _ringing_measured(linearisation.pencil, compared, factor, ringing)
    return Onset(
        hopf=measured[0] if measured else None,
        oscillatory_force=force,
        oscillatory_error=error,
        later=tuple(measured[1:]),
        searched_to=measured[-1].force if measured else searched_to,
        method=linearisation.method,
    )


def _crossing(compared: Pencil | None, factor: float, pair: CriticalPair) -> Crossing:
    by_force, by_omega = (0.0, 0.0) if compared is None else _differences(compared, pair)
    turns, share = 2.0 * np.pi, pair.round_off / pair.p
    return Crossing(
        force=pair.p,
        error=float(factor * by_force + pair.round_off),
        frequency=pair.omega / turns,
        frequency_error=float(factor * by_omega + share * pair.omega) / turns,
        growth_slope=pair.slope,
        round_off=float(pair.round_off),
    )


def _differences(compared: Pencil, pair: CriticalPair) -> tuple[float, float]:
    """Return by how much parameter and frequency of a crossing differ on another pencil."""
    values = eigenvalues(compared.stiffness(pair.p), compared.mass)
    nearest = values[np.argmin(np.abs(values - 1j * pair.omega))]
    p, omega = pair.p - nearest.real / pair.slope, float(nearest.imag)
    other = refine_crossing(compared, p, omega) if p > 0.0 else None
    if other is None:
        away = abs(nearest - 1j * pair.omega)
        return away / abs(pair.slope), away
    return abs(other.p - pair.p), abs(other.omega - pair.omega)


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
    errors = [crossing.error / crossing.force for crossing in _found(onset)]
    if onset.oscillatory_force and onset.oscillatory_error:
        errors.append(onset.oscillatory_error / onset.oscillatory_force)
    return max(errors, default=0.0) <= _SETTLED


def _found(onset: Onset) -> list[Crossing]:
    return [] if onset.hopf is None else [onset.hopf, *onset.later]
