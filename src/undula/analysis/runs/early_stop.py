"""Whether a run has come so near to a stable state that there is no need to wait for it.

A run to the solved state is watched for two of them:

- the straight state, once the motion is small and has fallen to half of what it was;
- a spinning one: as soon as the shape turns rather than changes, Newton's method takes it to one
  that only turns. The run has arrived when it is near that state, and the amplitude of its
  slowest disturbance has fallen as fast as the spectrum of the state says. A motion that goes to
  some other state, or round on a torus about this one, does not do that.

The run ends there if the state is stable. What is recorded of the run is its trajectory so far, to
which nothing is added; name and numbers are those of the state.
"""

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise, takewhile
from typing import Any, Literal, NamedTuple

import numpy as np

from undula.analysis.observables.alignment import aligned_distance
from undula.analysis.observables.shapes import displacement
from undula.analysis.observables.trajectory import Motion
from undula.analysis.parameters import FORCE
from undula.analysis.runs.settling import MotionRates
from undula.analysis.states.records import Spinning
from undula.analysis.states.relative_equilibrium import (
    Disturbances,
    TurningShapeAlone,
    turning_state,
)
from undula.arrays import Array, ComplexArray, Nodes
from undula.errors import InputError
from undula.models.initial_states import leading_rate
from undula.models.model import Model
from undula.numerics.continuation.newton import newton
from undula.numerics.integration.system import RATES

#: Change of a shape over its displacement, while it turns by a radian, up to which Newton's method
#: is tried, at a look, and again each time after twice as many looks.
RESTLESS, FIRST_TRIED = 0.6, 3
#: Largest distance of the present shape from the state, relative to the displacement of the state;
#: and the one up to which it is watched. What linear disturbances leave out is of its square.
NEAR, WATCHED = 0.25, 0.5
#: The slowest disturbance has to fall by this factor: by its swings alone, from nonlinearity, it
#: does so by up to a quarter. And so fast, between this part of the rate of the spectrum (it
#: would be 0 on a torus about the state) and, while it is not small, this multiple.
FALLS, SLOWEST, FASTEST, LITTLE = 1.5, 0.5, 2.0, 0.1
#: Looks over which it may do so: next to thresholds by little from one to the next.
REMEMBERED = 400
#: Largest RMS inclination [rad] of a motion that counts as small, for the same reason; and to which
#: part of the largest so far it has fallen, over three looks in a row.
SMALL, FALLEN, FALLING = 0.1, 0.5, 3
#: Steps between looks: a cycle of what rings takes some 30. Twice as many where a shape changes
#: more than it turns.
STEPS, STEPS_RESTLESS = 50, 100
#: The state is shown for so many turns, with so many samples each.
TURNS, SAMPLES = 2, 32


@dataclass(frozen=True)
class ReachedState:
    """A stable state that a run was left for.

    Attributes
    ----------
    kind : {"straight", "spinning"}
    time : float
        When it was left: the time of its last sample [T].
    distance : float
        How far its shape was from the state then, up to turns, RMS over the arc length [L].
    relative : float
        The same over the displacement of the state; of the straight one, the present inclination
        over the largest so far.
    leading_rate : float
        Largest growth rate of a disturbance of the state [1/T], negative.
    state : Spinning or None
        The state, unless it is the straight one.
    """

    kind: Literal["straight", "spinning"]
    time: float
    distance: float
    relative: float
    leading_rate: float
    state: Spinning | None = None

    def as_dict(self) -> dict[str, Any]:
        """Return it in plain JSON types."""
        names = ("kind", "time", "distance", "relative", "leading_rate")
        return {name: getattr(self, name) for name in names}


@dataclass(frozen=True)
class _Target:
    """A stable spinning state that a run may come to, with its slowest disturbance."""

    state: Spinning
    nodes: Nodes
    size: float
    slowest: ComplexArray


class _Seen(NamedTuple):
    """A look at a run: when, how far from the target, with how much of its slowest disturbance."""

    time: float
    distance: float
    size: float


