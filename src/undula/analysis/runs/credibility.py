"""Whether what a run shows may be believed: a name that may be the integrator's work is taken back.

A verdict stays `undecided`, with the reason and the cure, where

- the run got energy or lengths wrong beyond a bound;
- the motion is not far above the absolute tolerance, below which everything is damped;
- its name rests on small changes of shape, and steps are not exact enough to keep errors out;
- it says straight, or at rest, of a state from which disturbances grow by its own spectrum.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from undula.analysis.observables.trajectory import Motion
from undula.analysis.regimes.verdict import STRAIGHT, UNDECIDED, Verdict
from undula.analysis.run_settings import Schedule
from undula.analysis.runs.accuracy import Errors
from undula.analysis.runs.settling import UNMOVED
from undula.analysis.states.relative_equilibrium import rotating_spectrum
from undula.arrays import Array, Nodes, Shapes
from undula.models.initial_states import leading_rate
from undula.models.model import Model

#: Energy or lengths that are wrong by more than this part: the coarsest tolerances that are taken
#: leave a hundredth, and with five times that it is no longer the motion of the body.
UNSOUND = 0.05
#: A balance that misses less than this part of the stored energy is one of round-off and of the
#: integrator's errors: of a body that is bent by nature and hardly moves.
STILL = 1e-6
#: A motion is told from so many times the absolute tolerance on: an error of a hundredth a step is
#: the largest that the relative one may have, too.
ABOVE_ATOL = 100.0
#: Names that rest on no small change of shape.
PLAIN = (STRAIGHT, "spinning", "planar flapping", "at rest", "windmilling")
#: The others are told where a step is wrong by less than this part of the motion: from 1e-4 on
#: errors have been seen to keep a spinning shape swinging for good, at 1e-6 not. In between lies
#: 1e-5, with some room, at which few runs were tried.
SUBTLE = 3e-5
#: A body that comes to rest after it has moved by more [rad] has tried to go elsewhere.
SLIGHT = 1e-3
#: So many samples tell how large a motion is.
LOOKS = 64
#: Verdicts on states that have a spectrum to be held against.
RESTING = (STRAIGHT, "at rest")


@dataclass(frozen=True)
class Grounds:
    """What a verdict is held against.

    Attributes
    ----------
    model, schedule
        What ran, and how exactly.
    whole
        The whole run.
    errors
        What it got wrong.
    last
        The integrator's vector at its end, shape ``(n,)``.
    known_stable
        Whether the state that it has come to is known to be stable.
    """

    model: Model
    schedule: Schedule
    whole: Motion
    errors: Errors
    last: Array
    known_stable: bool = False

    def believed(self, verdict: Verdict, motion: Motion) -> Verdict:
        """Return a verdict on a motion, taken back where it may not be believed."""
        if verdict.name == UNDECIDED and verdict.late is None:
            return verdict
        size = self._size(verdict, motion)
        return (
            self._unsound(verdict)
            or self._unstable(verdict)
            or self._small(verdict, size)
            or self._coarse(verdict, size)
            or verdict
        )

    def _size(self, verdict: Verdict, motion: Motion) -> float:
        """Return how large the motion is [rad], at least: where it is large, one sample tells."""
        straight = self.model.nodes(self.model.straight())
        one = self.whole.nodes[:1] if verdict.name == STRAIGHT else motion.nodes[-1:]
        size = _size(self.model, one, straight)
        if verdict.name in PLAIN and size > ABOVE_ATOL * self.schedule.atol:
            return size
        seen = self.whole if verdict.name == STRAIGHT else motion.late(verdict.window_start)
        return _size(self.model, seen.nodes, straight)

    def _unsound(self, verdict: Verdict) -> Verdict | None:
        if self._balance() > UNSOUND:
            what = f"its power balance is off by {self.errors.power_balance_error:.2g}"
        elif self.errors.length_error > UNSOUND and not self.model.extensible:
            what = f"its links change their length by {self.errors.length_error:.2g}"
        else:
            return None
        tolerances = f"rtol = {self.schedule.rtol:g} and atol = {self.schedule.atol:g}"
        return _back(verdict, f"{what}, which no motion of the body is: {tolerances} are too large")

    def _balance(self) -> float:
        """Return the error of the energy balance, 0 where it has no meaning."""
        if not self.model.balances:
            return 0.0
        energetics = self.whole.energetics
        stored = float(np.max(energetics.bending_energy + energetics.stretching_energy))
        through = float(self.whole.loss[-1] + abs(self.whole.work[-1]))
        return self.errors.power_balance_error if through > STILL * stored else 0.0

    def _small(self, verdict: Verdict, size: float) -> Verdict | None:
        atol = self.schedule.atol
        moves = verdict.name != "at rest" and size > UNMOVED
        if not moves or size > ABOVE_ATOL * atol:
            return None
        return _back(
            verdict,
            f"the motion, of {size:.2g} rad, is less than {ABOVE_ATOL:g} times atol = {atol:g}, and"
            " the integrator damps what is so small: give a larger amplitude of the start, or a"
            " smaller atol",
        )

    def _coarse(self, verdict: Verdict, size: float) -> Verdict | None:
        # By which part of the motion a step may be wrong.
        error = self.schedule.rtol + self.schedule.atol / size
        if verdict.name in PLAIN or error <= SUBTLE:
            return None
        return _back(
            verdict,
            f"steps may be wrong by {error:.2g} of the motion, which can keep such a motion alive:"
            f" give an rtol, and an atol over {size:.2g} rad, of at most {SUBTLE:g}",
        )

    def _unstable(self, verdict: Verdict) -> Verdict | None:
        if verdict.name not in RESTING or self.known_stable:
            return None
        nodes = self.whole.nodes
        if verdict.name != STRAIGHT and _size(self.model, nodes, nodes[-1]) > SLIGHT:
            return None  # what grows would have been seen, and asking takes long
        if verdict.name == STRAIGHT and self.model.axisymmetric:
            rate = leading_rate(self.model)
        else:
            straight = verdict.name == STRAIGHT
            y = self.model.straight_unknowns() if straight else self.last
            rate = float(rotating_spectrum(self.model, y, 0.0)[0].real)
        return None if rate <= 0.0 else self._leaves(verdict, rate)

    def _leaves(self, verdict: Verdict, rate: float) -> Verdict:
        """Return the verdict on a run that seems to come to rest where nothing stays."""
        which = "the straight state" if verdict.name == STRAIGHT else "that state"
        told = f"{which} is unstable, disturbances grow at {rate:.4g}/T"
        back = _back(
            verdict, f"{told}: give a larger amplitude of the start, or a smaller atol, to see them"
        )
        straight, last = self.model.nodes(self.model.straight()), self.whole.nodes[-1:]
        left = _size(self.model, last, straight) if verdict.name == STRAIGHT else 0.0
        seen = left > ABOVE_ATOL * self.schedule.atol
        # What is left grows until it is as large as motions are.
        longer = math.log(max(math.e, 1.0 / left)) / rate if seen else None
        return replace(back, evidence=back.evidence | {"leading_rate": rate}, longer=longer)


def _back(verdict: Verdict, doubt: str) -> Verdict:
    """Return an undecided verdict that tells what is doubted, and what the run looks like."""
    looks = "" if verdict.name == UNDECIDED else f"{verdict.name}, "
    reason = f"{doubt}; it looks {looks}{verdict.reason}"
    return replace(verdict, name=UNDECIDED, reason=reason, margin=0.0, longer=None, late=None)


def _size(model: Model, nodes: Shapes, rest: Nodes) -> float:
    """Return the largest RMS inclination [rad] to a shape (N + 1, 3) in nodes (m, N + 1, 3)."""
    away = nodes[:: max(1, len(nodes) // LOOKS)] - rest
    slopes = (away[:, 1:] - away[:, :-1]) * model.links
    return math.sqrt((slopes * slopes).sum(axis=(1, 2)).max(initial=0.0) / model.links)
