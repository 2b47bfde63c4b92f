"""Search for the forces at which the straight state starts to ring, and to oscillate.

A small pencil (`undula.numerics.linalg.bialternate`) gives all candidates at once. They are refined
on the full pencil and verified by counting: at each crossing the number of growing eigenvalues has
to equal the number that the earlier crossings account for. If the first crossing fails this test or
depends on the resolution, the sign change of the leading rate is bracketed and bisected instead.
"""

from dataclasses import replace
from itertools import takewhile

import numpy as np
from scipy.optimize import brentq

from undula.analysis.linear.pencils import Linearisation
from undula.analysis.linear.results import Crossing, Onset
from undula.analysis.linear.ringing import Ringing, measured_ringing, ringing_force
from undula.analysis.linear.spectrum import leading_eigenvalue
from undula.numerics.linalg.bialternate import crossings
from undula.numerics.linalg.critical_points import CriticalPair, refine_crossing
from undula.numerics.linalg.pencil import Pencil, eigenvalues

# Numbers of unknowns of the small pencils, tried in turn.
_SMALL_PENCIL_SIZES = (10, 16, 24)
# Relative error of the thresholds below which the resolution is not refined further.
_RELATIVE_TOLERANCE = 1e-12
# Largest rate on the axis, relative to the frequency or to the slowest decay without a force.
_MAX_RATE_ON_AXIS = 1e-7
# Largest relative error of a threshold or eigenvalue of an approximation that is reported.
_MAX_RELATIVE_ERROR = 0.01
# Largest force that is searched without a candidate [B/L^2].
_MAX_SEARCHED_FORCE = 2.0**14


def find_onset(linearisation: Linearisation, later: int) -> Onset:
    """Return the onset of a linearisation, refined until it has converged.

    Parameters
    ----------
    linearisation : Linearisation
        Linearised straight state.
    later : int
        Number of crossings to compute after the first, at least 0.

    Returns
    -------
    Onset
        Forces [B/L^2] and frequencies [cycles/T], each with its error.
    """
    pairs = _first_pairs(linearisation, 1 + later)
    if pairs:
        onset = _resolved(linearisation, pairs, pairs[-1].p)
        if onset.hopf is not None:
            return onset
    return _resolved(*_bracketed(linearisation))


def first_pair(linearisation: Linearisation) -> CriticalPair | None:
    """Return the pair that crosses the axis first.

    Parameters
    ----------
    linearisation : Linearisation
        Linearised straight state.

    Returns
    -------
    CriticalPair or None
        None if no pair crosses the axis at the searched forces.
    """
    pairs = _first_pairs(linearisation, 1) or _bracketed(linearisation)[1]
    return pairs[0] if pairs else None


def _first_pairs(linearisation: Linearisation, count: int) -> list[CriticalPair]:
    """Return the first crossings, at most `count`; an empty list if the first is uncertain."""
    best: list[CriticalPair] = []
    # Later crossings need a larger pencil than the first one.
    for size in _SMALL_PENCIL_SIZES if count == 1 else _SMALL_PENCIL_SIZES[1:]:
        guesses = crossings(linearisation.coarse(size))[: 2 * count + 1]
        refined = [refine_crossing(linearisation.pencil, *guess) for guess in guesses]
        pairs = _distinct([pair for pair in refined if pair is not None])
        best = max(best, _unbroken(linearisation.pencil, pairs[:count]), key=len)
        if len(best) == count:
            break
    return best


def _distinct(pairs: list[CriticalPair]) -> list[CriticalPair]:
    pairs = sorted(pairs, key=lambda pair: pair.p)
    # Two guesses refined to the same crossing agree to round-off.
    is_distinct = [k == 0 or pair.p > pairs[k - 1].p * (1.0 + 1e-6) for k, pair in enumerate(pairs)]
    return [pair for pair, distinct in zip(pairs, is_distinct, strict=True) if distinct]


def _unbroken(pencil: Pencil, pairs: list[CriticalPair]) -> list[CriticalPair]:
    """Return the first crossings, up to the one where the count of growing eigenvalues fails."""
    growing = 0
    for k, pair in enumerate(pairs):
        values = eigenvalues(pencil.stiffness(pair.p), pencil.mass)
        noise = abs(pair.slope) * pair.round_off
        if np.count_nonzero(values.real > max(_MAX_RATE_ON_AXIS * pair.omega, noise)) != growing:
            return pairs[:k]
        growing += 2 if pair.slope > 0.0 else -2
    return pairs