@dataclass
class StateDetector:
    """Looks out for a state next to a run, and remembers what it has seen of it."""

    model: Model
    steps: int = STEPS
    largest: float = 0.0
    straight_waits: bool = True
    looks: int = 0
    due: float = FIRST_TRIED
    target: _Target | None = None
    before: deque[tuple[float, Array]] = field(default_factory=lambda: deque(maxlen=FIRST_TRIED))
    seen: deque[_Seen] = field(default_factory=lambda: deque(maxlen=REMEMBERED))

    def arrival(
        self, paces: Sequence[MotionRates], time: float, unknowns: Array
    ) -> ReachedState | None:
        """Return the state that a run has come to, None if it has to go on.

        Parameters
        ----------
        paces
            What was noted of the run at looks, the last one now.
        time, unknowns
            Of the last sample [T], shape ``(n,)``.
        """
        if not self.model.axisymmetric:
            return None
        self.largest, pace = max(self.largest, paces[-1].displacement), paces[-1]
        restless = _restlessness(pace)
        self.steps = STEPS_RESTLESS if restless > 1.0 and pace.displacement > SMALL else STEPS
        if self.straight_waits and len(paces) >= FALLING:
            found = self._straight([paces[k] for k in range(-FALLING, 0)], time, unknowns)
            if found:
                return found
        if self.model.dimension != 3:
            return None
        self.looks += 1
        self.before.append((time, unknowns))
        if self.target is None and restless <= RESTLESS and self.looks >= self.due:
            self._aim(unknowns, pace.turn_rate)
        if self.target is None:
            return None
        # What was seen before there was a target is held against it as well.
        while self.before:
            self.seen.append(self._look(self.target, *self.before.popleft()))
        return self._reached(self.target)

    def _straight(
        self, late: Sequence[MotionRates], time: float, unknowns: Array
    ) -> ReachedState | None:
        sizes = [pace.displacement for pace in late]
        part = sizes[-1] / self.largest if self.largest > 0.0 else 0.0
        falls = all(later < earlier for earlier, later in pairwise(sizes))
        if not (falls and sizes[-1] <= SMALL and part <= FALLEN):
            return None
        self.straight_waits = False  # its spectrum stays what it is
        rate = leading_rate(self.model)
        if rate >= 0.0:
            return None
        away = float(displacement(self._nodes(unknowns)))
        return ReachedState("straight", time, away, part, rate)

    def _aim(self, unknowns: Array, rate: float) -> None:
        """Solve for a state from the present shape."""
        self.due = 2 * self.looks
        problem = TurningShapeAlone(self.model, FORCE, unknowns, abs(rate))
        try:
            found = newton(problem, np.append(unknowns, rate), 0.0)
            if not found.converged:
                return
            y, rate = found.u[:-1], float(found.u[-1])
            around = Disturbances.of(self.model, y, rate)
        except (InputError, np.linalg.LinAlgError):
            return  # there is nothing but the straight state, or a matrix is singular
        state, nodes = turning_state(self.model, y, rate, around), self._nodes(y)
        size = float(displacement(nodes))
        if state.stable:
            self.target = _Target(state, nodes, size, around.amplitude(state.exponents[0]))
        elif float(aligned_distance(nodes, self._nodes(unknowns)).distance) <= WATCHED * size:
            self.due = np.inf  # this is the one, and nothing stays there

    def _look(self, target: _Target, time: float, unknowns: Array) -> _Seen:
        apart = aligned_distance(target.nodes, self._nodes(unknowns))
        turned = turned_by(self.model, unknowns, np.atleast_1d(apart.angle))[0]
        size = abs(complex(target.slowest @ (turned - target.state.unknowns)))
        return _Seen(time, float(apart.distance) / target.size, size)

    def _reached(self, target: _Target) -> ReachedState | None:
        """Return the target if the run comes to it."""
        now, rate = self.seen[-1], target.state.leading_rate
        if now.distance > NEAR:
            return None
        watched = takewhile(lambda one: one.distance <= WATCHED, reversed(self.seen))
        larger = next((one for one in watched if one.size >= FALLS * now.size), None)
        if larger is None:
            return None
        fall = math.log(larger.size / now.size) / (now.time - larger.time) if now.size else math.inf
        fastest = FASTEST if now.distance > LITTLE else math.inf
        if not SLOWEST <= -fall / rate <= fastest:
            return None
        return ReachedState(
            "spinning", now.time, now.distance * target.size, now.distance, rate, target.state
        )

    def _nodes(self, unknowns: Array) -> Nodes:
        return self.model.nodes(self.model.positions(unknowns))


def turned_by(model: Model, y: Array, angles: Array) -> Array:
    """Return positions and multipliers (n,) turned about the axis by angles (m,), shape (m, n)."""
    across = model.equations.turning(y)[0]
    twice = model.equations.turning(across)[0]
    return np.asarray(
        y + np.sin(angles)[:, None] * across + (1.0 - np.cos(angles))[:, None] * twice
    )


def motion_of(arrival: ReachedState, model: Model, last: Array) -> Motion:
    """Return how the state moves, from the end of the run on.

    Parameters
    ----------
    arrival
        What the run was left for.
    model
        What ran.
    last
        The last sample of the run, shape ``(n + RATES,)``.
    """
    if arrival.state is None:
        rows = np.zeros((2, last.size))
        rows[:, :-RATES] = model.straight_unknowns()
        rows[:, -RATES:] = last[-RATES:]
        return Motion.of(model, arrival.time - np.arange(2.0) / arrival.leading_rate, rows)
    state = arrival.state
    angles = 2.0 * np.pi * np.arange(TURNS * SAMPLES + 1) / SAMPLES * np.sign(state.rate)
    time, power = angles / state.rate, model.power(state.x)
    grown = np.stack([angles, time * power[0], time * power[1]], axis=1)
    rows = np.hstack([turned_by(model, state.unknowns, angles), last[-RATES:] + grown])
    return Motion.of(model, arrival.time + time, rows)


def _restlessness(pace: MotionRates) -> float:
    turned = abs(pace.turn_rate) * pace.displacement
    return pace.shape_speed / turned if turned > 0.0 else np.inf
