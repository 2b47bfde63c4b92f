"""A finished run: what was computed, how well, and what it shows."""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from typing import Any, Self

import numpy as np

from undula.analysis.observables.frequency import (
    Frequency,
    rotation_frequency,
    shape_frequency,
    shape_swings,
)
from undula.analysis.observables.planarity import planarity
from undula.analysis.observables.precession import Precession, precession
from undula.analysis.observables.shapes import azimuth, envelope, tip_height, tip_radius
from undula.analysis.observables.trajectory import Motion
from undula.analysis.regimes.lyapunov import Lyapunov
from undula.analysis.regimes.verdict import STRAIGHT, Verdict
from undula.analysis.run_settings import Ending, Schedule
from undula.analysis.runs.accuracy import Errors, Health, errors_of, health_of
from undula.analysis.runs.checkpoint import checkpoint
from undula.analysis.runs.classify_run import Classified, Exponents, Watch, failed, judge
from undula.analysis.runs.early_stop import ReachedState
from undula.analysis.runs.fine_tail import CloseUp, close_up
from undula.analysis.runs.finite_separation import Separation
from undula.analysis.runs.settling import Settled
from undula.analysis.runs.simulation import Simulation
from undula.analysis.runs.stop_rule import Observation
from undula.analysis.states.extrapolation import links_are_body
from undula.arrays import Array, Nodes
from undula.models.model import Model


