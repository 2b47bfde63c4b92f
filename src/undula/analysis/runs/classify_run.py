"""A run judged: its verdict, the motion it was made on, and Lyapunov exponents if it takes them."""

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
from undula.analysis.runs.early_stop import FALLEN, NEAR, TURNS, ReachedState, motion_of
from undula.analysis.runs.fine_tail import CloseUp
from undula.analysis.runs.finite_separation import FOLDS, Separation, finite_separation
from undula.analysis.runs.settling import Settled
from undula.arrays import Array, Instants, Shapes
from undula.errors import InputError
from undula.models.model import Model
from undula.numerics.integration.system import RATES

#: Maxima, beats and turns over which exponents are taken, whichever is the shortest.
FOLLOWED = {"maxima": 300.0, "periods": 150.0, "turns": 50.0}
#: What is not told from so long a time is told from a longer one, or not at all.
LENGTHS = (1, 8)
#: Pairs of regular motions are watched for this part of that time.
WATCHED = 1.0 / 15.0
_STRAIGHT_HAS = (
    "a motion that ends straight has the eigenvalues of the straight state for exponents: ask"
    " for its spectrum"
)


#: Called with what is computed of exponents and the part of it that is done, to show or end it.
Watch = Callable[[str, float], None]


class CutShortError(Exception):
    """Raised by a `Watch` that ends the exponents; its text says why."""


class Exponents(Enum):
    """When Lyapunov exponents are computed, which takes about three times as long as a run."""

    NEVER = "never"
    IF_IRREGULAR = "if the motion is irregular"
    ALWAYS = "always"


@dataclass(frozen=True)
class Classified:
    """A verdict with what it was made of.

    Attributes
    ----------
    verdict : Verdict
    motion : Motion
        The motion that it was made on.
    exponents : Lyapunov or None
        Lyapunov exponents, if they were asked for or needed.
    separation : Separation or None
        How fast runs from nearby states part, if exponents were asked for.
    without : str
        Why there are no exponents although they were asked for.
    """

    verdict: Verdict
    motion: Motion
    exponents: Lyapunov | None = None
    separation: Separation | None = None
    without: str = ""


def failed(motion: Motion, cause: str) -> Classified:
    """Return what is said of a run that failed: nothing, whatever it looks like."""
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
    """Judge a run by its whole motion and by the close-up of its end.

    Parameters
    ----------
    model, schedule
        What ran, and how exactly.
    motions
        The whole run, and its last periods at finer intervals if it needs them.
    errors
        What it got wrong.
    last
        Its last sample, shape ``(n + RATES,)``.
    come_to
        How it repeats itself, if it was watched for that and does, or the state that it was left
        for.
    exponents
        When to compute Lyapunov exponents.
    watch
        Told how far they are.
    """
    arrived = isinstance(reached, ReachedState)
    grounds = Grounds(model, schedule, motions[0], errors, last[:-RATES], known_stable=arrived)
    if isinstance(reached, ReachedState):
        judged = Classified(_arrived(reached), motion_of(reached, model, last))
        last = last if reached.state is None else np.append(reached.state.unknowns, last[-RATES:])
    else:
        judged = _first(model, *motions, reached)
    judged = _believed(grounds, judged)
    if exponents is Exponents.NEVER:
        return judged
    asked = exponents is Exponents.ALWAYS
    if not asked and judged.verdict.late is None:
        return judged
    try:
        found = _with_exponents(model, schedule, judged, last[:-RATES], watch, parting=asked)
    except (InputError, CutShortError) as error:
        return replace(judged, without=str(error))
    return _believed(grounds, found)


def _believed(grounds: Grounds, judged: Classified) -> Classified:
    return replace(judged, verdict=grounds.believed(judged.verdict, judged.motion))


def _arrived(arrival: ReachedState) -> Verdict:
    """Return the verdict on a run that was left for a state."""
    rate, near = arrival.leading_rate, arrival.relative
    evidence = {"distance": arrival.distance, "leading_rate": rate}
    if arrival.state is None:
        reason = f"small and falling, to {near:.2g} of what it was; the straight state is stable"
        limit = FALLEN
    else:
        reason = f"{near:.2g} of itself from a spinning state, which is stable"
        limit, turning = NEAR, arrival.state.rate / (2.0 * np.pi)
        evidence |= {
            "turns": math.copysign(TURNS, turning),
            "frequency": abs(turning),
            "frequency_error": arrival.state.residual * abs(turning),
        }
    told = f"{reason}: disturbances decay at {-rate:.4g}/T at least"
    name = STRAIGHT if arrival.state is None else arrival.kind
    return Verdict(
        name, told, evidence, arrival.time, margin=min(MAX_MARGIN, limit / max(near, 1e-9))
    )


def _first(
    model: Model, whole: Motion, close: CloseUp | None, settled: Settled | None
) -> Classified:
    """Judge a run without exponents, by its close-up only where the samples of the whole fail."""
    if close is not None:
        steady = None
        if settled and settled.kind == "steady":
            steady = max(settled.since, float(close.time[0]))
        told = coarse_verdict(*_signals(whole), steady_from=steady, axisymmetric=model.axisymmetric)
        if told is not None:
            return Classified(told, whole)
    motion = close.motion if close else whole
    since = settled.since if settled else None
    found = first_verdict(*_signals(motion), settled_from=since, axisymmetric=model.axisymmetric)
    return Classified(found, motion)


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
    """Follow the motion on from its last state, for longer if the first exponents do not tell."""
    if judged.verdict.name == STRAIGHT:
        return Classified(judged.verdict, judged.motion, without=_STRAIGHT_HAS)
    motion, duration = judged.motion, _duration(judged)
    found = _told(model, schedule, judged.verdict, last, duration, watch)
    if isinstance(found, NotFollowed):
        return Classified(judged.verdict, motion, without=found.reason)
    verdict = with_exponents(judged.verdict, found)
    if not parting or model.unwrapped:
        return Classified(verdict, motion, found)
    chaotic = found.value > SIGNIFICANCE_FACTOR * found.error
    watched = FOLDS / found.value if chaotic else WATCHED * duration
    pairs = finite_separation(
        model, model.positions(last), watched, progress=partial(watch, "pairs of nearby runs")
    )
    if isinstance(pairs, NotFollowed):
        return Classified(verdict, motion, found, without=pairs.reason)
    return Classified(verdict, motion, found, pairs)


def _told(
    model: Model, schedule: Schedule, first: Verdict, last: Array, duration: float, watch: Watch
) -> Lyapunov | NotFollowed:
    """Return exponents over a time, or over a longer one if those do not tell."""
    found: Lyapunov | NotFollowed = NotFollowed("no time was given")
    for times in LENGTHS:
        found = lyapunov(
            model,
            last,
            times * duration,
            rtol=schedule.rtol,
            atol=schedule.atol,
            progress=_of_blocks(watch),
        )
        if isinstance(found, NotFollowed) or first.late is None:
            break
        name = with_exponents(first, found).name
        if not (name == UNDECIDED and found.beyond_symmetry > 0.0):
            break
    return found


def _of_blocks(watch: Watch) -> Callable[[int, int], None]:
    return lambda done, total: watch("Lyapunov exponents", done / total)


def _duration(judged: Classified) -> float:
    """Return how long to follow a motion [T]."""
    late, seen = judged.motion.late(judged.verdict.window_start), judged.verdict.evidence
    span = float(late.time[-1] - late.time[0])
    cycles = max(abs(seen.get(name, 0.0)) / count for name, count in FOLLOWED.items())
    return span / cycles if cycles > 0.0 else span
