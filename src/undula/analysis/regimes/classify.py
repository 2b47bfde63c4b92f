"""Verdict on a run: the name of its final motion, or the reason why it is undecided.

`straight` is the equilibrium; the other names are those of `undula.analysis.regimes.names`, and
`chaotic`. A motion that has not settled is `undecided`, with the reason and the time that the run
lacks. A motion without recurrence in a long window is irregular; its Lyapunov exponents, which need
the model, decide between chaotic and quasi-periodic: `with_exponents`.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from undula.analysis.observables.alignment import comparison
from undula.analysis.observables.linear_mode import LinearMotion
from undula.analysis.observables.shapes import displacement
from undula.analysis.regimes.evidence import Evidence
from undula.analysis.regimes.late_window import MIN_MARGIN, LateWindow, Name
from undula.analysis.regimes.lyapunov import Lyapunov
from undula.analysis.regimes.names import (
    name_flapping,
    name_quasi_periodic,
    name_recurrent,
    name_steady,
    name_windmilling,
)
from undula.analysis.regimes.recurrence import MAX_RECURRENCE_DISTANCE
from undula.analysis.regimes.relaxation import MIN_DECAY_FACTOR, Relaxation, relaxation
from undula.analysis.regimes.stationary_window import late_windows
from undula.analysis.regimes.verdict import MAX_MARGIN, STRAIGHT, UNDECIDED, Verdict
from undula.analysis.regimes.why_undecided import MIN_SAMPLES_PER_PERIOD, why_undecided
from undula.arrays import Instants, Shapes

# Largest displacement that round-off makes of a straight filament [L].
ROUND_OFF_LENGTH = 1e-12
# Least number of samples for a verdict.
MIN_SAMPLES = 8
# Least number of samples of a steady shape, twice those that show its rate of rotation.
MIN_STEADY_SAMPLES = 32
# Least quotient of a positive Lyapunov exponent and its error.
SIGNIFICANCE_FACTOR = 3.0
# Least exponent of the divergence of neighbouring motions in chaos, from one maximum of the
# displacement to the next.
MIN_DIVERGENCE = 0.05


def first_verdict(
    time: Instants,
    nodes: Shapes,
    bending_energy: Instants,
    rotation_angle: Instants,
    *,
    settled_from: float | None,
    axisymmetric: bool = True,
    known_fall: Relaxation | None = None,
) -> Verdict:
    """Classify a run by the shapes in a late window.

    Parameters
    ----------
    time
        Equally spaced times [T], shape ``(m,)``, dense enough to resolve the motion.
    nodes
        Node positions [L], shape ``(m, N + 1, 3)``.
    bending_energy
        Energy [B/L], shape ``(m,)``.
    rotation_angle
        Integral of the rate of rotation about z [rad], shape ``(m,)``.
    settled_from
        Time from which on the state repeats itself during the integration [T]. None if it does not
        or was not watched: the window is then the longest stationary late one.
    axisymmetric
        True if motions of the body are compared up to rotations about z.
    known_fall
        Decay of the displacement, if it has been measured and does not end straight.

    Returns
    -------
    Verdict
        For any finite data.
    """
    fall = known_fall or _relaxation(time, nodes)
    if isinstance(fall, Verdict):
        return fall
    undecided: Verdict | None = None
    compare = comparison(axisymmetric=axisymmetric)
    for start in _windows(time, nodes, bending_energy, settled_from):
        part = slice(start, None)
        seen = Evidence(
            time[part], nodes[part], bending_energy[part], rotation_angle[part], compare
        )
        late = LateWindow(time[part], nodes[part], seen, axisymmetric)
        verdict = _verdict(late, fall)
        if verdict.name != UNDECIDED:
            return verdict
        undecided = undecided or verdict
        # A shorter window may exclude a transient, but shows too little of a lasting modulation.
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
    """Classify a straight run or a steady shape from few samples a period.

    A relaxation needs no dense samples of its end, and a steady shape, compared up to rotations and
    with the integral of its rate of rotation, has no periods to resolve.

    Parameters
    ----------
    time, nodes, bending_energy, rotation_angle, axisymmetric
        As in `first_verdict`.
    steady_from
        Time from which on the shape is steady during the integration [T]; None if it is not.

    Returns
    -------
    Verdict or None
        None for all other motions.
    """
    fall = _relaxation(time, nodes)
    if isinstance(fall, Verdict):
        return fall if fall.name == STRAIGHT else None
    if steady_from is None:
        return None
    start = int(np.searchsorted(time, steady_from))
    turns = abs(float(rotation_angle[-1] - rotation_angle[start])) / (2.0 * np.pi)
    if len(time) - start < max(MIN_STEADY_SAMPLES, MIN_SAMPLES_PER_PERIOD * turns):
        return None
    verdict = first_verdict(
        time,
        nodes,
        bending_energy,
        rotation_angle,
        settled_from=steady_from,
        axisymmetric=axisymmetric,
        known_fall=fall,
    )
    return verdict if verdict.name == "spinning" else None


def with_exponents(verdict: Verdict, exponents: Lyapunov) -> Verdict:
    """Classify an irregular motion by its Lyapunov exponents.

    For other motions the reason states if neighbouring motions diverge, so that they will not last.

    Parameters
    ----------
    verdict
        Of `first_verdict`.
    exponents
        Lyapunov exponents of the motion [1/T].

    Returns
    -------
    Verdict
        With the exponent in its evidence.
    """
    value, error = exponents.beyond_symmetry, exponents.beyond_symmetry_error
    uncertainty = SIGNIFICANCE_FACTOR * error
    divergence = f"neighbouring motions part at {value:.3g} +- {error:.1g} /T"
    extended = replace(
        verdict, evidence=verdict.evidence | {"lyapunov": value, "lyapunov_error": error}
    )
    late = verdict.late
    if late is None or late.recurrence is None:
        diverges = value > uncertainty
        return replace(extended, reason=f"{verdict.reason}; {divergence}") if diverges else extended
    # Mean time between maxima of the displacement.
    interval = float(late.time[-1] - late.time[0]) / late.recurrence.maxima
    if value < -uncertainty:
        # A torus has a third exponent of 0, chaos a positive one.
        reason = f"irregular so far, but neighbouring motions join at {-value:.3g} /T: run longer"
        return replace(
            extended, reason=reason, longer=float(np.log(1.0 / MAX_RECURRENCE_DISTANCE)) / -value
        )
    if value > uncertainty and value * interval > MIN_DIVERGENCE:
        reason = f"irregular: {divergence}, by exp({value * interval:.2g}) from maximum to maximum"
        return _named(extended, Name("chaotic", reason, value / uncertainty))
    if (value + uncertainty) * interval < MIN_DIVERGENCE:
        return _named(extended, name_quasi_periodic(late, divergence))
    return replace(extended, reason=f"irregular, and {divergence}: run longer")


def _named(verdict: Verdict, name: Name) -> Verdict:
    margin = min(MAX_MARGIN, name.margin)
    return replace(verdict, name=name.name, reason=name.reason, margin=margin, longer=None)


def _relaxation(time: Instants, nodes: Shapes) -> Relaxation | Verdict:
    """Return the decay of the displacement, or a verdict that follows from it alone."""
    away = displacement(nodes)
    if not np.any(away > ROUND_OFF_LENGTH):
        return Verdict(STRAIGHT, "the filament has not moved", {}, _first(time), margin=MAX_MARGIN)
    if len(time) < MIN_SAMPLES:
        return _too_few(time)
    fall = relaxation(time, nodes, away)
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


def _straight(fall: Relaxation, start: float) -> Verdict:
    evidence = {"decay_factor": fall.factor}
    margin = min(MAX_MARGIN, fall.factor / MIN_DECAY_FACTOR)
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
    reason = (
        f"{_decay_description(motion)}; the displacement fell {fall.factor:.3g}-fold from its peak"
    )
    return Verdict(STRAIGHT, reason, evidence, start, margin=margin)


def _decay_description(motion: LinearMotion) -> str:
    crossings = f"{motion.crossings} zero crossing{'' if motion.crossings == 1 else 's'}"
    if motion.rings:
        ringing = f"ringing decay ({crossings}) at rate {-motion.rate:.4g}/T"
        return f"{ringing} and frequency {motion.frequency:.4g} cycles/T"
    return f"monotone decay ({crossings}) at rate {-motion.rate:.4g}/T"


def _verdict(window: LateWindow, fall: Relaxation) -> Verdict:
    """Name the motion in a window, or give the reason why it is undecided."""
    start = float(window.time[0])
    candidate = name_steady(window) or name_windmilling(window) or name_flapping(window)
    long_enough = candidate is None and _is_long_enough(window, fall)
    if long_enough:
        candidate = name_recurrent(window)
    if candidate is not None and candidate.still_changing:
        reason = f"{candidate.name} so far, but {candidate.still_changing}: run longer"
        span = float(window.time[-1] - window.time[0])
        return Verdict(UNDECIDED, reason, window.numbers(), start, longer=span)
    if candidate is not None and candidate.margin < MIN_MARGIN:
        reason = f"on the border of {candidate.name}: {candidate.reason}"
        return Verdict(UNDECIDED, reason, window.numbers(), start)
    if candidate is not None:
        return Verdict(
            candidate.name, candidate.reason, window.numbers(), start, margin=candidate.margin
        )
    reason, longer = why_undecided(window, fall)
    pending = window if long_enough and window.irregular else None
    return Verdict(UNDECIDED, reason, window.numbers(), start, longer=longer, late=pending)


def _is_long_enough(window: LateWindow, fall: Relaxation) -> bool:
    """Return True if the window shows a motion, not the growth or decay of a small one."""
    seen = window.seen
    sampled = seen.samples_per_period >= MIN_SAMPLES_PER_PERIOD
    return not (seen.steady or fall.falling or seen.growth is not None) and sampled
