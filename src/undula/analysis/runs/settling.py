"""Whether a motion has settled: whether it repeats itself, up to a rotation about the axis.

Judged while a run goes on, from what the integrator notes:

- at rest: the displacement has become a small part of what it was;
- steady: the shape changes by less than the tolerance in all that is still to come;
- periodic: at successive maxima of the elastic energy the shape comes back, after every one or
  every few of them, to within the tolerance in all that is still to come.

"All that is still to come" is what is left of a geometric decay, measured on the run itself: a
motion that creeps is not taken for one that has arrived. What grows or does not decay has not
settled, unless it is below the errors of the integration. A motion that leaves an unstable state
more slowly than that cannot be told from a settled one by any run; its spectrum tells.
"""

import math
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import islice, takewhile
from typing import Literal

import numpy as np

from undula.analysis.observables.alignment import Compare, aligned_distance, fixed_distance
from undula.analysis.observables.shapes import displacement
from undula.arrays import Array, Nodes

#: Tolerance of the repetition, relative to the displacement, in units of rtol. A hundred local
#: errors are about what a few periods accumulate.
TOLERANCE_IN_RTOL = 100.0
#: Repetitions closer than so many rtol cannot be told from errors of the integration.
NOISE_IN_RTOL = 10.0
#: Repetitions, or turns, that have to agree.
REPETITIONS = 5
#: Repetitions after which changes that neither grow nor add up are known to be noise, for which
#: single ones may be too large: what the steps do in step with the motion (an even number).
MANY_REPETITIONS = 20
#: Changes that are larger by more than this factor in the later half of them grow; they lead
#: somewhere if they add up to more than this times the largest.
HOVERING = 1.5
#: Most maxima of the energy that one period may have.
MOST_MAXIMA = 8
#: Looks at the pace that are kept.
MOST_LOOKS = 1000
#: A decay by less than this a repetition is none.
SLOWEST_DECAY = 0.999
#: Changes that add up to this part of their sum or more have one direction: they are no noise.
DIRECTED = 0.7
#: An inclination [rad] that round-off alone makes.
UNMOVED = 1e-12
#: A shape that moves by less than this part of the displacement in a period is on its way to rest.
LEAST_SWING = 0.02


@dataclass(frozen=True)
class Settled:
    """A motion that repeats itself.

    Attributes
    ----------
    kind : {"at rest", "still", "steady", "periodic"}
        Straight, bent and unmoved, turning with one shape, or coming back to it.
    since : float
        Time from which on it does, to the tolerance [T].
    remaining : float
        What it may still change by, relative to the displacement.
    period : float or None
        Time after which the shape repeats up to rotation and reflection [T]; None if it is steady.
    turn : float or None
        Time of one turn about the axis [T]; None without rotation.
    """

    kind: Literal["at rest", "still", "steady", "periodic"]
    since: float
    remaining: float
    period: float | None
    turn: float | None


@dataclass(frozen=True)
class MotionRates:
    """How the system moved at an instant, measured as the integrator measures: see `size`."""

    time: float
    shape_speed: float
    displacement: float
    turn_rate: float

    @property
    def turn(self) -> float | None:
        """Time of one turn [T]; None without rotation."""
        return 2.0 * math.pi / abs(self.turn_rate) if self.turn_rate else None


