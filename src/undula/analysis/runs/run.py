"""Result of a run: trajectory, accuracy, verdict and measured quantities."""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar, Self

import numpy as np
import xarray as xr

from undula.analysis.observables.frequency import (
    Frequency,
    frequency_fields,
    rotation_frequency,
    shape_frequency,
    shape_swings,
)
from undula.analysis.observables.precession import Precession, precession
from undula.analysis.observables.shapes import azimuth
from undula.analysis.observables.trajectory import Motion
from undula.analysis.record import Fact, Record, function_by_name
from undula.analysis.regimes.lyapunov import Lyapunov
from undula.analysis.regimes.verdict import STRAIGHT, Verdict
from undula.analysis.run_settings import Ending, Schedule
from undula.analysis.runs.accuracy import Errors, Health, errors_of, health_of
from undula.analysis.runs.checkpoint import checkpoint
from undula.analysis.runs.classify_run import Classified, Exponents, Watch, failed, judge
from undula.analysis.runs.fine_tail import CloseUp, close_up
from undula.analysis.runs.finite_separation import Separation
from undula.analysis.runs.reached_state import ReachedState
from undula.analysis.runs.run_facts import exponents_of, extents_of, facts_of, line_of
from undula.analysis.runs.settled_motion import Settled
from undula.analysis.runs.simulation import Simulation
from undula.analysis.runs.stop_rule import Observation
from undula.analysis.states.extrapolation import links_are_body
from undula.arrays import Array, Nodes
from undula.models.model import Model


