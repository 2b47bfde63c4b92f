"""Dimensions of a stored sweep, and the selection and reading of its verdicts.

The dimensions are the axes, named by their keys such as "load.force", and the replicates, named
"try". The variable `status` marks the points with a result; `verdict` holds the results in words,
or as numbers with their meanings as attributes.
"""

from collections.abc import Mapping

import numpy as np
import xarray as xr

from undula.errors import InputError

#: The last dimension: replicates of one point, with different random starts.
REPLICATE = "try"
#: Values of `status`.
NOT_DONE, DONE, FAILED = 0, 1, 2
_NEEDED = ("status", "verdict")


def axes_of(store: xr.Dataset) -> tuple[str, ...]:
    """Return the names of the axes in their order.

    Raises
    ------
    InputError
        The dataset is not a stored sweep.
    """
    missing = [name for name in _NEEDED if name not in store]
    if missing or REPLICATE not in store["status"].dims:
        raise InputError(
            f"the store lacks {', '.join(missing) or f'the dimension {REPLICATE}'}; give one that a"
            " sweep has made"
        )
    return tuple(str(name) for name in store["status"].dims if name != REPLICATE)


def verdicts_of(store: xr.Dataset) -> xr.DataArray:
    """Return the verdicts in words, over the axes and replicates; "" at points without a verdict.

    Raises
    ------
    InputError
        The dataset is not a stored sweep.
    """
    axes_of(store)
    stored = store["verdict"]
    meanings = stored.attrs.get("flag_meanings")
    named = stored.astype(str).values if meanings is None else _named(stored, meanings)
    words = xr.DataArray(named, coords=stored.coords, dims=stored.dims)
    return words.where(store["status"] == DONE, "").transpose(*store["status"].dims)


def varied(store: xr.Dataset) -> tuple[str, ...]:
    """Return the names of the axes with more than one value, in their order.

    Raises
    ------
    InputError
        The dataset is not a stored sweep.
    """
    return tuple(name for name in axes_of(store) if store.sizes[name] > 1)


def chosen(store: xr.Dataset, place: Mapping[str, float]) -> xr.Dataset:
    """Return the part of a store nearest to given values of some of its axes.

    Parameters
    ----------
    store
        A stored sweep.
    place
        Finite value by name of axis; the axis keeps its nearest value alone, of two equally near
        ones the first.

    Raises
    ------
    InputError
        The store has no such axis.
    """
    for name, value in place.items():
        if name not in axes_of(store):
            axes = ", ".join(axes_of(store))
            raise InputError(f"{name} is no axis of the store; take one of {axes}")
        nearest = np.argmin(np.abs(store[name].values - value))
        store = store.isel({name: [int(nearest)]})
    return store


def _named(stored: xr.DataArray, meanings: object) -> np.ndarray:
    """Return codes in words; a code without a meaning is returned as "verdict" and the code."""
    # The CF conventions join meanings into one string, with spaces between and underscores within.
    words = (
        [word.replace("_", " ") for word in meanings.split()]
        if isinstance(meanings, str)
        else [str(word) for word in meanings]  # type: ignore[attr-defined]
    )
    codes = stored.attrs.get("flag_values", range(len(words)))
    named = {float(code): word for code, word in zip(codes, words, strict=True)}
    flat = [named.get(float(code), f"verdict {code}") for code in stored.values.ravel()]
    return np.array(flat, dtype=object).reshape(stored.shape).astype(str)
