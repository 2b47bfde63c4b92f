"""A stable state that a run has reached, and its motion."""

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from undula.analysis.observables.trajectory import Motion
from undula.analysis.states.records import Spinning
from undula.arrays import Array
from undula.models.model import Model
from undula.numerics.integration.system import RATES

#: Number of turns of the state in the record, and of samples in each.
RECORDED_TURNS, SAMPLES_PER_TURN = 2, 32


@dataclass(frozen=True)
class ReachedState:
    """A stable state that a run has reached.

    Attributes
    ----------
    kind : {"straight", "spinning"}
    time : float
        Time of the last sample of the run [T].
    distance : float
        Distance of its shape from the state, up to rotations, RMS over the arc length [L].
    relative : float
        The distance over the displacement of the state; for the straight state, the present
        inclination over the largest so far.
    leading_rate : float
        Largest growth rate of a disturbance of the state [1/T], negative.
    state : Spinning or None
        The state; None for the straight one.
    """

    kind: Literal["straight", "spinning"]
    time: float
    distance: float
    relative: float
    leading_rate: float
    state: Spinning | None = None

    def as_dict(self) -> dict[str, Any]:
        """Return all fields but the state in plain JSON types."""
        names = ("kind", "time", "distance", "relative", "leading_rate")
        return {name: getattr(self, name) for name in names}


def turned_by(model: Model, y: Array, angles: Array) -> Array:
    """Return unknowns rotated about the axis.

    Parameters
    ----------
    model : Model
        Model of the filament or chain.
    y : ndarray, shape (n,)
        Positions and multipliers.
    angles : ndarray, shape (m,)
        Angles [rad].

    Returns
    -------
    ndarray, shape (m, n)
    """
    across = model.equations.turning(y)[0]
    twice = model.equations.turning(across)[0]
    return np.asarray(
        y + np.sin(angles)[:, None] * across + (1.0 - np.cos(angles))[:, None] * twice
    )


def motion_of(arrival: ReachedState, model: Model, last: Array) -> Motion:
    """Return the trajectory of a reached state from the end of the run on.

    Parameters
    ----------
    arrival
        The state.
    model
        Of the run.
    last
        The last sample of the run, shape ``(n + RATES,)``.

    Returns
    -------
    Motion
    """
    if arrival.state is None:
        rows = np.zeros((2, last.size))
        rows[:, :-RATES] = model.straight_unknowns()
        rows[:, -RATES:] = last[-RATES:]
        return Motion.of(model, arrival.time - np.arange(2.0) / arrival.leading_rate, rows)
    state = arrival.state
    angles = (
        2.0
        * np.pi
        * np.arange(RECORDED_TURNS * SAMPLES_PER_TURN + 1)
        / SAMPLES_PER_TURN
        * np.sign(state.rate)
    )
    time, power = angles / state.rate, model.power(state.x)
    grown = np.stack([angles, time * power[0], time * power[1]], axis=1)
    rows = np.hstack([turned_by(model, state.unknowns, angles), last[-RATES:] + grown])
    return Motion.of(model, arrival.time + time, rows)