@dataclass(frozen=True)
class Run:
    """The result of a time integration.

    Attributes
    ----------
    model : Model
    schedule : Schedule
    ending : Ending
        Why it ended; `cause` says more where it failed.
    motion : Motion
        The whole run at the asked samples.
    closer : CloseUp or None
        Its last periods at finer intervals; None where the samples are fine enough.
    observation : Observation or None
        How it repeats itself, and how long that was observed; None if it does not.
    arrival : ReachedState or None
        The state that a run to the solved one was left for: its verdict and figures are those of
        the state, its motion the trajectory so far.
    tight_from : float or None
        Time from which on its steps are more exact than was asked for [T].
    checkpoint : mapping of str to ndarray
        Arrays from which it can be resumed exactly.
    exponents : Exponents
        When Lyapunov exponents are computed.
    """

    model: Model
    schedule: Schedule
    ending: Ending
    cause: str
    motion: Motion
    closer: CloseUp | None
    observation: Observation | None
    arrival: ReachedState | None
    tight_from: float | None
    checkpoint: Mapping[str, Array]
    exponents: Exponents = Exponents.IF_IRREGULAR

    @classmethod
    def of(cls, simulation: Simulation, exponents: Exponents = Exponents.IF_IRREGULAR) -> Self:
        """Return the result that a simulation has come to so far."""
        seen = simulation.observation  # the last step may lie beyond the samples
        return cls(
            model=simulation.model,
            schedule=simulation.schedule,
            ending=simulation.ending,
            cause=simulation.cause,
            motion=Motion.of(simulation.model, simulation.times, simulation.states),
            closer=close_up(simulation),
            observation=seen.from_at_most(simulation.time) if seen else None,
            arrival=simulation.arrival,
            tight_from=simulation.tight_from,
            checkpoint=checkpoint(simulation),
            exponents=exponents,
        )

    @property
    def settled(self) -> Settled | None:
        """How it repeats itself, if it was watched for that and does."""
        return None if self.observation is None else self.observation.settled

    def judged(self, watch: Watch) -> Self:
        """Return the run, judged at once: `watch` is told how far exponents are."""
        if "_judged" not in vars(self):
            vars(self)["_judged"] = self._judge(watch)  # which is where it is kept
        return self

    @cached_property
    def _judged(self) -> Classified:
        return self._judge(lambda *_: None)

    def _judge(self, watch: Watch) -> Classified:
        if self.ending is Ending.FAILED:
            return failed(self.motion, self.cause)
        return judge(
            self.model,
            self.schedule,
            (self.motion, self.closer),
            self.errors,
            self.checkpoint["states"][-1],
            self.arrival or self.settled,
            self.exponents,
            watch,
        )

    @cached_property
    def errors(self) -> Errors:
        """What it got wrong, by what is known to be kept: a part of its health."""
        return errors_of(self.motion)

    @cached_property
    def health(self) -> Health:
        """How well it was computed."""
        return health_of(self.model, self.motion, self.errors, self.checkpoint)

    def since(self, time: float) -> Motion:
        """Return the part of the run from a time on at intervals that a motion is named from."""
        return (self.motion if self.closer is None else self.closer.motion).late(time)

    @property
    def verdict(self) -> Verdict:
        """What the run ends in."""
        return self._judged.verdict

    @property
    def close_up(self) -> Motion | None:
        """Its last periods at finer intervals, to be drawn, computed when somebody asks.

        None where the samples are fine enough, or where they show that it returns to straight.
        """
        straight = self.verdict.name == STRAIGHT and self._judged.motion is self.motion
        return None if self.closer is None or straight else self.closer.motion

    @property
    def lyapunov(self) -> Lyapunov | None:
        """Lyapunov exponents, if they were asked for or it took them to tell what the motion is."""
        return self._judged.exponents

    @property
    def without_lyapunov(self) -> str:
        """Why there are no exponents, or no pairs of runs, although they were asked for."""
        return self._judged.without

    @property
    def separation(self) -> Separation | None:
        """How fast runs from nearby states part, if Lyapunov exponents were asked for."""
        return self._judged.separation

    @cached_property
    def window(self) -> Motion:
        """The late part of the run that the verdict and all figures below are about."""
        return self._judged.motion.late(self.verdict.window_start)

    @cached_property
    def shown(self) -> Motion:
        """The same part at intervals that are fine enough to follow single periods."""
        if self.arrival is not None:
            return self.window
        return (self.close_up or self.motion).late(self.verdict.window_start)

    @property
    def last_shape(self) -> Nodes:
        """Nodes (N + 1, 3) at its end [L]; those of the state that it was left for."""
        return np.asarray((self.motion if self.arrival is None else self.window).nodes[-1])

    @cached_property
    def frequency(self) -> Frequency | None:
        """Frequency of the whole motion [cycles/T], positive; None for a straight one.

        The sense of turning is that of the `rotation_frequency`.
        """
        found = self.verdict.evidence
        # The verdict has looked for it in the same window.
        if "frequency" not in found or self.verdict.name == STRAIGHT:
            return None
        return Frequency(found["frequency"], found["frequency_error"])

    @cached_property
    def rotation_frequency(self) -> Frequency | None:
        """Frequency of turning about the axis, positive from x to y [cycles/T]."""
        whole = self.frequency
        if self.verdict.name == "spinning" and whole is not None:
            turns = self.verdict.evidence["turns"]
            return replace(whole, value=math.copysign(whole.value, turns))  # it is the same
        if self.verdict.name == STRAIGHT:
            return None
        late = self.window
        return rotation_frequency(late.time, late.rotation_angle)

    @cached_property
    def shape_frequency(self) -> Frequency | None:
        """How often the shape repeats up to rotation and reflection [cycles/T]."""
        if self.verdict.name == STRAIGHT:
            return None
        late = self.window
        if not shape_swings(late.nodes, late.energetics.bending_energy):
            return None
        late = self.shown
        return shape_frequency(late.time, late.nodes, late.energetics.bending_energy)

    @cached_property
    def precession(self) -> Precession | None:
        """How the motion goes round the axis; None for a straight one, or one without maxima."""
        late = self.shown
        return None if self.verdict.name == STRAIGHT else precession(late.time, late.nodes)

    def figures(self) -> dict[str, Any]:
        """Return what was measured on the window, in plain JSON types."""
        late = self.window
        shape = self.verdict.evidence.get("planarity")
        return {
            **_told("frequency", self.frequency),
            **_told("rotation_frequency", self.rotation_frequency),
            **_told("shape_frequency", self.shape_frequency),
            "bending_energy": asdict(envelope(late.energetics.bending_energy)),
            "tip_radius": asdict(envelope(tip_radius(late.nodes))),
            "tip_height": asdict(envelope(tip_height(late.nodes))),
            "planarity": planarity(late.nodes) if shape is None else shape,
        }

    def summary(self) -> dict[str, Any]:
        """Return the answer of the run in plain JSON types."""
        late = self.window
        units, force = self.model.units, self.model.load.force
        further = units.force_in(force)
        return {
            "status": self.ending.value,
            "cause": self.cause or None,
            "units": units.names(),
            "force": force,
            **({"force_in": further} if further else {}),
            "links": self.model.links,
            "error_of": "body" if links_are_body(self.model) else "links",
            "verdict": self.verdict.name,
            "reason": self.verdict.reason,
            "evidence": self.verdict.evidence,
            "margin": self.verdict.margin,
            "longer": self.verdict.longer,
            "lyapunov": self._exponents(),
            "without_lyapunov": self.without_lyapunov or None,
            **self.figures(),
            "winding_angle": float(azimuth(self.motion.nodes)[-1]),
            "precession": self._precession(),
            "time": float(self.motion.time[-1]),
            "window": [float(late.time[0]), float(late.time[-1])],
            "settled": self.observation.as_dict() if self.observation else None,
            "settled_from": self.settled.since if self.settled else None,
            "solved": self.arrival.as_dict() if self.arrival else None,
            "tight_from": self.tight_from,
            **asdict(self.health),
        }

    def _exponents(self) -> dict[str, Any] | None:
        if self.lyapunov is None:
            return None
        parting = self.separation and self.separation.as_dict()
        return {**self.lyapunov.as_dict(), "finite_separation": parting}

    def _precession(self) -> dict[str, float] | None:
        """Return how a body that is held in one direction goes round, which others do evenly."""
        if self.model.axisymmetric or self.precession is None:
            return None
        return asdict(self.precession)

    def __str__(self) -> str:
        """One line: what it ends in, at which frequency, and how well it was computed."""
        frequency = self.frequency
        rate = ""
        if frequency:
            links = f"{self.model.links} links, "
            of_links = "" if links_are_body(self.model) else links
            rate = f" at {frequency.value:.6g} /T ({of_links}to {frequency.error:.1g})"
        return (
            f"{self.verdict.name}{rate}, {self.ending.value} at {self.motion.time[-1]:.4g} T"
            f" (power balance to {self.health.power_balance_error:.1g},"
            f" length to {self.health.length_error:.1g}, {self.health.steps} steps)"
        )


def _told(name: str, found: Frequency | None) -> dict[str, float | None]:
    value, error = (None, None) if found is None else (float(found.value), float(found.error))
    return {name: value, f"{name}_error": error}
