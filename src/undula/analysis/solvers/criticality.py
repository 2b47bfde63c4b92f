"""Whether spinning and flapping leave the Hopf point upwards or downwards.

Near the Hopf point a branch has the force F = F_H + c a^2 for a small amplitude a. With c > 0 it is
born supercritically: it exists beyond F_H only and grows from nothing. With c < 0 it is born
subcritically: it exists below F_H, unstable, turns back in a fold, and the filament jumps.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from undula.analysis.solvers.flapping import flapping_start
from undula.analysis.solvers.spinning import spinning_start
from undula.analysis.states.records import NotFound
from undula.models.model import Model
from undula.numerics.continuation.arclength import Point, advance
from undula.numerics.continuation.problem import Problem

# Arclengths at which the bend of a branch is measured: small enough for the square, large enough
# for Newton's method to see it.
_SHORT, _LONG = 0.01, 0.02


@dataclass(frozen=True)
class Birth:
    """How a branch leaves its Hopf point.

    Attributes
    ----------
    kind : {"spinning", "flapping"}
    force : float
        The Hopf force [B/L^2].
    bend : float
        c, the change of the force with the square of the amplitude [B/L^4]: a is the root mean
        square over the nodes' coordinates of how far they are from the straight state, for
        flapping at the instant at which the tip is farthest in the linear mode.
    bend_error : float
        Estimated from two amplitudes.
    """

    kind: Literal["spinning", "flapping"]
    force: float
    bend: float
    bend_error: float

    @property
    def supercritical(self) -> bool:
        """Whether the branch exists beyond the Hopf force."""
        return self.bend > 0.0


def births(model: Model) -> tuple[Birth, ...] | NotFound:
    """Return how spinning, unless the model is confined, and flapping are born.

    Parameters
    ----------
    model : Model
        Its own force does not matter.
    """
    found = []
    for kind in ("flapping", "spinning") if model.dimension == 3 else ("flapping",):
        birth = birth_of(model, kind)
        if isinstance(birth, NotFound):
            return birth
        found.append(birth)
    return tuple(found)


def birth_of(model: Model, kind: str) -> Birth | NotFound:
    """Return how a kind of state is born, "spinning" or "flapping"."""
    start = (spinning_start if kind == "spinning" else flapping_start)(model)
    if start is None:
        return NotFound("the straight state stays stable, so that nothing is born")
    birth = _birth(kind, *start)
    return birth or NotFound(f"Newton's method finds no {kind} next to the Hopf point")


def born_downwards(model: Model, kind: str) -> bool:
    """Tell whether a kind of state is found to be born downwards, "spinning" or "flapping"."""
    birth = birth_of(model, kind)
    return isinstance(birth, Birth) and not birth.supercritical


def _birth(kind: str, problem: Problem, start: Point) -> Birth | None:
    bends = []
    for length in (_SHORT, _LONG):
        point = advance(problem, start, length, start.p)
        if point is None:
            return None
        away = problem.weights @ (point.u - start.u) ** 2
        bends.append((point.p - start.p) / away)
    # The next term is of the square of the amplitude, four times larger for the longer one.
    bend = bends[0] + (bends[0] - bends[1]) / 3.0
    return Birth(kind, start.p, float(bend), float(np.abs(bend - bends[0])))  # type: ignore[arg-type]
