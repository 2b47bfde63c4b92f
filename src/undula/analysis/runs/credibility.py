"""Credibility of a verdict: a name that may be an artefact of the integration is withdrawn.

A verdict becomes `undecided`, with the reason and the remedy, if

- the errors of the energy or of the lengths are too large;
- the motion is not far above the absolute tolerance, below which the integrator damps it;
- the name rests on small changes of shape, and the steps are not exact enough for them;
- the name is straight or at rest, but by its spectrum the state is unstable.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from undula.analysis.linear.leading_rate import leading_rate
from undula.analysis.observables.trajectory import Motion
from undula.analysis.regimes.verdict import STRAIGHT, UNDECIDED, Verdict
from undula.analysis.run_settings import Schedule
from undula.analysis.runs.accuracy import Errors
from undula.analysis.runs.settling import ROUND_OFF_INCLINATION
from undula.analysis.states.relative_equilibrium import rotating_spectrum
from undula.arrays import Array, Nodes, Shapes
from undula.models.model import Model

#: Largest relative error of the energy balance or of the lengths: five times the one hundredth that
#: the coarsest tolerances allow.
MAX_BALANCE_ERROR = 0.05
#: Least energy put in or dissipated, as a share of the stored energy, for a meaningful balance: for
#: a naturally curved filament that hardly moves, the balance is one of round-off.
MIN_THROUGHPUT_SHARE = 1e-6
#: Least amplitude of a classified motion [atol]: the error of a step is then a hundredth, as it is
#: for the largest relative tolerance.
MIN_AMPLITUDE_IN_ATOL = 100.0
#: Names that do not rest on small changes of shape.
ROBUST_NAMES = (STRAIGHT, "spinning", "planar flapping", "at rest", "windmilling")
#: Largest error of a step, relative to the motion, for the other names: errors of 1e-4 can sustain
#: an oscillation of a spinning shape, errors of 1e-6 do not. Few runs were tried in between; this
#: value allows 1e-5 with a margin.
MAX_STEP_ERROR = 3e-5
#: Largest motion in a run to rest whose state is tested for stability [rad]: a larger motion shows
#: an instability by itself.
MAX_RESTING_INCLINATION = 1e-3
#: Number of samples from which the amplitude of a motion is measured.
AMPLITUDE_SAMPLES = 64
#: Names of equilibria, which are tested by their spectrum.
RESTING_NAMES = (STRAIGHT, "at rest")


@dataclass(frozen=True)
class Grounds:
    """Grounds on which a verdict is tested.

    Attributes
    ----------
    model, schedule
        Of the run.
    whole
        Trajectory of the whole run.
    errors
        Errors of the run.
    last
        Unknowns of the integrator at the end, shape ``(n,)``.
    known_stable
        True if the state that the run has reached is known to be stable.
    """

    model: Model
    schedule: Schedule
    whole: Motion
    errors: Errors
    last: Array
    known_stable: bool = False

    def believed(self, verdict: Verdict, motion: Motion) -> Verdict:
        """Return a verdict, or an undecided one if it is not credible.

        Parameters
        ----------
        verdict
            Of the classification.
        motion
            The trajectory that was classified.
        """
        if verdict.name == UNDECIDED and verdict.late is None:
            return verdict
        size = self._amplitude(verdict, motion)
        return (
            self._unsound(verdict)
            or self._unstable(verdict)
            or self._small(verdict, size)
            or self._coarse(verdict, size)
            or verdict
        )

    def _amplitude(self, verdict: Verdict, motion: Motion) -> float:
        """Return the amplitude of the motion [rad]; one sample suffices if it is large enough."""
        straight = self.model.nodes(self.model.straight())
        sample = self.whole.nodes[:1] if verdict.name == STRAIGHT else motion.nodes[-1:]
        size = _largest_inclination(self.model, sample, straight)
        if verdict.name in ROBUST_NAMES and size > MIN_AMPLITUDE_IN_ATOL * self.schedule.atol:
            return size
        seen = self.whole if verdict.name == STRAIGHT else motion.late(verdict.window_start)
        return _largest_inclination(self.model, seen.nodes, straight)

    def _unsound(self, verdict: Verdict) -> Verdict | None:
        """Return the withdrawn verdict if the energy or the lengths are not conserved."""
        if self._balance() > MAX_BALANCE_ERROR:
            defect = f"its power balance is off by {self.errors.power_balance_error:.2g}"
        elif self.errors.length_error > MAX_BALANCE_ERROR and not self.model.extensible:
            defect = f"its links change their length by {self.errors.length_error:.2g}"
        else:
            return None
        tolerances = f"rtol = {self.schedule.rtol:g} and atol = {self.schedule.atol:g}"
        return _doubted(
            verdict, f"{defect}, which no motion of the body is: {tolerances} are too large"
        )

    def _balance(self) -> float:
        """Return the relative error of the energy balance, 0 if it has no meaning."""
        if not self.model.balances:
            return 0.0
        energetics = self.whole.energetics
        stored = float(np.max(energetics.bending_energy + energetics.stretching_energy))
        through = float(self.whole.loss[-1] + abs(self.whole.work[-1]))
        return self.errors.power_balance_error if through > MIN_THROUGHPUT_SHARE * stored else 0.0

    def _small(self, verdict: Verdict, size: float) -> Verdict | None:
        """Return the withdrawn verdict if the motion is so small that the integrator damps it."""
        atol = self.schedule.atol
        moves = verdict.name != "at rest" and size > ROUND_OFF_INCLINATION
        if not moves or size > MIN_AMPLITUDE_IN_ATOL * atol:
            return None
        return _doubted(
            verdict,
            f"the motion, of {size:.2g} rad, is less than {MIN_AMPLITUDE_IN_ATOL:g} times"
            f" atol = {atol:g}, and the integrator damps what is so small: give a larger amplitude"
            " of the start, or a smaller atol",
        )

    def _coarse(self, verdict: Verdict, size: float) -> Verdict | None:
        """Return the withdrawn verdict if errors of the steps may sustain such a motion."""
        # Error of a step relative to the motion.
        error = self.schedule.rtol + self.schedule.atol / size
        if verdict.name in ROBUST_NAMES or error <= MAX_STEP_ERROR:
            return None
        return _doubted(
            verdict,
            f"steps may be wrong by {error:.2g} of the motion, which can keep such a motion alive:"
            f" give an rtol, and an atol over {size:.2g} rad, of at most {MAX_STEP_ERROR:g}",
        )

    def _unstable(self, verdict: Verdict) -> Verdict | None:
        """Return the withdrawn verdict if the equilibrium is unstable."""
        if verdict.name not in RESTING_NAMES or self.known_stable:
            return None
        nodes = self.whole.nodes
        if (
            verdict.name != STRAIGHT
            and _largest_inclination(self.model, nodes, nodes[-1]) > MAX_RESTING_INCLINATION
        ):
            return None  # an instability would have been visible, and the spectrum is expensive
        if verdict.name == STRAIGHT and self.model.axisymmetric:
            rate = leading_rate(self.model)
        else:
            straight = verdict.name == STRAIGHT
            y = self.model.straight_unknowns() if straight else self.last
            rate = float(rotating_spectrum(self.model, y, 0.0)[0].real)
        return None if rate <= 0.0 else self._unstable_verdict(verdict, rate)

    def _unstable_verdict(self, verdict: Verdict, rate: float) -> Verdict:
        """Return the verdict on a run that seems to come to rest in an unstable state."""
        state = "the straight state" if verdict.name == STRAIGHT else "that state"
        doubt = f"{state} is unstable, disturbances grow at {rate:.4g}/T"
        withdrawn = _doubted(
            verdict,
            f"{doubt}: give a larger amplitude of the start, or a smaller atol, to see them",
        )
        straight, last = self.model.nodes(self.model.straight()), self.whole.nodes[-1:]
        remaining = 0.0
        if verdict.name == STRAIGHT:
            remaining = _largest_inclination(self.model, last, straight)
        detectable = remaining > MIN_AMPLITUDE_IN_ATOL * self.schedule.atol
        # Time in which the remaining inclination grows to 1 rad.
        longer = math.log(max(math.e, 1.0 / remaining)) / rate if detectable else None
        return replace(
            withdrawn, evidence=withdrawn.evidence | {"leading_rate": rate}, longer=longer
        )


def _doubted(verdict: Verdict, doubt: str) -> Verdict:
    """Return an undecided verdict with the doubt and the former verdict."""
    looks = "" if verdict.name == UNDECIDED else f"{verdict.name}, "
    reason = f"{doubt}; it looks {looks}{verdict.reason}"
    return replace(verdict, name=UNDECIDED, reason=reason, margin=0.0, longer=None, late=None)


def _largest_inclination(model: Model, nodes: Shapes, rest: Nodes) -> float:
    """Return the largest RMS inclination [rad] of nodes (m, N + 1, 3) to a shape (N + 1, 3)."""
    away = nodes[:: max(1, len(nodes) // AMPLITUDE_SAMPLES)] - rest
    slopes = (away[:, 1:] - away[:, :-1]) * model.links
    return math.sqrt((slopes * slopes).sum(axis=(1, 2)).max(initial=0.0) / model.links)
