"""Functions for the expressions of claims, on answers of commands."""

from typing import Any

import numpy as np

from undula.arrays import Points
from undula.reproduction.claims.measures import on

__all__ = [
    "forces",
    "gaining",
    "largest_spread",
    "regimes",
    "slowness",
    "spinning_energy",
]

FORCE = "load.force"


def forces(branch: Any, *, above: float = 0.0) -> Points:
    """Return the forces of the points of a branch, above a given force.

    Parameters
    ----------
    branch
        Answer of ``undula follow``.
    above
        Least force.
    """
    values = np.asarray(branch.points[FORCE], dtype=float)
    return values[values > above]


def gaining(branch: Any) -> float:
    """Return the least force at which the states of a branch gain stability.

    Raises
    ------
    ValueError
        No state of the branch gains stability.
    """
    gained = branch.bifurcations.value[branch.bifurcations.stability == "gained"]
    if not len(gained):
        raise ValueError("no state of the branch gains stability")
    return float(gained.min())


def spinning_energy(branch: Any, *, above: float = 0.0) -> Points:
    """Return the bending energies of spinning states on a branch, above a given force.

    Parameters
    ----------
    branch
        Answer of ``undula follow``.
    above
        Least force.
    """
    energies = np.asarray(branch.points.bending_energy, dtype=float)
    return energies[np.asarray(branch.points[FORCE], dtype=float) > above]


def slowness(spinning: Any, flapping: Any) -> Points:
    """Return 1 - f_flapping / f_spinning at the points of the branch of flapping.

    Parameters
    ----------
    spinning
        Answer of ``undula follow spinning``.
    flapping
        Answer of ``undula follow flapping``.
    """
    fast = on(forces(flapping), spinning.points[FORCE], spinning.points.frequency)
    return 1.0 - np.asarray(flapping.points.frequency, dtype=float) / fast


def regimes(steps: Any) -> str:
    """Return the verdicts along a ramp in their order, without undecided steps."""
    order = [verdict for verdict in steps.regimes.verdict if verdict != "undecided"]
    return ", ".join(dict.fromkeys(order))


def largest_spread(steps: Any, verdict: str) -> float:
    """Return the largest relative range of the bending energy among the steps of a verdict.

    Parameters
    ----------
    steps
        Answer of ``undula step``.
    verdict
        The verdict.
    """
    wanted = steps.steps.verdict == verdict
    low, high = steps.steps["bending_energy/min"], steps.steps["bending_energy/max"]
    mean = steps.steps["bending_energy/mean"]
    return float(((high - low) / mean)[wanted].max())
