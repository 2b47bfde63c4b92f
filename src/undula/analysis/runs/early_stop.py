"""Detection of a stable state next to a run, at which a run until "solved" ends.

Two kinds of states are detected:

- the straight state, once the motion is small and has fallen to half of its maximum;
- a spinning state: as soon as the shape rotates rather than changes, Newton's method solves for a
  steadily rotating shape. The run has reached it when the shape is near, and the amplitude of the
  slowest disturbance has decayed at the rate of the spectrum of the state. A motion towards another
  state, or on a torus about this one, fails this test.

The run ends if the state is stable. Its record is the trajectory so far, to which nothing is added;
name and numbers are those of the state.
"""

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise, takewhile
from typing import NamedTuple

import numpy as np

from undula.analysis.linear.leading_rate import leading_rate
from undula.analysis.observables.alignment import aligned_distance
from undula.analysis.observables.shapes import displacement
from undula.analysis.parameters import FORCE
from undula.analysis.runs.reached_state import ReachedState, turned_by
from undula.analysis.runs.settling import MotionRates
from undula.analysis.states.records import Spinning
from undula.analysis.states.relative_equilibrium import (
    Disturbances,
    TurningShapeAlone,
    turning_state,
)
from undula.arrays import Array, ComplexArray, Nodes
from undula.errors import InputError
from undula.models.model import Model
from undula.numerics.continuation.newton import newton

#: Largest change of the shape while it rotates by a radian, relative to its displacement, at which
#: Newton's method is tried; and number of the first check with an attempt, which doubles each time.
MAX_SHAPE_CHANGE_PER_RADIAN, FIRST_ATTEMPT = 0.6, 3
#: Largest distance of the shape from a reached state, and of one that is observed, relative to the
#: displacement of the state. Nonlinear effects are of the order of its square.
MAX_STATE_DISTANCE, MAX_OBSERVED_DISTANCE = 0.25, 0.5
#: Least factor by which the slowest disturbance has decayed (nonlinear oscillations alone reach a
#: factor of 1.25); least and largest ratio of its decay rate to that of the spectrum (0 on a torus
#: about the state), the latter only beyond the last number, a distance over the displacement.
MIN_AMPLITUDE_FALL, MIN_RATE_RATIO, MAX_RATE_RATIO, SMALL_DISTANCE = 1.5, 0.5, 2.0, 0.1
#: Number of stored observations: next to thresholds the decay from one to the next is small.
MAX_OBSERVATIONS = 400
#: Largest RMS inclination [rad] of a small motion, as nonlinear effects are of its square; largest
#: remaining share of the maximum so far, and number of successive checks with a decrease.
SMALL_INCLINATION, MAX_REMAINING_SHARE, FALLING_CHECKS = 0.1, 0.5, 3
#: Number of steps between checks (a cycle of a ringing motion takes about 30), and for a shape that
#: changes more than it rotates.
STEPS_PER_CHECK, STEPS_PER_CHECK_UNSTEADY = 50, 100


@dataclass(frozen=True)
class _Target:
    """A stable spinning state that a run may reach, with its slowest disturbance."""

    state: Spinning
    nodes: Nodes
    size: float
    slowest: ComplexArray


class _TargetObservation(NamedTuple):
    """Time, relative distance from the target, and amplitude of its slowest disturbance."""

    time: float
    distance: float
    size: float


