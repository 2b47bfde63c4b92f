"""Shares of initial states that end in each verdict, at points of a sweep with several tries."""

from statistics import NormalDist

import numpy as np
import xarray as xr

from undula.arrays import Array
from undula.errors import InputError
from undula.schema.physical_units import UNITS_PHYSICAL
from undula.schema.sweep_axes import DONE, REPLICATE, verdicts_of

#: Dimension of the verdicts.
VERDICT = "verdict"


def wilson_interval(hits: Array, tries: Array, confidence: float = 0.95) -> tuple[Array, Array]:
    """Return Wilson's score interval of a share that is estimated from hits among tries.

    It holds the shares p from which the observed share is at most z of their own standard
    deviations sqrt(p (1 - p) / n) away. It stays within 0 and 1, and is not empty where all or no
    tries hit.

    Parameters
    ----------
    hits, tries : ndarray of one shape
        Numbers of hits among independent tries.
    confidence : float
        Between 0 and 1.

    Returns
    -------
    tuple of ndarray
        Lower and upper ends; 0 and 1 where nothing was tried.

    Raises
    ------
    InputError
        The confidence is out of range.

    Examples
    --------
    >>> import numpy as np
    >>> low, high = wilson_interval(np.array(8), np.array(10))
    >>> round(float(low), 3), round(float(high), 3)
    (0.49, 0.943)

    References
    ----------
    E. B. Wilson, J. Am. Stat. Assoc. 22 (1927) 209.
    """
    if not 0.0 < confidence < 1.0:
        raise InputError(f"confidence = {confidence} has to be above 0 and below 1; 0.95 is usual")
    z = NormalDist().inv_cdf(0.5 + 0.5 * confidence)
    hits, tries = np.asarray(hits, dtype=float), np.asarray(tries, dtype=float)
    n = np.maximum(tries, 1.0)
    share = hits / n
    middle = (share + 0.5 * z**2 / n) / (1.0 + z**2 / n)
    half = z / (1.0 + z**2 / n) * np.sqrt(share * (1.0 - share) / n + 0.25 * z**2 / n**2)
    # Round-off alone keeps the ends from 0 and 1 where all or no tries hit.
    low = np.where(hits == 0.0, 0.0, middle - half)
    high = np.where(hits == tries, 1.0, middle + half)
    return low, high


def basins(store: xr.Dataset, *, confidence: float = 0.95) -> xr.Dataset:
    """Return the share of initial states that end in each verdict.

    Parameters
    ----------
    store : xarray.Dataset
        A stored sweep with replicates.
    confidence : float
        Confidence of the intervals, between 0 and 1.

    Returns
    -------
    xarray.Dataset
        Over the axes `tries`, the number of initial states with an answer; over the axes and
        `verdict`, those that occur, the most frequent first, `hits`, `fraction`, `low` and `high`:
        the share and the ends of its Wilson interval. Shares are NaN where nothing was tried.

    Raises
    ------
    InputError
        It is not a stored sweep, or the confidence is out of range.

    Examples
    --------
    A table of four replicates under one force stands for a sweep of `load_sweep`:

    >>> import undula as un
    >>> import xarray as xr
    >>> axes = ("load.force", "try")
    >>> words = [["spinning", "spinning", "planar flapping", "spinning"]]
    >>> variables = {"status": (axes, [[1, 1, 1, 1]]), "verdict": (axes, words)}
    >>> shares = un.basins(xr.Dataset(variables, {"load.force": [75.0]}))
    >>> shares["fraction"].sel(verdict="spinning").values
    array([0.75])
    """
    verdicts = verdicts_of(store)
    names, counts = np.unique(verdicts.values[verdicts.values != ""], return_counts=True)
    ordered = names[np.argsort(-counts, kind="stable")]
    labels = xr.DataArray(ordered, dims=VERDICT, coords={VERDICT: ordered})
    hits = (verdicts == labels).sum(REPLICATE)
    tries = (store["status"] == DONE).sum(REPLICATE)
    low, high = (
        xr.DataArray(end, coords=hits.coords, dims=hits.dims)
        for end in wilson_interval(hits.values, (tries + 0 * hits).values, confidence)
    )
    fraction = (hits / tries.where(tries > 0)).transpose(*hits.dims)
    tried = tries > 0
    physical = {name: store.attrs[name] for name in (UNITS_PHYSICAL,) if name in store.attrs}
    return xr.Dataset(
        {
            "tries": tries,
            "hits": hits,
            "fraction": fraction,
            "low": low.where(tried),
            "high": high.where(tried),
        },
        attrs={"confidence": confidence, "units": store.attrs.get("units", "{}"), **physical},
    )
