"""A run judged: its verdict, the motion it was made on, and Lyapunov exponents if it takes them."""

from dataclasses import dataclass
from enum import Enum

from undula.analysis.lyapunov import Lyapunov, lyapunov
from undula.analysis.motion import Motion
from undula.analysis.regimes import (
    UNDECIDED,
    Verdict,
    first_verdict,
    settle_irregular,
    straight_verdict,
)
from undula.analysis.schedule import Schedule
from undula.analysis.settling import Settled
from undula.errors import InputError
from undula.models.model import Model

#: Maxima of the energy over which the Lyapunov exponents of an irregular motion are taken.
FOLLOWED_MAXIMA = 300
#: A motion without maxima, a steady one, is followed for so many turns.
FOLLOWED_TURNS = 50
#: What is not told from so long a time is told from a longer one, or not at all.
LENGTHS = (1, 8)


class Exponents(Enum):
    """When Lyapunov exponents are computed, which takes about three times as long as a run."""

    NEVER = "never"
    IF_IRREGULAR = "if the motion is irregular"
    ALWAYS = "always"


@dataclass(frozen=True)
class Judged:
    """A verdict, the motion that it was made on, and the exponents if they were computed."""

    verdict: Verdict
    motion: Motion
    exponents: Lyapunov | None


def judge(
    model: Model,
    schedule: Schedule,
    motions: tuple[Motion, Motion | None],
    settled: Settled | None,
    exponents: Exponents,
) -> Judged:
    """Judge a run by its whole motion and by the close-up of its end.

    Parameters
    ----------
    model, schedule
        What ran, and how exactly.
    motions
        The whole run, and its last periods at finer intervals if it needs them: these show all but
        a decay.
    settled
        How it repeats itself, if it was watched for that and does.
    exponents
        When to compute Lyapunov exponents.
    """
    whole, close = motions
    since = settled.since if settled else None
    straight = None if close is None else straight_verdict(whole.time, whole.nodes)
    motion = whole if close is None or straight is not None else close
    verdict = straight or _verdict(motion, since)
    irregular = verdict.late is not None and exponents is Exponents.IF_IRREGULAR
    if not irregular and exponents is not Exponents.ALWAYS:
        return Judged(verdict, motion, None)
    for times in LENGTHS:
        found = _exponents(model, schedule, motion, verdict, times)
        settled_verdict = settle_irregular(verdict, found)
        if settled_verdict.name != UNDECIDED:
            break
    return Judged(settled_verdict, motion, found)


def _verdict(motion: Motion, since: float | None) -> Verdict:
    return first_verdict(
        motion.time,
        motion.nodes,
        motion.energetics.bending_energy,
        motion.rotation_angle,
        settled_from=since,
    )


def _exponents(
    model: Model, schedule: Schedule, motion: Motion, verdict: Verdict, times: int
) -> Lyapunov:
    """Follow the motion from its last state, so many times as long as is mostly enough."""
    if verdict.name == "straight":
        raise InputError("a straight state has no motion to take Lyapunov exponents of")
    late = motion.late(verdict.window_start)
    span, evidence = float(late.time[-1] - late.time[0]), verdict.evidence
    beats = evidence.get("energy_maxima", 0.0)
    cycles = max(beats / FOLLOWED_MAXIMA, abs(evidence.get("turns", 0.0)) / FOLLOWED_TURNS)
    duration = times * (span / cycles if cycles > 0.0 else span)
    last = model.from_nodes(motion.nodes[-1])
    return lyapunov(model, last, duration, rtol=schedule.rtol, atol=schedule.atol)