@dataclass
class StateDetector:
    """Detector of a stable state next to a run.

    Attributes
    ----------
    model : Model
    steps : int
        Number of steps until the next check.
    largest : float
        Largest displacement of the run so far, in the norm of the integrator [rad].
    straight_waits : bool
        True until the stability of the straight state has been computed.
    looks : int
        Number of checks for a spinning state.
    due : float
        Number of the check with the next attempt to solve for a spinning state.
    target : _Target or None
        The stable spinning state that is observed.
    before : deque of (float, ndarray)
        Times and unknowns of the last checks before there was a target.
    seen : deque of _TargetObservation
        Observations of the target.
    """

    model: Model
    steps: int = STEPS_PER_CHECK
    largest: float = 0.0
    straight_waits: bool = True
    looks: int = 0
    due: float = FIRST_ATTEMPT
    target: _Target | None = None
    before: deque[tuple[float, Array]] = field(default_factory=lambda: deque(maxlen=FIRST_ATTEMPT))
    seen: deque[_TargetObservation] = field(default_factory=lambda: deque(maxlen=MAX_OBSERVATIONS))

    def arrival(
        self, paces: Sequence[MotionRates], time: float, unknowns: Array
    ) -> ReachedState | None:
        """Return the state that the run has reached.

        Parameters
        ----------
        paces
            Rates of the run at its checks, up to the present one.
        time
            Time of the last sample [T].
        unknowns
            Unknowns of the last sample, shape ``(n,)``.

        Returns
        -------
        ReachedState or None
            None if the run has to continue.
        """
        if not self.model.axisymmetric:
            return None
        self.largest, pace = max(self.largest, paces[-1].displacement), paces[-1]
        unsteadiness = _unsteadiness(pace)
        self.steps = (
            STEPS_PER_CHECK_UNSTEADY
            if unsteadiness > 1.0 and pace.displacement > SMALL_INCLINATION
            else STEPS_PER_CHECK
        )
        if self.straight_waits and len(paces) >= FALLING_CHECKS:
            reached = self._straight([paces[k] for k in range(-FALLING_CHECKS, 0)], time, unknowns)
            if reached:
                return reached
        if self.model.dimension != 3:
            return None
        self.looks += 1
        self.before.append((time, unknowns))
        if (
            self.target is None
            and unsteadiness <= MAX_SHAPE_CHANGE_PER_RADIAN
            and self.looks >= self.due
        ):
            self._solve_for_target(unknowns, pace.turn_rate)
        if self.target is None:
            return None
        # The checks before there was a target count as observations of it.
        while self.before:
            self.seen.append(self._observe(self.target, *self.before.popleft()))
        return self._reached(self.target)

    def _straight(
        self, rates: Sequence[MotionRates], time: float, unknowns: Array
    ) -> ReachedState | None:
        sizes = [pace.displacement for pace in rates]
        share = sizes[-1] / self.largest if self.largest > 0.0 else 0.0
        falls = all(later < earlier for earlier, later in pairwise(sizes))
        if not (falls and sizes[-1] <= SMALL_INCLINATION and share <= MAX_REMAINING_SHARE):
            return None
        self.straight_waits = False  # its spectrum does not change
        rate = leading_rate(self.model)
        if rate >= 0.0:
            return None
        distance = float(displacement(self._nodes(unknowns)))
        return ReachedState("straight", time, distance, share, rate)

    def _solve_for_target(self, unknowns: Array, turn_rate: float) -> None:
        """Solve for a state from the present shape."""
        self.due = 2 * self.looks
        problem = TurningShapeAlone(self.model, FORCE, unknowns, abs(turn_rate))
        try:
            solution = newton(problem, np.append(unknowns, turn_rate), 0.0)
            if not solution.has_converged:
                return
            y, turn_rate = solution.u[:-1], float(solution.u[-1])
            disturbances = Disturbances.of(self.model, y, turn_rate)
        except (InputError, np.linalg.LinAlgError):
            return  # only the straight state exists, or a matrix is singular
        state, nodes = turning_state(self.model, y, turn_rate, disturbances), self._nodes(y)
        size = float(displacement(nodes))
        if state.stable:
            self.target = _Target(state, nodes, size, disturbances.amplitude(state.exponents[0]))
        elif (
            float(aligned_distance(nodes, self._nodes(unknowns)).distance)
            <= MAX_OBSERVED_DISTANCE * size
        ):
            self.due = np.inf  # the run is at an unstable state

    def _observe(self, target: _Target, time: float, unknowns: Array) -> _TargetObservation:
        alignment = aligned_distance(target.nodes, self._nodes(unknowns))
        turned = turned_by(self.model, unknowns, np.atleast_1d(alignment.angle))[0]
        amplitude = abs(complex(target.slowest @ (turned - target.state.unknowns)))
        return _TargetObservation(time, float(alignment.distance) / target.size, amplitude)

    def _reached(self, target: _Target) -> ReachedState | None:
        """Return the target if the run has reached it."""
        now, rate = self.seen[-1], target.state.leading_rate
        if now.distance > MAX_STATE_DISTANCE:
            return None
        observed = takewhile(
            lambda item: item.distance <= MAX_OBSERVED_DISTANCE, reversed(self.seen)
        )
        earlier = next(
            (item for item in observed if item.size >= MIN_AMPLITUDE_FALL * now.size), None
        )
        if earlier is None:
            return None
        fall = (
            math.log(earlier.size / now.size) / (now.time - earlier.time) if now.size else math.inf
        )
        fastest = MAX_RATE_RATIO if now.distance > SMALL_DISTANCE else math.inf
        if not MIN_RATE_RATIO <= -fall / rate <= fastest:
            return None
        return ReachedState(
            "spinning", now.time, now.distance * target.size, now.distance, rate, target.state
        )

    def _nodes(self, unknowns: Array) -> Nodes:
        return self.model.nodes(self.model.positions(unknowns))


def _unsteadiness(pace: MotionRates) -> float:
    turned = abs(pace.turn_rate) * pace.displacement
    return pace.shape_speed / turned if turned > 0.0 else np.inf