def _bracketed(linearisation: Linearisation) -> tuple[Linearisation, list[CriticalPair], float]:
    """Return the crossing below the first of the forces 1, 2, 4, ... at which a mode grows.

    Returns the linearisation on which it was computed, a list of at most one crossing, and the
    largest searched force.
    """
    stable, force = 0.0, 1.0
    while force <= _MAX_SEARCHED_FORCE and np.isfinite(linearisation.pencil.stiffness(force)).all():
        accurate = _accurate_at(linearisation, force)
        if accurate is None:
            break
        linearisation = accurate
        if _growth(linearisation.pencil, force) > 0.0:
            pairs = _bisected(linearisation.pencil, stable, force)
            return linearisation, pairs, pairs[-1].p if pairs else stable
        stable, force = force, 2.0 * force
    return linearisation, [], stable


def _accurate_at(linearisation: Linearisation | None, force: float) -> Linearisation | None:
    """Return a linearisation with an accurate leading eigenvalue; None if none is affordable."""
    while linearisation is not None:
        compared = linearisation.companion()
        # The links are the model, not an approximation of it.
        if compared is None or linearisation.method == "discrete":
            return linearisation
        own, other = (
            leading_eigenvalue(item.pencil, force) for item in (linearisation, compared[0])
        )
        slow = max(abs(own), abs(leading_eigenvalue(linearisation.pencil, 0.0)))
        if compared[1] * abs(own - other) < _MAX_RELATIVE_ERROR * slow:
            return linearisation
        linearisation = linearisation.finer()
    return None


def _growth(pencil: Pencil, force: float) -> float:
    """Return the leading rate, less the largest rate that counts as 0."""
    return leading_eigenvalue(pencil, force).real - _MAX_RATE_ON_AXIS * abs(
        leading_eigenvalue(pencil, 0.0)
    )


def _bisected(pencil: Pencil, stable: float, unstable: float) -> list[CriticalPair]:
    force = brentq(lambda p: _growth(pencil, p), stable, unstable)
    pair = refine_crossing(pencil, force, leading_eigenvalue(pencil, force).imag)
    return [pair] if pair else []


def _resolved(linearisation: Linearisation, pairs: list[CriticalPair], searched_to: float) -> Onset:
    """Return the onset with these crossings, on a linearisation refined until it has converged."""
    ringing = ringing_force(linearisation, pairs[0].p if pairs else searched_to)
    onset = _measured(linearisation, pairs, ringing, searched_to)
    while not _settled(onset) and (finer := linearisation.finer()) is not None:
        refined = [refine_crossing(finer.pencil, pair.p, pair.omega) for pair in pairs]
        pairs = [pair for pair in takewhile(bool, refined) if pair is not None]
        if not pairs:
            break
        linearisation = finer
        onset = _measured(linearisation, pairs, ringing, searched_to)
    return onset if linearisation.method == "discrete" else _without_inaccurate(onset)


def _without_inaccurate(onset: Onset) -> Onset:
    """Return an onset up to the last crossing that is accurate enough to be one of the filament."""
    accurate = list(takewhile(_is_accurate, _crossings_of(onset)))
    if accurate == _crossings_of(onset):
        return onset
    hopf, searched_to = (accurate[0], accurate[-1].force) if accurate else (None, 0.0)
    return replace(onset, hopf=hopf, later=tuple(accurate[1:]), searched_to=searched_to)


def _is_accurate(crossing: Crossing) -> bool:
    return (
        max(crossing.error / crossing.force, crossing.frequency_error / crossing.frequency)
        < _MAX_RELATIVE_ERROR
    )


def _measured(
    linearisation: Linearisation,
    pairs: list[CriticalPair],
    ringing: Ringing | None,
    searched_to: float,
) -> Onset:
    """Return the onset on a linearisation, with errors by comparison with its companion."""
    other, factor = linearisation.companion() or (None, 0.0)
    compared = other.pencil if other else None
    measured = [_crossing(compared, factor, pair) for pair in pairs]
    force, error = measured_ringing(linearisation.pencil, compared, factor, ringing)
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
    """Return the differences of the parameter and frequency of a crossing on another pencil."""
    values = eigenvalues(compared.stiffness(pair.p), compared.mass)
    nearest = values[np.argmin(np.abs(values - 1j * pair.omega))]
    p, omega = pair.p - nearest.real / pair.slope, float(nearest.imag)
    other = refine_crossing(compared, p, omega) if p > 0.0 else None
    if other is None:
        distance = abs(nearest - 1j * pair.omega)
        return distance / abs(pair.slope), distance
    return abs(other.p - pair.p), abs(other.omega - pair.omega)


def _settled(onset: Onset) -> bool:
    errors = [crossing.error / crossing.force for crossing in _crossings_of(onset)]
    if onset.oscillatory_force and onset.oscillatory_error:
        errors.append(onset.oscillatory_error / onset.oscillatory_force)
    return max(errors, default=0.0) <= _RELATIVE_TOLERANCE


def _crossings_of(onset: Onset) -> list[Crossing]:
    return [] if onset.hopf is None else [onset.hopf, *onset.later]