@dataclass(frozen=True, repr=False)
class Run(Record):
    """The result of a time integration.

    Attributes
    ----------
    model : Model
    schedule : Schedule
        Times, samples and tolerances as requested.
    ending : Ending
        Reason for the end of the run.
    cause : str
        Cause and remedy of a failure.
    motion : Motion
        Trajectory of the whole run at the requested samples.
    closer : CloseUp or None
        The last periods at finer intervals; None if the samples are fine enough.
    observation : Observation or None
        Observation of the settled motion; None if it has not settled.
    arrival : ReachedState or None
        The stable state that the run has reached, which has the verdict and the measured
        quantities; the motion is the trajectory so far.
    tight_from : float or None
        Time from which on the steps are more exact than requested [T].
    checkpoint : mapping of str to ndarray
        Arrays from which the run is resumed exactly.
    exponents : Exponents
        Condition for computing Lyapunov exponents.

    Examples
    --------
    >>> import undula as un
    >>> model = un.Filament(4, load=un.TipLoad(0.0))
    >>> un.integrate(model, un.planar(model, 0.1), until=0.001, samples=3).ending.value
    'done'
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

    _figure: ClassVar[str] = "undula.views.records.runs:run_figure"

    @classmethod
    def of(cls, simulation: Simulation, exponents: Exponents = Exponents.IF_IRREGULAR) -> Self:
        """Return the result of a simulation so far."""
        observation = simulation.observation  # the last step may lie beyond the samples
        return cls(
            model=simulation.model,
            schedule=simulation.schedule,
            ending=simulation.ending,
            cause=simulation.cause,
            motion=Motion.of(simulation.model, simulation.times, simulation.states),
            closer=close_up(simulation),
            observation=observation.from_at_most(simulation.time) if observation else None,
            arrival=simulation.arrival,
            tight_from=simulation.tight_from,
            checkpoint=checkpoint(simulation),
            exponents=exponents,
        )

    @property
    def settled(self) -> Settled | None:
        """The settled motion; None if the run has not settled or was not watched for it."""
        return None if self.observation is None else self.observation.settled

    def judged(self, watch: Watch) -> Self:
        """Return the run after its classification; `watch` is the callback of the exponents."""
        if "_judged" not in vars(self):
            vars(self)["_judged"] = self._judge(watch)  # the value of the cached property
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
        """Errors in conserved quantities, a part of the health."""
        return errors_of(self.motion)

    @cached_property
    def health(self) -> Health:
        """Errors and effort of the run."""
        return health_of(self.model, self.motion, self.errors, self.checkpoint)

    def since(self, time: float) -> Motion:
        """Return the motion from a time [T] on, at intervals fine enough for a classification."""
        return (self.motion if self.closer is None else self.closer.motion).late(time)

    @property
    def verdict(self) -> Verdict:
        """Classification of the final motion."""
        return self._judged.verdict

    @property
    def close_up(self) -> Motion | None:
        """Motion of the last periods at finer intervals; None if not needed, or if straight."""
        straight = self.verdict.name == STRAIGHT and self._judged.motion is self.motion
        return None if self.closer is None or straight else self.closer.motion

    @property
    def lyapunov(self) -> Lyapunov | None:
        """Lyapunov exponents, if they were requested or the classification needed them."""
        return self._judged.exponents

    @property
    def without_lyapunov(self) -> str:
        """Reason for missing exponents, or pairs of runs, that were requested."""
        return self._judged.without

    @property
    def separation(self) -> Separation | None:
        """Divergence of runs from nearby states, if Lyapunov exponents were requested."""
        return self._judged.separation

    @cached_property
    def window(self) -> Motion:
        """The late window of the verdict and of all measured quantities."""
        return self._judged.motion.late(self.verdict.window_start)

    @cached_property
    def shown(self) -> Motion:
        """The late window at intervals fine enough to resolve single periods."""
        if self.arrival is not None:
            return self.window
        return (self.close_up or self.motion).late(self.verdict.window_start)

    @property
    def last_shape(self) -> Nodes:
        """Nodes (N + 1, 3) at the end [L], or those of the reached state."""
        return np.asarray((self.motion if self.arrival is None else self.window).nodes[-1])

    @cached_property
    def frequency(self) -> Frequency | None:
        """Frequency of the whole motion [cycles/T], positive; None for a straight one."""
        evidence = self.verdict.evidence
        # The classification has measured it in the same window.
        if "frequency" not in evidence or self.verdict.name == STRAIGHT:
            return None
        return Frequency(evidence["frequency"], evidence["frequency_error"])

    @cached_property
    def rotation_frequency(self) -> Frequency | None:
        """Frequency of rotation about the axis, positive from x to y [cycles/T]."""
        whole = self.frequency
        if self.verdict.name == "spinning" and whole is not None:
            turns = self.verdict.evidence["turns"]
            return replace(whole, value=math.copysign(whole.value, turns))
        if self.verdict.name == STRAIGHT:
            return None
        window = self.window
        return rotation_frequency(window.time, window.rotation_angle)

    @cached_property
    def shape_frequency(self) -> Frequency | None:
        """Frequency of the shape up to rotations and reflections [cycles/T]."""
        if self.verdict.name == STRAIGHT:
            return None
        late = self.window
        if not shape_swings(late.nodes, late.energetics.bending_energy):
            return None
        late = self.shown
        return shape_frequency(late.time, late.nodes, late.energetics.bending_energy)

    @cached_property
    def precession(self) -> Precession | None:
        """Precession of the motion; None for a straight one, or without maxima."""
        late = self.shown
        return None if self.verdict.name == STRAIGHT else precession(late.time, late.nodes)

    def figures(self) -> dict[str, Any]:
        """Return the quantities measured in the window, in plain JSON types."""
        return {
            **frequency_fields("frequency", self.frequency),
            **frequency_fields("rotation_frequency", self.rotation_frequency),
            **frequency_fields("shape_frequency", self.shape_frequency),
            **extents_of(self.window, self.verdict.evidence.get("planarity")),
        }

    def summary(self) -> dict[str, Any]:
        """Return all results in plain JSON types, as docs/output.md lists them."""
        window = self.window
        units, force = self.model.units, self.model.load.force
        other_units = units.force_in(force)
        turning = None if self.model.axisymmetric else self.precession
        return {
            "status": self.ending.value,
            "cause": self.cause or None,
            "units": units.names(),
            "force": force,
            **({"force_in": other_units} if other_units else {}),
            "links": self.model.links,
            "error_of": "body" if links_are_body(self.model) else "links",
            "verdict": self.verdict.name,
            "reason": self.verdict.reason,
            "evidence": self.verdict.evidence,
            "margin": self.verdict.margin,
            "longer": self.verdict.longer,
            "lyapunov": exponents_of(self.lyapunov, self.separation),
            "without_lyapunov": self.without_lyapunov or None,
            **self.figures(),
            "winding_angle": float(azimuth(self.motion.nodes)[-1]),
            "precession": asdict(turning) if turning else None,
            "time": float(self.motion.time[-1]),
            "window": [float(window.time[0]), float(window.time[-1])],
            "settled": self.observation.as_dict() if self.observation else None,
            "settled_from": self.settled.since if self.settled else None,
            "solved": self.arrival.as_dict() if self.arrival else None,
            "tight_from": self.tight_from,
            **asdict(self.health),
        }

    def facts(self) -> dict[str, Fact]:
        """Return verdict, frequency, energy, extents and accuracy by name."""
        return facts_of(self.summary())

    def to_xarray(self) -> xr.Dataset:
        """Return the run as a dataset over time, node and axis, as `dataset_of` does."""
        dataset: xr.Dataset = function_by_name("undula.analysis.runs.dataset:dataset_of")(self)
        return dataset

    def save(self, path: Path | str, *, overwrite: bool = False) -> None:
        """Store the run as `undula run` does; `undula.load` and all commands read it."""
        store = function_by_name("undula.storage.record_file:save_run")
        store(Path(path), self, overwrite=overwrite)

    def movie(self, path: Path | str, *, frames: int = 240, fps: int = 30) -> Path:
        """Make an MP4 movie of the run, as `undula.views.movie` does; return its name."""
        draw = function_by_name("undula.views.run.movie:movie")
        return Path(draw(self.to_xarray(), path, frames=frames, fps=fps))

    def __str__(self) -> str:
        """Return verdict, frequency and accuracy in one line."""
        return line_of(self.summary())
