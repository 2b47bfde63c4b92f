"""The verdict on a run: the name of what it ends in, or what is missing to tell.

`straight` is the equilibrium; the other names are those of `undula.analysis.naming`, and `chaotic`.
What has not settled is left `undecided`, with the reason and how much longer to run. A motion that
is seen long enough and comes back to no shape is irregular; whether it is chaotic or on a torus is
told by its Lyapunov exponent, which needs the model: `settle_irregular`.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from undula.analysis.decay import LinearMotion
from undula.analysis.evidence import Evidence, measure
from undula.analysis.lyapunov import Lyapunov
from undula.analysis.naming import (
    MANY_MAXIMA,
    PLANAR_TOLERANCE,
    THIN,
    Late,
    Name,
    flaps,
    returning,
    spins,
    steady,
    wandering,
    windmills,
)
from undula.analysis.observables import displacement
from undula.analysis.straightening import DECAY_FACTOR, LATE_FACTOR, Straightening, straightening
from undula.analysis.window import STATIONARY, late_windows
from undula.arrays import Instants, Shapes

UNDECIDED = "undecided"
# A filament that stays this near to straight [L] has not moved: round-off alone gets it so far.
UNMOVED = 1e-12
# No criterion counts as met by more than this factor.
MOST = 100.0
# Without this many samples nothing can be said about a motion.
MIN_SAMPLES = 8
# With fewer samples a period than this, sampling is named first among what an undecided run lacks.
MIN_SAMPLES_PER_PERIOD = 6.0
# A Lyapunov exponent above so many of its errors is positive.
SIGNIFICANT = 3.0
# Neighbouring motions that part by less than this factor in a cycle do not part.
LEAST_GROWTH = 0.05


@dataclass(frozen=True)
class Verdict:
    """What a run ends in.

    Attributes
    ----------
    name
        ``straight``, ``undecided``, ``chaotic`` or one of `undula.analysis.naming`.
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
    late: Late | None = None


def first_verdict(
    time: Instants,
    nodes: Shapes,
    bending_energy: Instants,
    rotation_angle: Instants,
    *,
    settled_from: float | None,
) -> Verdict:
    """Judge a run by its whole shape over a late window.

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

    Returns
    -------
    Verdict
        For any finite data, however short or odd.
    """
    fall = _fall(time, nodes)
    if isinstance(fall, Verdict):
        return fall
    undecided: Verdict | None = None
    for start in _windows(time, nodes, bending_energy, settled_from):
        part = slice(start, None)
        seen = measure(time[part], nodes[part], bending_energy[part], rotation_angle[part])
        late = Late(time[part], nodes[part], bending_energy[part], seen)
        verdict = _verdict(late, fall)
        if verdict.name != UNDECIDED:
            return verdict
        undecided = undecided or verdict
        # A shorter window may leave a transient behind; of a lasting modulation it would only show
        # too little, so it is not asked.
        if not seen.transient:
            break
    return undecided or _too_few(time)


def straight_verdict(time: Instants, nodes: Shapes) -> Verdict | None:
    """Return the verdict of `first_verdict` if that is straight, and else None: this is quick."""
    fall = _fall(time, nodes)
    return fall if isinstance(fall, Verdict) and fall.name == "straight" else None


def settle_irregular(verdict: Verdict, exponents: Lyapunov) -> Verdict:
    """Return the verdict on an irregular motion in the light of its Lyapunov exponents."""
    late = verdict.late
    if late is None or late.back is None:
        return verdict
    value, error = exponents.beyond_symmetry, exponents.beyond_symmetry_error
    evidence = verdict.evidence | {"lyapunov": value, "lyapunov_error": error}
    cycle = 1.0 / abs(late.seen.frequency.value) if late.seen.frequency else late.back.period
    told = f"neighbouring motions part at {value:.3g} +- {error:.1g} /T"
    if value > SIGNIFICANT * error and value * cycle > LEAST_GROWTH:
        reason = f"{told}, by exp({value * cycle:.2g}) a cycle"
        name = Name("chaotic", reason, value / (SIGNIFICANT * error))
    elif (value + SIGNIFICANT * error) * cycle < LEAST_GROWTH:
        name = wandering(late)
    else:
        return replace(verdict, evidence=evidence, reason=f"irregular, and {told}: run longer")
    reason = f"{name.reason} ({told})" if name.name != "chaotic" else name.reason
    return replace(
        verdict, name=name.name, reason=reason, evidence=evidence, margin=min(MOST, name.margin)
    )


