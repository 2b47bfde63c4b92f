"""Detection of a settled motion: one that repeats itself up to a rotation about the axis.

It is judged during a run on rates and shapes recorded by the integrator:

- at rest: the displacement has become a small part of the initial one;
- steady: the remaining change of the shape is less than the tolerance;
- periodic: at successive maxima of the elastic energy, or at every few of them, the shape recurs,
  and its remaining change is less than the tolerance.

The remaining change is the sum of a geometric decay measured on the run, so that a slow drift does
not count as settled. A change that grows or does not decay has not settled, unless it is below the
errors of the integration. A motion that leaves an unstable state more slowly than that looks
settled in every run; only the spectrum of the state shows the difference.
"""

import math
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import islice, takewhile

import numpy as np

from undula.analysis.observables.alignment import Compare, aligned_distance, fixed_distance
from undula.analysis.observables.shapes import displacement
from undula.analysis.runs.settled_motion import Settled
from undula.arrays import Array, Nodes

#: Tolerance of the recurrence, relative to the displacement [rtol]: a few periods accumulate about
#: a hundred local errors.
TOLERANCE_IN_RTOL = 100.0
#: Largest distance of a recurrence that errors of the integration make [rtol].
NOISE_IN_RTOL = 10.0
#: Number of recurrences, or turns, that have to agree.
REPETITIONS = 5
#: Number of recurrences (even) after which changes that neither grow nor add up count as noise also
#: if single ones are large: errors of steps that are in phase with the motion.
NOISE_REPETITIONS = 20
#: Largest factor of noise: of the largest change from the earlier half of the recurrences to the
#: later one, and of the accumulated change over the largest single one.
MAX_NOISE_GROWTH = 1.5
#: Largest number of maxima of the energy in one period.
MAX_PERIOD_MAXIMA = 8
#: Number of recorded rates that are stored.
MAX_STORED_RATES = 1000
#: Largest ratio of successive changes that counts as a decay.
MAX_DECAY_RATIO = 0.999
#: Least accumulated change, as a share of the sum of the changes, of a drift: noise has less.
MIN_DIRECTED_SHARE = 0.7
#: Largest inclination that round-off makes [rad].
ROUND_OFF_INCLINATION = 1e-12
#: Least motion of a shape in a period, relative to the displacement; one with less is steady.
MIN_SWING = 0.02


