"""What the claims of the catalogue measure on stored studies of many runs."""

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from undula.analysis.maps.basins import basins
from undula.analysis.regimes.verdict import UNDECIDED
from undula.arrays import Points
from undula.reproduction.claims.measures import FORCE
from undula.schema.sweep_axes import TRY, axes_of, verdicts_of
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

#: Part of the onset within which the links of a run may differ from the continuum: the onset of 20
#: links is 1 per cent lower under a tip force, and more where the force sits low.
NEAR_ONSET = 0.05


def verdicts(sweep: Any) -> str:
    """Return the verdicts that occur in a study, those undecided apart, in alphabetical order."""
    seen = set(_verdicts(_study(sweep)).ravel().tolist())
    return ", ".join(sorted(seen - {UNDECIDED}))


def found(sweep: Any, verdict: str) -> int:
    """Return the number of points of a study with a verdict."""
    return int((_verdicts(_study(sweep)) == verdict).sum())


def least_share(sweep: Any, verdict: str, low: float, high: float) -> float:
    """Return the least share of tries with a verdict, over the forces between two."""
    return _least_share(sweep, verdict, low, high)[0]


def share_error(sweep: Any, verdict: str, low: float, high: float) -> float:
    """Return half of the 95 per cent interval of the least share."""
    _, least, most = _least_share(sweep, verdict, low, high)
    return (most - least) / 2.0


def _least_share(sweep: Any, verdict: str, low: float, high: float) -> tuple[float, float, float]:
    """Return the least share with the ends of its interval; noughts for one that never occurs."""
    store = _study(sweep)
    shares = basins(store)
    inside = (store[FORCE].values > low) & (store[FORCE].values < high)
    if verdict not in shares["verdict"].values:
        return 0.0, 0.0, 0.0
    chosen = shares.sel(verdict=verdict).isel({FORCE: inside})
    least = int(np.argmin(chosen["fraction"].values))
    return tuple(float(chosen[name][least]) for name in ("fraction", "low", "high"))  # type: ignore[return-value]


def least_excess(sweep: Any, growth: Any) -> float:
    """Return the least of how much faster spinning points are than linear theory, relative to it.

    Parameters
    ----------
    sweep
        A study over a parameter and the force.
    growth
        The answer of `undula stability` over the same values.
    """
    store = _study(sweep)
    spins = _verdicts(store) == "spinning"
    linear = np.asarray(growth.points.frequency, dtype=float).reshape(spins.shape)
    ours = store["frequency"].isel({TRY: 0}).transpose(..., FORCE).values
    told = spins & (linear > 0.0)
    return float((ours[told] / linear[told] - 1.0).min())


def onset_contradictions(sweep: Any, places: ArrayLike, onsets: ArrayLike) -> int:
    """Return the number of runs on the wrong side of the onset of linear theory, but not near it.

    Parameters
    ----------
    sweep
        A study over a parameter and the force.
    places, onsets
        Values of the parameter, and the forces of the onset there.
    """
    store = _study(sweep)
    onset = _at_rows(store, places, onsets)[:, None]
    force = store[FORCE].values[None, :]
    straight = _verdicts(store) == "straight"
    far = np.abs(force / onset - 1.0) > NEAR_ONSET
    return int((far & (straight == (force > onset))).sum())


def first_verdicts(sweep: Any, places: ArrayLike, onsets: ArrayLike) -> str:
    """Return the verdicts of the runs next above the onset, at each value of the other axis.

    Parameters
    ----------
    sweep
        A study over a parameter and the force.
    places, onsets
        Values of the parameter, and the forces of the onset there.
    """
    store = _study(sweep)
    known, force, seen = _verdicts(store), store[FORCE].values, set()
    for row, onset in enumerate(_at_rows(store, places, onsets)):
        above = np.flatnonzero(force > onset * (1.0 + NEAR_ONSET))
        if len(above):
            seen.add(str(known[row, above[0]]))
    return ", ".join(sorted(seen))


def _study(sweep: Any) -> xr.Dataset:
    return load_sweep(sweep.folder / "study.zarr")


def _verdicts(store: xr.Dataset) -> Any:
    """Return the verdicts of the first tries in words, the force last."""
    words = verdicts_of(store).isel({TRY: 0})
    return words.transpose(..., FORCE).values


def _other(store: xr.Dataset) -> str:
    return next(axis for axis in axes_of(store) if axis != FORCE)


def _at_rows(store: xr.Dataset, places: ArrayLike, values: ArrayLike) -> Points:
    """Return a curve at the values of the axis besides the force."""
    known, wanted = np.asarray(places, dtype=float), store[_other(store)].values
    return np.asarray(np.interp(wanted, known, np.asarray(values, dtype=float)))
