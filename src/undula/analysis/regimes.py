"""The first verdict on a run: straight, spinning, planar flapping, or what is missing to tell.

The words are those of the regimes' mathematics: `straight` is the equilibrium, `spinning` a shape
that is steady but for its rotation about z, `planar flapping` a periodic motion in one plane
through z. All that is neither is left `undecided`, with the reason.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from undula.analysis.decay import LinearMotion
from undula.analysis.evidence import Evidence, measure
from undula.analysis.observables import displacement
from undula.analysis.straightening import DECAY_FACTOR, LATE_FACTOR, Straightening, straightening
from undula.analysis.window import STATIONARY, late_windows
from undula.arrays import Instants, Shapes

UNDECIDED = "undecided"
# A filament that stays this near to straight [L] has not moved: round-off alone gets it so far.
UNMOVED = 1e-12
# Without this many samples nothing can be said about a motion.
MIN_SAMPLES = 8
# Largest change of shape up to turns in spinning, relative: far above integration errors, far below
# any modulation that would deserve another name.
SHAPE_TOLERANCE = 5e-3
# The same for the energy, which is quadratic in the shape.
ENERGY_TOLERANCE = 1e-2
# A steady shape must be seen to come round once; in less it could grow or shrink unseen.
MIN_TURNS = 1.0
# Share out of the plane below which a motion is planar: a trace of the start that still decays.
PLANAR_TOLERANCE = 0.02
# Share of the motion that its harmonics may leave unexplained: the highest ones of a violent
# flapping, and one or two more where few samples a period make them fold together.
PERIODIC_TOLERANCE = 0.05
# With fewer samples a period than this, sampling is named first among what an undecided run lacks.
MIN_SAMPLES_PER_PERIOD = 6.0


@dataclass(frozen=True)
class Verdict:
    """What a run ends in.

    Attributes
    ----------
    name
        ``straight``, ``spinning``, ``planar flapping`` or ``undecided``.
    reason
        One sentence: what was seen, or what is missing.
    evidence
        The numbers behind it by name; shares are relative, the rest in units of L, T and B.
    window_start
        Time from which on the run was judged [T].
    """

    name: str
    reason: str
    evidence: dict[str, float]
    window_start: float


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
    if not np.any(displacement(nodes) > UNMOVED):
        return Verdict("straight", "the filament has not moved", {}, _first(time))
    if len(time) < MIN_SAMPLES:
        return _too_few(time)
    fall = straightening(time, nodes)
    if fall.complete:
        return _straight(fall, float(time[fall.start]))
    undecided: Verdict | None = None
    for start in _windows(time, nodes, bending_energy, settled_from):
        late = slice(start, None)
        seen = measure(time[late], nodes[late], bending_energy[late], rotation_angle[late])
        name, reason = _judge(seen, fall)
        verdict = Verdict(name, reason, seen.numbers(), float(time[start]))
        if name != UNDECIDED:
            return verdict
        undecided = undecided or verdict
        # A shorter window may leave a transient behind; of a lasting modulation it would only show
        # too little, so it is not asked.
        if not seen.transient:
            break
    return undecided or _too_few(time)


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
    if fall.motion is None:
        reason = f"the displacement fell {fall.factor:.3g}-fold, too fast for the samples to show"
        return Verdict("straight", reason, evidence, start)
    motion = fall.motion
    evidence |= {
        "decay_rate": -motion.rate,
        "decay_rate_error": motion.rate_error,
        "ringing_frequency": motion.frequency if motion.rings else 0.0,
        "zero_crossings": float(motion.crossings),
    }
    reason = f"{_manner(motion)}; the displacement fell {fall.factor:.3g}-fold from its peak"
    return Verdict("straight", reason, evidence, start)


def _manner(motion: LinearMotion) -> str:
    crossings = f"{motion.crossings} zero crossing{'' if motion.crossings == 1 else 's'}"
    if motion.rings:
        ringing = f"ringing decay ({crossings}) at rate {-motion.rate:.4g}/T"
        return f"{ringing} and frequency {motion.frequency:.4g} cycles/T"
    return f"monotone decay ({crossings}) at rate {-motion.rate:.4g}/T"


def _judge(seen: Evidence, fall: Straightening) -> tuple[str, str]:
    if _steady(seen) and abs(seen.turns) >= MIN_TURNS:
        change = f"its shape changes by {seen.shape_change:.2g} of itself"
        return "spinning", f"rotates steadily: over {seen.turns:.3g} turns {change}"
    if _flaps(seen):
        plane = f"{seen.planarity:.2g} of the motion out of its plane"
        return "planar flapping", f"periodic over {seen.periods:.3g} periods with {plane}"
    return UNDECIDED, _missing(seen, fall)


def _steady(seen: Evidence) -> bool:
    return seen.shape_change <= SHAPE_TOLERANCE and seen.energy_swing <= ENERGY_TOLERANCE


def _flaps(seen: Evidence) -> bool:
    return (
        seen.planarity <= PLANAR_TOLERANCE
        and seen.misfit <= PERIODIC_TOLERANCE
        and seen.drift <= STATIONARY
        and seen.energy_swing > ENERGY_TOLERANCE
    )


def _missing(seen: Evidence, fall: Straightening) -> str:
    """Say why there is no verdict, most specific reasons first."""
    if _steady(seen):
        turned = f"bent and steady, but seen to turn by only {abs(seen.turns):.2g} of a turn"
        return f"{turned}: if it is not at rest, run longer"
    if fall.falling and fall.motion is not None:
        so_far = f"{fall.factor:.3g}-fold in all and {fall.late_factor:.3g}-fold in the later half"
        needed = f"{DECAY_FACTOR:g} and {LATE_FACTOR:g} count as straight"
        return f"decaying at rate {-fall.motion.rate:.4g}/T, {so_far} ({needed}): run longer"
    if seen.growth is not None:
        return f"still growing from straight at rate {seen.growth.rate:.4g}/T: run longer"
    if seen.samples_per_period < MIN_SAMPLES_PER_PERIOD:
        return f"about {seen.samples_per_period:.2g} samples a period only: ask for more samples"
    if seen.drift > STATIONARY or seen.transient:
        return _unsettled(seen)
    if seen.planarity > PLANAR_TOLERANCE:
        neither = f"{seen.planarity:.1%} out of plane, shape changing by {seen.shape_change:.1%}"
        return (
            f"the motion has settled but is neither planar nor steady up to turns ({neither}): "
            "modulated, precessing and non-planar motions are not told apart yet"
        )
    if seen.frequency is None:
        return "planar, but no frequency stands out: run longer or ask for more samples"
    return f"planar, but {seen.misfit:.1%} of the motion does not repeat: run longer"


def _unsettled(seen: Evidence) -> str:
    turns = abs(seen.turns)
    if turns >= 1.0 and seen.transient:
        return f"the shape still changes by {seen.shape_drift / turns:.2%} per turn: run longer"
    return f"the motion still changes by {seen.drift:.1%} between halves of the window: run longer"