@dataclass(frozen=True)
class MotionRates:
    """Rates of the motion at an instant, in the norm of the integrator, see `error_norm`.

    Attributes
    ----------
    time : float
        Time [T].
    shape_speed : float
        Rate of change of the shape without rotation [rad/T].
    displacement : float
        Distance from straight [rad].
    turn_rate : float
        Rate of rotation about the axis [rad/T].
    """

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
    """Recorder of the motion of a run that detects a settled motion.

    Attributes
    ----------
    rtol : float
        Relative tolerance of the integration, the unit of the tolerances of the recurrence.
    start : float
        Displacement at the start in the norm of the integrator [rad]; 0 for a straight start.
    compare : callable
        Distance between shapes, up to rotations or without them.
    paces : deque of MotionRates
        The last recorded rates.
    returns : deque of (float, ndarray)
        Time [T] and nodes (N + 1, 3) [L] at the last maxima of the energy.
    seen : int
        Number of all maxima of the energy so far.
    """

    rtol: float
    start: float
    compare: Compare = aligned_distance
    paces: deque[MotionRates] = field(default_factory=lambda: deque(maxlen=MAX_STORED_RATES))
    returns: deque[tuple[float, Nodes]] = field(
        default_factory=lambda: deque(maxlen=(REPETITIONS + 1) * MAX_PERIOD_MAXIMA)
    )
    seen: int = 0

    def note(self, pace: MotionRates, returns: Sequence[tuple[float, Nodes]]) -> None:
        """Record the rates at a check, and times and shapes at energy maxima since the last one.

        Parameters
        ----------
        pace : MotionRates
            Rates at the check.
        returns : sequence of (float, ndarray)
            Time [T] and nodes (N + 1, 3) [L] of each maximum.
        """
        self.paces.append(pace)
        self.seen += len(returns)
        self.returns.extend(returns)

    def to_arrays(self) -> dict[str, Array]:
        """Return the record as arrays by name."""
        return {
            "seen": np.array(float(self.seen)),
            "paces": np.array([tuple(vars(pace).values()) for pace in self.paces]).reshape(-1, 4),
            "return_times": np.array([time for time, _ in self.returns]),
            "return_nodes": np.array([nodes for _, nodes in self.returns]),
        }

    def note_arrays(self, saved: Mapping[str, Array]) -> None:
        """Add a record from `to_arrays`."""
        self.seen = int(saved["seen"])
        self.paces.extend(MotionRates(*map(float, row)) for row in saved["paces"])
        times = map(float, saved["return_times"])
        self.returns.extend(zip(times, saved["return_nodes"], strict=True))

    def settled(self) -> Settled | None:
        """Return the settled motion, None if it has not settled."""
        if self.compare is fixed_distance:
            return self._at_rest() or self._resting() or self._periodic()
        return self._at_rest() or self._steady() or self._periodic()

    def _at_rest(self) -> Settled | None:
        start, last = self.start, self.paces[-1].displacement
        if start == 0.0:
            return (
                Settled("at rest", 0.0, 0.0, None, None) if last <= ROUND_OFF_INCLINATION else None
            )
        part = last / start
        if part > TOLERANCE_IN_RTOL * self.rtol:
            return None
        return Settled("at rest", self.paces[-1].time, part, None, None)

    def _steady(self) -> Settled | None:
        last = self.paces[-1]
        if last.turn is None:
            return None
        since = last.time - REPETITIONS * last.turn
        recent = list(takewhile(lambda pace: pace.time >= since, reversed(self.paces)))[::-1]
        if len(recent) < REPETITIONS or recent[0] is self.paces[0]:
            return None
        drifts = [pace.shape_speed * last.turn / pace.displacement for pace in recent]
        remaining = _remaining_change(
            drifts, (recent[-1].time - recent[0].time) / last.turn, self.rtol
        )
        if remaining is None:
            return None
        return Settled("steady", recent[0].time, remaining, None, last.turn)

    def _periodic(self) -> Settled | None:
        near = np.flatnonzero(self.returned() <= TOLERANCE_IN_RTOL * self.rtol) + 1
        for lag in near.tolist():  # mostly empty, so that most checks cost nothing
            times, shapes = self._repetitions(lag, REPETITIONS)
            if len(times) <= REPETITIONS:
                return None
            changes = self._changes(shapes[:-1], shapes[1:]).tolist()
            directed = self._changes(shapes[0], shapes[-1]) > MIN_DIRECTED_SHARE * sum(changes)
            remaining = _remaining_change(changes, len(changes) - 1.0, self.rtol, directed=directed)
            if remaining is None:
                remaining = self._noise_amplitude(lag)
            if remaining is None:
                continue
            # A motion with the shortest period recurs at its multiples as well.
            shortest = next(shorter for shorter in near.tolist() if lag % shorter == 0)
            period = (times[-1] - times[0]) / REPETITIONS * shortest / lag
            last = self.paces[-1]
            if last.shape_speed * period < MIN_SWING * last.displacement:
                return Settled("steady", times[0], remaining, None, last.turn)
            return Settled("periodic", times[0], remaining, period, last.turn)
        return None

    def _repetitions(self, lag: int, count: int) -> tuple[list[float], Array]:
        """Return times and shapes of the last `count` recurrences and the newest shape."""
        selected = list(islice(reversed(self.returns), 0, count * lag + 1, lag))[::-1]
        return [time for time, _ in selected], np.array([nodes for _, nodes in selected])

    def _noise_amplitude(self, lag: int) -> float | None:
        """Return the largest change of shapes that recur with noise, None if they drift or grow."""
        times, shapes = self._repetitions(lag, NOISE_REPETITIONS)
        if len(times) <= NOISE_REPETITIONS:
            return None
        early, late = np.split(self._changes(shapes[:-1], shapes[1:]), 2)
        change = float(max(np.max(early), np.max(late)))
        spread = float(np.max(self._changes(shapes[:-1], shapes[-1])))
        if np.max(late) > MAX_NOISE_GROWTH * np.max(early) or spread > MAX_NOISE_GROWTH * change:
            return None
        return max(spread, change) if max(spread, change) <= TOLERANCE_IN_RTOL * self.rtol else None

    def periods(self, duration: float) -> tuple[float | None, float]:
        """Return the shortest and the longest period of the motion.

        Parameters
        ----------
        duration : float
            Time of the run so far [T]; longer periods are ignored.

        Returns
        -------
        shortest : float or None
            [T]; None without a period.
        longest : float
            [T]; the duration without a period.
        """
        candidates = [self.paces[-1].turn] if self.paces else []
        if len(self.returns) > 2:
            first, last = self.returns[0][0], self.returns[-1][0]
            # Two maxima of the energy a beat.
            candidates.append(2.0 * (last - first) / (len(self.returns) - 1))
        periods = [period for period in candidates if period and period <= duration]
        return (min(periods), max(periods)) if periods else (None, duration)

    def turns_steadily(self) -> bool:
        """Return True if the shape hardly changes in a turn at the last recorded rates."""
        last = self.paces[-1] if self.paces else None
        if last is None or last.turn is None:
            return False
        return last.shape_speed * last.turn < MIN_SWING * last.displacement

    def returned(self) -> Array:
        """Return the distances of the newest shape from those at earlier maxima, newest first.

        Relative to the displacement, shape (k,) with k at most 8.
        """
        before = [nodes for _, nodes in islice(reversed(self.returns), 1, MAX_PERIOD_MAXIMA + 1)]
        if not before:
            return np.zeros(0)
        return self._changes(np.array(before), self.returns[-1][1])

    def _changes(self, earlier: Array, later: Array) -> Array:
        """Return the distances of shapes from later ones, relative to the displacement."""
        return np.asarray(self.compare(earlier, later).distance / displacement(later))

    def _resting(self) -> Settled | None:
        """Detect a shape that comes to rest: its speed over the decay rate of the speed remains."""
        recent = [pace for pace in self.paces if pace.time >= 0.5 * self.paces[-1].time]
        first, last = recent[0], recent[-1]
        span, displacement = last.time - first.time, last.displacement
        if span <= 0.0 or displacement == 0.0 or last.shape_speed >= first.shape_speed:
            return None
        fall = math.log(first.shape_speed / last.shape_speed) / span if last.shape_speed else 0.0
        remaining = last.shape_speed / (fall * displacement) if fall else 0.0
        if remaining > TOLERANCE_IN_RTOL * self.rtol:
            return None
        return Settled("still", last.time, remaining, None, None)


def _remaining_change(
    changes: Sequence[float], spans: float, rtol: float, *, directed: bool = False
) -> float | None:
    """Return the sum of all future changes, each a recurrence apart; None if it is too large.

    `spans` is the number of recurrences from the first to the last of `changes`; `directed` is True
    if they add up, so that even small ones are no noise.
    """
    if max(changes) > TOLERANCE_IN_RTOL * rtol:
        return None
    if max(changes) <= NOISE_IN_RTOL * rtol and not directed:
        return max(changes)
    if changes[-1] == 0.0:
        return 0.0
    ratio = float((changes[-1] / changes[0]) ** (1.0 / spans))
    if not ratio <= MAX_DECAY_RATIO:
        return None
    remaining = changes[-1] * ratio / (1.0 - ratio)
    return remaining if remaining <= TOLERANCE_IN_RTOL * rtol else None