@dataclass
class SettlingDetector:
    """Records how a run moves, and detects whether its motion has settled.

    Attributes
    ----------
    rtol : float
        Relative tolerance of the integration, which sets those of the verdict.
    start : float
        Displacement at the start, as the integrator measures it; 0 of one that is straight.
    compare : callable
        How shapes are compared.
    seen : int
        Maxima of the energy in all.
    """

    rtol: float
    start: float
    compare: Compare = aligned_distance
    paces: deque[MotionRates] = field(default_factory=lambda: deque(maxlen=MOST_LOOKS))
    returns: deque[tuple[float, Nodes]] = field(
        default_factory=lambda: deque(maxlen=(REPETITIONS + 1) * MOST_MAXIMA)
    )
    seen: int = 0

    def note(self, pace: MotionRates, returns: Sequence[tuple[float, Nodes]]) -> None:
        """Take down the pace at a look, and times and shapes at energy maxima since the last."""
        self.paces.append(pace)
        self.seen += len(returns)
        self.returns.extend(returns)

    def to_arrays(self) -> dict[str, Array]:
        """Return all that was taken down, as arrays."""
        return {
            "seen": np.array(float(self.seen)),
            "paces": np.array([tuple(vars(pace).values()) for pace in self.paces]).reshape(-1, 4),
            "return_times": np.array([time for time, _ in self.returns]),
            "return_nodes": np.array([nodes for _, nodes in self.returns]),
        }

    def note_arrays(self, saved: Mapping[str, Array]) -> None:
        """Take down what `to_arrays` gave."""
        self.seen = int(saved["seen"])
        self.paces.extend(MotionRates(*map(float, row)) for row in saved["paces"])
        times = map(float, saved["return_times"])
        self.returns.extend(zip(times, saved["return_nodes"], strict=True))

    def settled(self) -> Settled | None:
        """Return how the motion has settled, None if it has not."""
        if self.compare is fixed_distance:
            return self._at_rest() or self._resting() or self._periodic()
        return self._at_rest() or self._steady() or self._periodic()

    def _at_rest(self) -> Settled | None:
        start, last = self.start, self.paces[-1].displacement
        if start == 0.0:
            return Settled("at rest", 0.0, 0.0, None, None) if last <= UNMOVED else None
        part = last / start
        if part > TOLERANCE_IN_RTOL * self.rtol:
            return None
        return Settled("at rest", self.paces[-1].time, part, None, None)

    def _steady(self) -> Settled | None:
        last = self.paces[-1]
        if last.turn is None:
            return None
        since = last.time - REPETITIONS * last.turn
        late = list(takewhile(lambda pace: pace.time >= since, reversed(self.paces)))[::-1]
        if len(late) < REPETITIONS or late[0] is self.paces[0]:
            return None
        drifts = [pace.shape_speed * last.turn / pace.displacement for pace in late]
        remaining = _still_to_come(drifts, (late[-1].time - late[0].time) / last.turn, self.rtol)
        if remaining is None:
            return None
        return Settled("steady", late[0].time, remaining, None, last.turn)

    def _periodic(self) -> Settled | None:
        near = np.flatnonzero(self.returned() <= TOLERANCE_IN_RTOL * self.rtol) + 1
        for lag in near.tolist():  # mostly none, so that nearly all looks cost nothing
            times, shapes = self._repetitions(lag, REPETITIONS)
            if len(times) <= REPETITIONS:
                return None
            changes = self._changes(shapes[:-1], shapes[1:]).tolist()
            directed = self._changes(shapes[0], shapes[-1]) > DIRECTED * sum(changes)
            remaining = _still_to_come(changes, len(changes) - 1.0, self.rtol, directed=directed)
            if remaining is None:
                remaining = self._hovering(lag)
            if remaining is None:
                continue
            # What comes back after the shortest of them comes back after its multiples as well.
            shortest = next(each for each in near.tolist() if lag % each == 0)
            period = (times[-1] - times[0]) / REPETITIONS * shortest / lag
            last = self.paces[-1]
            if last.shape_speed * period < LEAST_SWING * last.displacement:
                return Settled("steady", times[0], remaining, None, last.turn)
            return Settled("periodic", times[0], remaining, period, last.turn)
        return None

    def _repetitions(self, lag: int, count: int) -> tuple[list[float], Array]:
        """Return times and shapes at so many repetitions back, and now, or as many as there are."""
        kept = list(islice(reversed(self.returns), 0, count * lag + 1, lag))[::-1]
        return [time for time, _ in kept], np.array([nodes for _, nodes in kept])

    def _hovering(self, lag: int) -> float | None:
        """Return how far shapes hover about one another that have long gone nowhere."""
        times, shapes = self._repetitions(lag, MANY_REPETITIONS)
        if len(times) <= MANY_REPETITIONS:
            return None
        early, late = np.split(self._changes(shapes[:-1], shapes[1:]), 2)
        change = float(max(np.max(early), np.max(late)))
        apart = float(np.max(self._changes(shapes[:-1], shapes[-1])))
        if np.max(late) > HOVERING * np.max(early) or apart > HOVERING * change:
            return None
        return max(apart, change) if max(apart, change) <= TOLERANCE_IN_RTOL * self.rtol else None

    def periods(self, duration: float) -> tuple[float | None, float]:
        """Return the shortest and the longest period at work, of those within a duration [T]."""
        candidates = [self.paces[-1].turn] if self.paces else []
        if len(self.returns) > 2:
            first, last = self.returns[0][0], self.returns[-1][0]
            # Two maxima of the energy a beat.
            candidates.append(2.0 * (last - first) / (len(self.returns) - 1))
        periods = [period for period in candidates if period and period <= duration]
        return (min(periods), max(periods)) if periods else (None, duration)

    def turns_steadily(self) -> bool:
        """Tell whether the shape hardly changes in a turn at the pace of the last look."""
        last = self.paces[-1] if self.paces else None
        if last is None or last.turn is None:
            return False
        return last.shape_speed * last.turn < LEAST_SWING * last.displacement

    def returned(self) -> Array:
        """Return how far the newest shape is from those at the maxima before, relative to it."""
        before = [nodes for _, nodes in islice(reversed(self.returns), 1, MOST_MAXIMA + 1)]
        if not before:
            return np.zeros(0)
        return self._changes(np.array(before), self.returns[-1][1])

    def _changes(self, earlier: Array, later: Array) -> Array:
        """Return by how much shapes change from one return to another, relative to their size."""
        return np.asarray(self.compare(earlier, later).distance / displacement(later))

    def _resting(self) -> Settled | None:
        """Judge a shape that stops: its speed over the rate at which that falls is to come."""
        late = [pace for pace in self.paces if pace.time >= 0.5 * self.paces[-1].time]
        first, last = late[0], late[-1]
        span, size = last.time - first.time, last.displacement
        if span <= 0.0 or size == 0.0 or last.shape_speed >= first.shape_speed:
            return None
        fall = math.log(first.shape_speed / last.shape_speed) / span if last.shape_speed else 0.0
        remaining = last.shape_speed / (fall * size) if fall else 0.0
        if remaining > TOLERANCE_IN_RTOL * self.rtol:
            return None
        return Settled("still", last.time, remaining, None, None)


def _still_to_come(
    changes: Sequence[float], spans: float, rtol: float, *, directed: bool = False
) -> float | None:
    """Return the sum of all changes to come, each a repetition apart; None if it is too large.

    `spans` is the number of repetitions from the first to the last of `changes`; `directed` tells
    that they add up, so that even small ones are no noise.
    """
    if max(changes) > TOLERANCE_IN_RTOL * rtol:
        return None
    if max(changes) <= NOISE_IN_RTOL * rtol and not directed:
        return max(changes)
    if changes[-1] == 0.0:
        return 0.0
    ratio = float((changes[-1] / changes[0]) ** (1.0 / spans))
    if not ratio <= SLOWEST_DECAY:
        return None
    remaining = changes[-1] * ratio / (1.0 - ratio)
    return remaining if remaining <= TOLERANCE_IN_RTOL * rtol else None