def _fall(time: Instants, nodes: Shapes) -> Straightening | Verdict:
    """Return how the displacement falls, or the verdict if no more has to be looked at."""
    if not np.any(displacement(nodes) > UNMOVED):
        return Verdict("straight", "the filament has not moved", {}, _first(time), margin=MOST)
    if len(time) < MIN_SAMPLES:
        return _too_few(time)
    fall = straightening(time, nodes)
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
        return Verdict("straight", reason, evidence, start, margin=margin)
    motion = fall.motion
    evidence |= {
        "decay_rate": -motion.rate,
        "decay_rate_error": motion.rate_error,
        "ringing_frequency": motion.frequency if motion.rings else 0.0,
        "zero_crossings": float(motion.crossings),
    }
    reason = f"{_manner(motion)}; the displacement fell {fall.factor:.3g}-fold from its peak"
    return Verdict("straight", reason, evidence, start, margin=margin)


def _manner(motion: LinearMotion) -> str:
    crossings = f"{motion.crossings} zero crossing{'' if motion.crossings == 1 else 's'}"
    if motion.rings:
        ringing = f"ringing decay ({crossings}) at rate {-motion.rate:.4g}/T"
        return f"{ringing} and frequency {motion.frequency:.4g} cycles/T"
    return f"monotone decay ({crossings}) at rate {-motion.rate:.4g}/T"


def _verdict(late: Late, fall: Straightening) -> Verdict:
    """Name what a window shows, or say what is missing."""
    start = float(late.time[0])
    found = spins(late) or windmills(late) or flaps(late, STATIONARY)
    if found is None and _seen_enough(late, fall):
        found = returning(late)
    if found is not None and found.margin >= THIN:
        return Verdict(found.name, found.reason, late.numbers(), start, margin=found.margin)
    if found is not None:
        reason = f"on the border of {found.name}: {found.reason}"
        return Verdict(UNDECIDED, reason, late.numbers(), start)
    waits = late if _seen_enough(late, fall) and late.irregular else None
    reason, longer = _missing(late, fall)
    return Verdict(UNDECIDED, reason, late.numbers(), start, longer=longer, late=waits)


def _seen_enough(late: Late, fall: Straightening) -> bool:
    """Whether the window shows a motion, not the growth or decay of a small one."""
    seen = late.seen
    sampled = seen.samples_per_period >= MIN_SAMPLES_PER_PERIOD
    return not (steady(seen) or fall.falling or seen.growth is not None) and sampled


def _missing(late: Late, fall: Straightening) -> tuple[str, float | None]:
    """Say why there is no verdict, most specific reasons first, and how much longer to run."""
    seen, span = late.seen, float(late.time[-1] - late.time[0])
    if steady(seen):
        turned = f"bent and steady, but seen to turn by only {abs(seen.turns):.2g} of a turn"
        return f"{turned}: if it is not at rest, run longer", span
    if fall.falling and fall.motion is not None:
        so_far = f"{fall.factor:.3g}-fold in all and {fall.late_factor:.3g}-fold in the later half"
        needed = f"{DECAY_FACTOR:g} and {LATE_FACTOR:g} count as straight"
        rate = -fall.motion.rate
        to_go = float(np.log(max(DECAY_FACTOR / fall.factor, LATE_FACTOR))) / rate
        return f"decaying at rate {rate:.4g}/T, {so_far} ({needed}): run longer", to_go
    if seen.growth is not None:
        rate = seen.growth.rate
        to_go = float(np.log(1.0 / seen.displacement)) / rate
        return f"still growing from straight at rate {rate:.4g}/T: run longer", to_go
    if seen.samples_per_period < MIN_SAMPLES_PER_PERIOD:
        few = f"about {seen.samples_per_period:.2g} samples a period only"
        return f"{few}: ask for more samples", None
    if late.irregular and late.back is not None:
        near = f"{late.back.distance:.2g} of itself after {late.back.every} maxima of its energy"
        return f"irregular: its shape comes no nearer than {near}: run longer", span
    if seen.drift > STATIONARY or seen.transient:
        return _unsettled(seen), span
    return _few_returns(late), span


def _few_returns(late: Late) -> str:
    """Say what is missing of a motion that does not drift."""
    back, plane = late.back, late.seen.planarity
    where = "planar" if plane <= PLANAR_TOLERANCE else f"{plane:.1%} out of plane"
    if back is None:
        return f"{where}, but no maxima of its energy show that it repeats itself: run longer"
    if back.repeats:
        return f"{where}, but what does not repeat grows {back.growth:.2g}-fold: run longer"
    seen = f"{back.maxima} maxima of its energy seen, {MANY_MAXIMA} show that it is irregular"
    return f"{where}, and its shape comes back to {back.distance:.1%} only ({seen}): run longer"


def _unsettled(seen: Evidence) -> str:
    turns = abs(seen.turns)
    if turns >= 1.0 and seen.transient:
        return f"the shape still changes by {seen.shape_drift / turns:.2%} per turn: run longer"
    return f"the motion still changes by {seen.drift:.1%} between halves of the window: run longer"
