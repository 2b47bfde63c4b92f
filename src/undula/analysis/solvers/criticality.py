"""Criticality of the Hopf point: the direction in which spinning and flapping leave it.

Near the Hopf point a branch has the force F = F_H + c a^2 for a small amplitude a. With c > 0 the
branch is supercritical: it exists beyond F_H only and grows from nothing. With c < 0 it is
subcritical: it exists below F_H, unstable, turns back in a fold, and the filament jumps.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from undula.analysis.solvers.flapping import flapping_start
from undula.analysis.solvers.spinning import spinning_start
from undula.analysis.states.not_found import NotFound, SearchStatus
from undula.models.model import Model
from undula.numerics.continuation.arclength import Point, advance
from undula.numerics.continuation.problem import Problem

# Arclengths at which the quadratic coefficient is measured: small enough for the square, large
# enough for Newton's method to resolve it.
_SHORT, _LONG = 0.01, 0.02


@dataclass(frozen=True)
class Criticality:
    """Direction in which a branch leaves its Hopf point.

    Attributes
    ----------
    kind : {"spinning", "flapping"}
    force : float
        The Hopf force [B/L^2].
    quadratic_coefficient : float
        c, the change of the force with the square of the amplitude [B/L^4]. The amplitude is the
        root mean square over the nodes' coordinates of their distance from the straight state, for
        flapping at the instant at which the tip is farthest in the linear mode.
    quadratic_coefficient_error : float
        Estimated from two amplitudes.
    """

    kind: Literal["spinning", "flapping"]
    force: float
    quadratic_coefficient: float
    quadratic_coefficient_error: float

    @property
    def supercritical(self) -> bool:
        """True if the branch exists beyond the Hopf force."""
        return self.quadratic_coefficient > 0.0


def criticality(model: Model) -> tuple[Criticality, ...] | NotFound:
    """Return the criticality of flapping and, unless the model is confined, of spinning.

    Parameters
    ----------
    model : Model
        Its own force does not matter.

    Returns
    -------
    tuple of Criticality or NotFound
        Flapping first. `NotFound` if the straight state is stable at all forces, or Newton's method
        finds no state next to the Hopf point.

    Raises
    ------
    InputError
        The model has natural curvature, so that it has no straight state.

    Examples
    --------
    >>> import undula as un
    >>> flapping, spinning = un.criticality(un.Filament(8, un.TipLoad(75.0)))
    >>> flapping.supercritical, spinning.supercritical
    (True, True)
    """
    results = []
    for kind in ("flapping", "spinning") if model.dimension == 3 else ("flapping",):
        result = criticality_of(model, kind)
        if isinstance(result, NotFound):
            return result
        results.append(result)
    return tuple(results)


def criticality_of(model: Model, kind: str) -> Criticality | NotFound:
    """Return the criticality of a kind of state.

    Parameters
    ----------
    model : Model
        Its own force does not matter.
    kind : {"spinning", "flapping"}
        Kind of the states.

    Returns
    -------
    Criticality or NotFound
        As in `criticality`.
    """
    start = (spinning_start if kind == "spinning" else flapping_start)(model)
    if start is None:
        return NotFound(
            SearchStatus.NO_ONSET, "the straight state stays stable, so that nothing is born"
        )
    return _measured(kind, *start) or NotFound(
        SearchStatus.NOT_CONVERGED, f"Newton's method finds no {kind} next to the Hopf point"
    )


def is_subcritical(model: Model, kind: str) -> bool:
    """Return whether a kind of state, "spinning" or "flapping", is found to be subcritical."""
    result = criticality_of(model, kind)
    return isinstance(result, Criticality) and not result.supercritical


def _measured(kind: str, problem: Problem, start: Point) -> Criticality | None:
    coefficients = []
    for length in (_SHORT, _LONG):
        point = advance(problem, start, length, start.p)
        if point is None:
            return None
        amplitude_squared = problem.weights @ (point.u - start.u) ** 2
        coefficients.append((point.p - start.p) / amplitude_squared)
    # The next term is of the square of the amplitude, four times larger for the longer one.
    quadratic_coefficient = coefficients[0] + (coefficients[0] - coefficients[1]) / 3.0
    error = np.abs(quadratic_coefficient - coefficients[0])
    return Criticality(kind, start.p, float(quadratic_coefficient), float(error))  # type: ignore[arg-type]
