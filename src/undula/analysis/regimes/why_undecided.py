"""What is missing of a run to name its motion, in a sentence, and how much longer to run."""

from __future__ import annotations

import numpy as np

from undula.analysis.regimes.evidence import Evidence
from undula.analysis.regimes.late_window import MANY_MAXIMA, PLANAR_TOLERANCE, LateWindow
from undula.analysis.regimes.recurrence import RECURRENT
from undula.analysis.regimes.relaxation import DECAY_FACTOR, LATE_FACTOR, Straightening
from undula.analysis.regimes.stationary_window import FALLBACK_SHARE, STATIONARY

# With fewer samples a period than this, sampling is named first among what an undecided run lacks.
MIN_SAMPLES_PER_PERIOD = 6.0


def why_undecided(late: LateWindow, fall: Straightening) -> tuple[str, float | None]:
    """Say why there is no verdict, most specific reasons first.

    Parameters
    ----------
    late
        The late window of the run.
    fall
        How the displacement falls in the whole of it.

    Returns
    -------
    reason
        One sentence.
    longer
        How much longer to run, roughly [T]; None if that does not help.
    """
    seen, span = late.seen, float(late.time[-1] - late.time[0])
    if seen.steady:
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
        near = f"{late.back.distance:.2g} of itself after {late.back.every} maxima"
        return f"irregular: its shape comes no nearer than {near}: run longer", span
    if seen.drift > STATIONARY or seen.transient:
        return _unsettled(seen), span
    maxima = late.back.maxima if late.back else 1
    # The window may be a third of the run, and the next one as well.
    more = (MANY_MAXIMA / maxima - 1.0) / FALLBACK_SHARE
    return _few_returns(late), span * max(1.0, more)


def _few_returns(late: LateWindow) -> str:
    """Say what is missing of a motion that does not drift."""
    back, plane = late.back, late.seen.planarity
    where = "planar" if plane <= PLANAR_TOLERANCE else f"{plane:.1%} out of plane"
    if back is None:
        return f"{where}, but no maxima of its displacement show that it repeats itself: run longer"
    if back.repeats:
        return f"{where}, but what does not repeat grows {back.growth:.2g}-fold: run longer"
    seen = f"({back.maxima} maxima seen, {MANY_MAXIMA} show that it is irregular): run longer"
    if back.distance <= RECURRENT:
        return f"{where}, and its shape comes back, but not often and always {seen}"
    return f"{where}, and its shape comes back to {back.distance:.1%} only {seen}"


def _unsettled(seen: Evidence) -> str:
    turns = abs(seen.turns)
    if turns >= 1.0 and seen.transient:
        return f"the shape still changes by {seen.shape_drift / turns:.2%} per turn: run longer"
    return f"the motion still changes by {seen.drift:.1%} between halves of the window: run longer"
