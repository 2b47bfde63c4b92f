"""Reason for an undecided verdict, in one sentence, and time that the run lacks."""

from __future__ import annotations

import numpy as np

from undula.analysis.regimes.evidence import Evidence
from undula.analysis.regimes.late_window import MIN_IRREGULAR_MAXIMA, PLANAR_TOLERANCE, LateWindow
from undula.analysis.regimes.recurrence import MAX_RECURRENCE_DISTANCE
from undula.analysis.regimes.relaxation import MIN_DECAY_FACTOR, MIN_LATE_FACTOR, Relaxation
from undula.analysis.regimes.stationary_window import FALLBACK_SHARE, MAX_STATIONARY_DRIFT

# Least number of samples a period for a statement on the motion; with fewer, more are asked for.
MIN_SAMPLES_PER_PERIOD = 6.0


def why_undecided(window: LateWindow, fall: Relaxation) -> tuple[str, float | None]:
    """Return the reason for an undecided verdict, the most specific one that applies.

    Parameters
    ----------
    window
        The late window of the run.
    fall
        Decay of the displacement in the whole run.

    Returns
    -------
    reason
        One sentence.
    longer
        Time that the run lacks, roughly [T]; None if a longer run does not help.
    """
    evidence, span = window.seen, float(window.time[-1] - window.time[0])
    if evidence.steady:
        turned = f"bent and steady, but seen to turn by only {abs(evidence.turns):.2g} of a turn"
        return f"{turned}: if it is not at rest, run longer", span
    if fall.falling and fall.motion is not None:
        so_far = f"{fall.factor:.3g}-fold in all and {fall.late_factor:.3g}-fold in the later half"
        needed = f"{MIN_DECAY_FACTOR:g} and {MIN_LATE_FACTOR:g} count as straight"
        rate = -fall.motion.rate
        to_go = float(np.log(max(MIN_DECAY_FACTOR / fall.factor, MIN_LATE_FACTOR))) / rate
        return f"decaying at rate {rate:.4g}/T, {so_far} ({needed}): run longer", to_go
    if evidence.growth is not None:
        rate = evidence.growth.rate
        to_go = float(np.log(1.0 / evidence.displacement)) / rate
        return f"still growing from straight at rate {rate:.4g}/T: run longer", to_go
    if evidence.samples_per_period < MIN_SAMPLES_PER_PERIOD:
        few = f"about {evidence.samples_per_period:.2g} samples a period only"
        return f"{few}: ask for more samples", None
    if window.irregular and window.recurrence is not None:
        near = f"{window.recurrence.distance:.2g} of itself after {window.recurrence.every} maxima"
        return f"irregular: its shape comes no nearer than {near}: run longer", span
    if evidence.drift > MAX_STATIONARY_DRIFT or evidence.transient:
        return _continuing_change(evidence), span
    maxima = window.recurrence.maxima if window.recurrence else 1
    # The window may be a third of the run, as may be that of the continued run.
    more = (MIN_IRREGULAR_MAXIMA / maxima - 1.0) / FALLBACK_SHARE
    return _missing_recurrence(window), span * max(1.0, more)


def _missing_recurrence(window: LateWindow) -> str:
    """Return the reason for a motion that does not drift."""
    recurrence, plane = window.recurrence, window.seen.planarity
    where = "planar" if plane <= PLANAR_TOLERANCE else f"{plane:.1%} out of plane"
    if recurrence is None:
        return f"{where}, but no maxima of its displacement show that it repeats itself: run longer"
    if recurrence.repeats:
        return f"{where}, but what does not repeat grows {recurrence.growth:.2g}-fold: run longer"
    seen = (
        f"({recurrence.maxima} maxima seen, {MIN_IRREGULAR_MAXIMA} show that it is irregular):"
        " run longer"
    )
    if recurrence.distance <= MAX_RECURRENCE_DISTANCE:
        return f"{where}, and its shape comes back, but not often and always {seen}"
    return f"{where}, and its shape comes back to {recurrence.distance:.1%} only {seen}"


def _continuing_change(evidence: Evidence) -> str:
    """Return the reason for a motion that drifts."""
    turns = abs(evidence.turns)
    if turns >= 1.0 and evidence.transient:
        return f"the shape still changes by {evidence.shape_drift / turns:.2%} per turn: run longer"
    drift = f"{evidence.drift:.1%}"
    return f"the motion still changes by {drift} between halves of the window: run longer"
