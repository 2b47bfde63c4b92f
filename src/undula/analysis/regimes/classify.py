"""The verdict on a run: the name of what it ends in, or what is missing to tell.

`straight` is the equilibrium; the other names are those of `undula.analysis.regimes.names`, and
`chaotic`. What has not settled is left `undecided`, with the reason and how much longer to run. A
motion that is seen long enough and comes back to no shape is irregular; whether it is chaotic or on
a torus is told by its Lyapunov exponents, which need the model: `with_exponents`.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from undula.analysis.observables.alignment import comparison
from undula.analysis.observables.linear_mode import LinearMotion
from undula.analysis.observables.shapes import displacement
from undula.analysis.regimes.evidence import Evidence
from undula.analysis.regimes.late_window import THIN, LateWindow, Name
from undula.analysis.regimes.lyapunov import Lyapunov
from undula.analysis.regimes.names import (
    name_flapping,
    name_windmilling,
    returning,
    steady,
    wandering,
)
from undula.analysis.regimes.recurrence import RECURRENT
from undula.analysis.regimes.relaxation import DECAY_FACTOR, Straightening, straightening
from undula.analysis.regimes.stationary_window import late_windows
from undula.analysis.regimes.why_undecided import MIN_SAMPLES_PER_PERIOD, why_undecided
from undula.arrays import Instants, Shapes

STRAIGHT, UNDECIDED = "straight", "undecided"
# A filament that stays this near to straight [L] has not moved: round-off alone gets it so far.
UNMOVED = 1e-12
# No criterion counts as met by more than this factor.
MOST = 100.0
# Without this many samples nothing can be said about a motion.
MIN_SAMPLES = 8
# Half of so many show that a steady shape stays so, and how fast it turns.
MIN_STEADY_SAMPLES = 32
# A Lyapunov exponent above so many of its errors is positive.
SIGNIFICANT = 3.0
# Neighbouring motions that part by less than the exponential of this from one maximum of the
# displacement to the next do not part.
LEAST_GROWTH = 0.05


@dataclass(frozen=True)
class Verdict:
    """What a run ends in.

    Attributes
    ----------
    name
        ``straight``, ``undecided``, ``chaotic`` or one of `undula.analysis.regimes.names`.
    reason
        One sentence: what was seen, or what is missing.
    evidence
        The numbers behind it by name; shares are relative, the rest in units of L, T and B.
    window_start
        Time from which on the run was judged [T].
    margin
        Factor by which the criteria of the name are met, at least 1 and not counted above 100; 0 if
        undecided.
    longer
        How much longer to run, roughly, if undecided and that is what it takes [T].
    late
        The late window of an irregular motion, which waits for its Lyapunov exponent.
    """

    name: str
    reason: str
    evidence: dict[str, float]
    window_start: float
    margin: float = 0.0
    longer: float | None = None
    late: LateWindow | None = None


def first_verdict(
    time: Instants,
    nodes: Shapes,
    bending_energy: Instants,
    rotation_angle: Instants,
    *,
    settled_from: float | None,
    axisymmetric: bool = True,
    fall: Straightening | None = None,
) -> Verdict:
    """Judge a run by its whole shape over a late window.

    Samples have to be dense enough to follow the motion.

    Parameters
    ----------
    time
        Equally spaced times [T], shape ``(m,)``.
    nodes
        Node positions [L], shape ``(m, N + 1, 3)``.
    bending_energy
        Energy [B/L], shape ``(m,)``.
    rotation_angle
        Integral of the rate of turning about z [rad], shape ``(m,)``.
    settled_from
        Time from which on the integrator saw the state repeat itself [T]; None when it did not, or
        was not asked: the window is then the longest late part that is stationary.
    axisymmetric
        Whether motions of the body that differ by a turn about z are the same.
    fall
        How the displacement falls, if that is known already and no return to straight.

    Returns
    -------
    Verdict
        For any finite data, however short or odd.
    """
    looked = fall or _fall(time, nodes)
    if isinstance(looked, Verdict):
        return looked
    undecided: Verdict | None = None
    compare = comparison(axisymmetric=axisymmetric)
    for start in _windows(time, nodes, bending_energy, settled_from):
        part = slice(start, None)
        seen = Evidence(
            time[part], nodes[part], bending_energy[part], rotation_angle[part], compare
        )
        late = LateWindow(time[part], nodes[part], seen, axisymmetric)
        verdict = _verdict(late, looked)
        if verdict.name != UNDECIDED:
            return verdict
        undecided = undecided or verdict
        # A shorter window may leave a transient behind; of a lasting modulation it would only show
        # too little, so it is not asked.
        if not late.seen.transient:
            break
    return undecided or _too_few(time)


def coarse_verdict(
    time: Instants,
    nodes: Shapes,
    bending_energy: Instants,
    rotation_angle: Instants,
    *,
    steady_from: float | None,
    axisymmetric: bool = True,
) -> Verdict | None:
    """Judge a run that has few samples a period, if they tell: a straight one or a steady shape.

    A decay is not seen better by its last part. Shapes compared up to turns and the integral of the
    rate of turning have no periods to follow, where the integrator saw the shape hardly change.

    Parameters
    ----------
    time, nodes, bending_energy, rotation_angle, axisymmetric
        As of `first_verdict`.
    steady_from
        Time from which on the integrator saw a steady shape [T]; None if it did not.

    Returns
    -------
    Verdict or None
    """
    fall = _fall(time, nodes)
    if isinstance(fall, Verdict):
        return fall if fall.name == STRAIGHT else None
    if steady_from is None:
        return None
    start = int(np.searchsorted(time, steady_from))
    turns = abs(float(rotation_angle[-1] - rotation_angle[start])) / (2.0 * np.pi)
    if len(time) - start < max(MIN_STEADY_SAMPLES, MIN_SAMPLES_PER_PERIOD * turns):
        return None
    found = first_verdict(
        time,
        nodes,
        bending_energy,
        rotation_angle,
        settled_from=steady_from,
        axisymmetric=axisymmetric,
        fall=fall,
    )
    return found if found.name == "spinning" else None


def with_exponents(verdict: Verdict, exponents: Lyapunov) -> Verdict:
    """Return a verdict in the light of Lyapunov exponents: what an irregular motion is.

    Of any other motion they tell whether neighbouring ones part, so that it will not last.
    """
    value, error = exponents.beyond_symmetry, exponents.beyond_symmetry_error
    told = f"neighbouring motions part at {value:.3g} +- {error:.1g} /T"
    known = replace(
        verdict, evidence=verdict.evidence | {"lyapunov": value, "lyapunov_error": error}
    )
    late = verdict.late
    if late is None or late.back is None:
        parts = value > SIGNIFICANT * error
        return replace(known, reason=f"{verdict.reason}; {told}") if parts else known
    interval = float(late.time[-1] - late.time[0]) / late.back.maxima
    if value < -SIGNIFICANT * error:
        # On a torus there is a third exponent of 0, in chaos a positive one.
        reason = f"irregular so far, but neighbouring motions join at {-value:.3g} /T: run longer"
        return replace(known, reason=reason, longer=float(np.log(1.0 / RECURRENT)) / -value)
    if value > SIGNIFICANT * error and value * interval > LEAST_GROWTH:
        reason = f"irregular: {told}, by exp({value * interval:.2g}) from maximum to maximum"
        return _named(known, Name("chaotic", reason, value / (SIGNIFICANT * error)))
    if (value + SIGNIFICANT * error) * interval < LEAST_GROWTH:
        return _named(known, wandering(late, told))
    return replace(known, reason=f"irregular, and {told}: run longer")


def _named(verdict: Verdict, name: Name) -> Verdict:
    margin = min(MOST, name.margin)
    return replace(verdict, name=name.name, reason=name.reason, margin=margin, longer=None)


def _fall(time: Instants, nodes: Shapes) -> Straightening | Verdict:
    """Return how the displacement falls, or the verdict if no more has to be looked at."""
    away = displacement(nodes)
    if not np.any(away > UNMOVED):
        return Verdict(STRAIGHT, "the filament has not moved", {}, _first(time), margin=MOST)
    if len(time) < MIN_SAMPLES:
        return _too_few(time)
    fall = straightening(time, nodes, away)
    return _straight(fall, float(time[fall.start])) if fall.complete else fall


def _first(time: Instants) -> float:
    return float(time[0]) if len(time) else 0.0


def _too_few(time: Instants) -> Verdict:
    reason = f"only {len(time)} samples, and {MIN_SAMPLES} are the least: ask for more samples"
    return Verdict(UNDECIDED, reason, {"samples": float(len(time))}, _first(time))


def _windows(
    time: Instants, nodes: Shapes, bending_energy: Instants, settled_from: float | None
) -> Iterable[int]:
    if settled_from is not None:
        start = int(np.searchsorted(time, settled_from))
        if len(time) - start >= MIN_SAMPLES:
            return [start]
    return late_windows(time, nodes, bending_energy)


def _straight(fall: Straightening, start: float) -> Verdict:
    evidence = {"decay_factor": fall.factor}
    margin = min(MOST, fall.factor / DECAY_FACTOR)
    if fall.motion is None:
        reason = f"the displacement fell {fall.factor:.3g}-fold, too fast for the samples to show"
        return Verdict(STRAIGHT, reason, evidence, start, margin=margin)
    motion = fall.motion
    evidence |= {
        "decay_rate": -motion.rate,
        "decay_rate_error": motion.rate_error,
        "ringing_frequency": motion.frequency if motion.rings else 0.0,
        "zero_crossings": float(motion.crossings),
    }
    reason = f"{_manner(motion)}; the displacement fell {fall.factor:.3g}-fold from its peak"
    return Verdict(STRAIGHT, reason, evidence, start, margin=margin)


def _manner(motion: LinearMotion) -> str:
    crossings = f"{motion.crossings} zero crossing{'' if motion.crossings == 1 else 's'}"
    if motion.rings:
        ringing = f"ringing decay ({crossings}) at rate {-motion.rate:.4g}/T"
        return f"{ringing} and frequency {motion.frequency:.4g} cycles/T"
    return f"monotone decay ({crossings}) at rate {-motion.rate:.4g}/T"


def _verdict(late: LateWindow, fall: Straightening) -> Verdict:
    """Name what a window shows, or say what is missing."""
    start = float(late.time[0])
    found = steady(late) or name_windmilling(late) or name_flapping(late)
    enough = found is None and _seen_enough(late, fall)
    if enough:
        found = returning(late)
    if found is not None and found.still_changing:
        reason = f"{found.name} so far, but {found.still_changing}: run longer"
        span = float(late.time[-1] - late.time[0])
        return Verdict(UNDECIDED, reason, late.numbers(), start, longer=span)
    if found is not None and found.margin < THIN:
        reason = f"on the border of {found.name}: {found.reason}"
        return Verdict(UNDECIDED, reason, late.numbers(), start)
    if found is not None:
        return Verdict(found.name, found.reason, late.numbers(), start, margin=found.margin)
    reason, longer = why_undecided(late, fall)
    waits = late if enough and late.irregular else None
    return Verdict(UNDECIDED, reason, late.numbers(), start, longer=longer, late=waits)


def _seen_enough(late: LateWindow, fall: Straightening) -> bool:
    """Whether the window shows a motion, not the growth or decay of a small one."""
    seen = late.seen
    sampled = seen.samples_per_period >= MIN_SAMPLES_PER_PERIOD
    return not (seen.steady or fall.falling or seen.growth is not None) and sampled
