"""Classification of a run: verdict, classified motion, and Lyapunov exponents where needed."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import Enum
from functools import partial

import numpy as np

from undula.analysis.observables.trajectory import Motion
from undula.analysis.regimes.classify import (
    SIGNIFICANCE_FACTOR,
    coarse_verdict,
    first_verdict,
    with_exponents,
)
from undula.analysis.regimes.lyapunov import Lyapunov, NotFollowed, lyapunov
from undula.analysis.regimes.verdict import MAX_MARGIN, STRAIGHT, UNDECIDED, Verdict
from undula.analysis.run_settings import Schedule
from undula.analysis.runs.accuracy import Errors
from undula.analysis.runs.credibility import Grounds
from undula.analysis.runs.early_stop import MAX_REMAINING_SHARE, MAX_STATE_DISTANCE
from undula.analysis.runs.fine_tail import CloseUp
from undula.analysis.runs.finite_separation import E_FOLDINGS, Separation, finite_separation
from undula.analysis.runs.reached_state import RECORDED_TURNS, ReachedState, motion_of
from undula.analysis.runs.settled_motion import Settled
from undula.arrays import Array, Instants, Shapes
from undula.errors import InputError
from undula.models.model import Model
from undula.numerics.integration.system import RATES

#: Numbers of maxima, beats and turns over which exponents are averaged; the shortest time counts.
EXPONENT_WINDOW = {"maxima": 300.0, "periods": 150.0, "turns": 50.0}
#: Multiples of that time that are tried in turn until the exponents decide.
EXPONENT_WINDOW_FACTORS = (1, 8)
#: Length of a pair of runs of a regular motion, as a share of that time.
PAIR_WINDOW_SHARE = 1.0 / 15.0
_STRAIGHT_HAS = (
    "a motion that ends straight has the eigenvalues of the straight state for exponents: ask"
    " for its spectrum"
)


#: Callback with the name of a computation and its finished share; it may raise `CutShortError`.
Watch = Callable[[str, float], None]


class CutShortError(Exception):
    """Raised by a `Watch` to end the computation of exponents; the text gives the reason."""


class Exponents(Enum):
    """Condition for computing Lyapunov exponents, which takes three times as long as a run."""

    NEVER = "never"
    IF_IRREGULAR = "if the motion is irregular"
    ALWAYS = "always"


@dataclass(frozen=True)
class Classified:
    """A verdict with its grounds.

    Attributes
    ----------
    verdict : Verdict
    motion : Motion
        The trajectory that was classified.
    exponents : Lyapunov or None
        Lyapunov exponents, if they were requested or needed.
    separation : Separation or None
        Divergence of runs from nearby states, if exponents were requested.
    without : str
        Reason for missing exponents that were requested.
    """

    verdict: Verdict
    motion: Motion
    exponents: Lyapunov | None = None
    separation: Separation | None = None
    without: str = ""


def failed(motion: Motion, cause: str) -> Classified:
    """Return the undecided verdict on a run that failed.

    Parameters
    ----------
    motion
        Trajectory up to the failure.
    cause
        Cause and remedy in words.
    """
    start = float(motion.time[0])
    return Classified(Verdict(UNDECIDED, f"the run failed: {cause}", {}, start), motion)


def judge(
    model: Model,
    schedule: Schedule,
    motions: tuple[Motion, CloseUp | None],
    errors: Errors,
    last: Array,
    reached: Settled | ReachedState | None,
    exponents: Exponents,
    watch: Watch = lambda *_: None,
) -> Classified:
    """Classify a run by its whole motion and by the close-up of its end.

    Parameters
    ----------
    model, schedule
        Of the run.
    motions
        Trajectory of the whole run, and its last periods at finer intervals if it needs them.
    errors
        Errors of the run.
    last
        Its last sample, shape ``(n + RATES,)``.
    reached
        The settled motion or the stable state of the run; None without either.
    exponents
        Condition for computing Lyapunov exponents.
    watch
        Callback of the computation of exponents.

    Returns
    -------
    Classified
    """
    arrived = isinstance(reached, ReachedState)
    grounds = Grounds(model, schedule, motions[0], errors, last[:-RATES], known_stable=arrived)
    if isinstance(reached, ReachedState):
        judged = Classified(_arrived(reached), motion_of(reached, model, last))
        last = last if reached.state is None else np.append(reached.state.unknowns, last[-RATES:])
    else:
        judged = _first(model, *motions, reached)
    judged = _credible(grounds, judged)
    if exponents is Exponents.NEVER:
        return judged
    asked = exponents is Exponents.ALWAYS
    if not asked and judged.verdict.late is None:
        return judged
    try:
        decided = _with_exponents(model, schedule, judged, last[:-RATES], watch, parting=asked)
    except (InputError, CutShortError) as error:
        return replace(judged, without=str(error))
    return _credible(grounds, decided)


def _credible(grounds: Grounds, judged: Classified) -> Classified:
    return replace(judged, verdict=grounds.believed(judged.verdict, judged.motion))


def _arrived(arrival: ReachedState) -> Verdict:
    """Return the verdict on a run that has reached a stable state."""
    rate, near = arrival.leading_rate, arrival.relative
    evidence = {"distance": arrival.distance, "leading_rate": rate}
    if arrival.state is None:
        reason = f"small and falling, to {near:.2g} of what it was; the straight state is stable"
        limit = MAX_REMAINING_SHARE
    else:
        reason = f"{near:.2g} of itself from a spinning state, which is stable"
        limit, turning = MAX_STATE_DISTANCE, arrival.state.rate / (2.0 * np.pi)
        evidence |= {
            "turns": math.copysign(RECORDED_TURNS, turning),
            "frequency": abs(turning),
            "frequency_error": arrival.state.residual * abs(turning),
        }
    text = f"{reason}: disturbances decay at {-rate:.4g}/T at least"
    name = STRAIGHT if arrival.state is None else arrival.kind
    return Verdict(
        name, text, evidence, arrival.time, margin=min(MAX_MARGIN, limit / max(near, 1e-9))
    )


def _first(
    model: Model, whole: Motion, close: CloseUp | None, settled: Settled | None
) -> Classified:
    """Classify a run without exponents, by its close-up if the samples of the whole are too few."""
    if close is not None:
        steady = None
        if settled and settled.kind == "steady":
            steady = max(settled.since, float(close.time[0]))
        coarse = coarse_verdict(
            *_signals(whole), steady_from=steady, axisymmetric=model.axisymmetric
        )
        if coarse is not None:
            return Classified(coarse, whole)
    motion = close.motion if close else whole
    since = settled.since if settled else None
    verdict = first_verdict(*_signals(motion), settled_from=since, axisymmetric=model.axisymmetric)
    return Classified(verdict, motion)


def _signals(motion: Motion) -> tuple[Instants, Shapes, Instants, Instants]:
    energy = motion.energetics.bending_energy
    return motion.time, motion.nodes, energy, motion.rotation_angle


def _with_exponents(
    model: Model,
    schedule: Schedule,
    judged: Classified,
    last: Array,
    watch: Watch,
    *,
    parting: bool,
) -> Classified:
    """Add Lyapunov exponents, and pairs of runs if `parting`, from the last state on."""
    if judged.verdict.name == STRAIGHT:
        return Classified(judged.verdict, judged.motion, without=_STRAIGHT_HAS)
    motion, duration = judged.motion, _duration(judged)
    exponents = _exponents(model, schedule, judged.verdict, last, duration, watch)
    if isinstance(exponents, NotFollowed):
        return Classified(judged.verdict, motion, without=exponents.reason)
    verdict = with_exponents(judged.verdict, exponents)
    if not parting or model.unwrapped:
        return Classified(verdict, motion, exponents)
    chaotic = exponents.value > SIGNIFICANCE_FACTOR * exponents.error
    watched = E_FOLDINGS / exponents.value if chaotic else PAIR_WINDOW_SHARE * duration
    pairs = finite_separation(
        model, model.positions(last), watched, progress=partial(watch, "pairs of nearby runs")
    )
    if isinstance(pairs, NotFollowed):
        return Classified(verdict, motion, exponents, without=pairs.reason)
    return Classified(verdict, motion, exponents, pairs)


def _exponents(
    model: Model, schedule: Schedule, first: Verdict, last: Array, duration: float, watch: Watch
) -> Lyapunov | NotFollowed:
    """Return exponents over a duration, or over a longer one if those do not decide."""
    exponents: Lyapunov | NotFollowed = NotFollowed("no time was given")
    for times in EXPONENT_WINDOW_FACTORS:
        exponents = lyapunov(
            model,
            last,
            times * duration,
            rtol=schedule.rtol,
            atol=schedule.atol,
            progress=_block_progress(watch),
        )
        if isinstance(exponents, NotFollowed) or first.late is None:
            break
        name = with_exponents(first, exponents).name
        if not (name == UNDECIDED and exponents.beyond_symmetry > 0.0):
            break
    return exponents


def _block_progress(watch: Watch) -> Callable[[int, int], None]:
    return lambda done, total: watch("Lyapunov exponents", done / total)


def _duration(judged: Classified) -> float:
    """Return the time over which exponents are averaged [T]."""
    window, evidence = judged.motion.late(judged.verdict.window_start), judged.verdict.evidence
    span = float(window.time[-1] - window.time[0])
    cycles = max(abs(evidence.get(name, 0.0)) / count for name, count in EXPONENT_WINDOW.items())
    return span / cycles if cycles > 0.0 else span
