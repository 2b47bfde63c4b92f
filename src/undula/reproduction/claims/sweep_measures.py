"""Functions for the expressions of claims on stored sweeps."""

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from undula.analysis.maps.basins import basins
from undula.analysis.regimes.verdict import UNDECIDED
from undula.arrays import Points
from undula.reproduction.claims.answer_measures import FORCE
from undula.schema.sweep_axes import REPLICATE, axes_of, verdicts_of
from undula.sweeps.store import load_sweep

__all__ = [
    "first_verdicts",
    "found",
    "least_excess",
    "least_share",
    "onset_contradictions",
    "share_error",
    "verdicts",
]

#: Relative distance from the onset within which the links of a run may differ from the continuum:
#: the onset of 20 links is 1 per cent lower for a tip force, and more for a force near the base.
NEAR_ONSET = 0.05


def verdicts(sweep: Any) -> str:
    """Return the verdicts in a sweep without "undecided", in alphabetical order."""
    seen = set(_verdicts(_stored_sweep(sweep)).ravel().tolist())
    return ", ".join(sorted(seen - {UNDECIDED}))


def found(sweep: Any, verdict: str) -> int:
    """Return the number of points of a sweep with a given verdict.

    Parameters
    ----------
    sweep
        Answer of ``undula sweep``.
    verdict
        The verdict.
    """
    return int((_verdicts(_stored_sweep(sweep)) == verdict).sum())


def least_share(sweep: Any, verdict: str, low: float, high: float) -> float:
    """Return the least share of replicates with a verdict, over forces between `low` and `high`.

    Parameters
    ----------
    sweep
        Answer of ``undula sweep``.
    verdict
        The verdict.
    low
        Lower end of the forces, excluded.
    high
        Upper end of the forces, excluded.
    """
    return _least_share(sweep, verdict, low, high)[0]


def share_error(sweep: Any, verdict: str, low: float, high: float) -> float:
    """Return half of the 95 per cent interval of `least_share`.

    Parameters
    ----------
    sweep
        Answer of ``undula sweep``.
    verdict
        The verdict.
    low
        Lower end of the forces, excluded.
    high
        Upper end of the forces, excluded.
    """
    _, least, most = _least_share(sweep, verdict, low, high)
    return (most - least) / 2.0


def _least_share(sweep: Any, verdict: str, low: float, high: float) -> tuple[float, float, float]:
    """Return the least share with the ends of its interval; zeros without the verdict."""
    store = _stored_sweep(sweep)
    shares = basins(store)
    inside = (store[FORCE].values > low) & (store[FORCE].values < high)
    if verdict not in shares["verdict"].values:
        return 0.0, 0.0, 0.0
    selected = shares.sel(verdict=verdict).isel({FORCE: inside})
    least = int(np.argmin(selected["fraction"].values))
    return tuple(float(selected[name][least]) for name in ("fraction", "low", "high"))  # type: ignore[return-value]


def least_excess(sweep: Any, growth: Any) -> float:
    """Return the least relative excess of spinning frequencies over those of linear theory.

    Parameters
    ----------
    sweep
        A sweep over a parameter and the force.
    growth
        Answer of ``undula stability`` over the same values.
    """
    store = _stored_sweep(sweep)
    spins = _verdicts(store) == "spinning"
    linear = np.asarray(growth.points.frequency, dtype=float).reshape(spins.shape)
    frequency = store["frequency"].isel({REPLICATE: 0}).transpose(..., FORCE).values
    both = spins & (linear > 0.0)
    return float((frequency[both] / linear[both] - 1.0).min())


def onset_contradictions(sweep: Any, places: ArrayLike, onsets: ArrayLike) -> int:
    """Return the number of runs that contradict the onset of linear theory and are not near it.

    Parameters
    ----------
    sweep
        A sweep over a parameter and the force.
    places, onsets
        Values of the parameter, and the forces of the onset there.
    """
    store = _stored_sweep(sweep)
    onset = _at_rows(store, places, onsets)[:, None]
    force = store[FORCE].values[None, :]
    straight = _verdicts(store) == "straight"
    far = np.abs(force / onset - 1.0) > NEAR_ONSET
    return int((far & (straight == (force > onset))).sum())


def first_verdicts(sweep: Any, places: ArrayLike, onsets: ArrayLike) -> str:
    """Return the verdicts of the first runs above the onset, over the other axis.

    Parameters
    ----------
    sweep
        A sweep over a parameter and the force.
    places, onsets
        Values of the parameter, and the forces of the onset there.
    """
    store = _stored_sweep(sweep)
    words, force, seen = _verdicts(store), store[FORCE].values, set()
    for row, onset in enumerate(_at_rows(store, places, onsets)):
        above = np.flatnonzero(force > onset * (1.0 + NEAR_ONSET))
        if len(above):
            seen.add(str(words[row, above[0]]))
    return ", ".join(sorted(seen))


def _stored_sweep(sweep: Any) -> xr.Dataset:
    return load_sweep(sweep.folder / "study.zarr")


def _verdicts(store: xr.Dataset) -> Any:
    """Return the verdicts of the first replicates in words, with the force last."""
    words = verdicts_of(store).isel({REPLICATE: 0})
    return words.transpose(..., FORCE).values


def _other(store: xr.Dataset) -> str:
    return next(axis for axis in axes_of(store) if axis != FORCE)


def _at_rows(store: xr.Dataset, places: ArrayLike, values: ArrayLike) -> Points:
    """Return a curve at the values of the axis other than the force."""
    own, wanted = np.asarray(places, dtype=float), store[_other(store)].values
    return np.asarray(np.interp(wanted, own, np.asarray(values, dtype=float)))
