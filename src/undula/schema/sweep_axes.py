"""The layout of a stored sweep: runs over axes and tries, labelled.

Its dimensions are the axes, named by their keys as "load.force", and `try`. `status` tells which of
its points have an answer, `verdict` which, in words or as numbers with their meanings beside them.
"""

from collections.abc import Mapping

import numpy as np
import xarray as xr

from undula.errors import InputError

#: The last dimension: several starts of one point.
TRY = "try"
NOT_DONE, DONE, FAILED = 0, 1, 2
_NEEDED = ("status", "verdict")


def axes_of(store: xr.Dataset) -> tuple[str, ...]:
    """Return the names of the axes in their order.

    Raises
    ------
    InputError
        The dataset is no stored sweep.
    """
    missing = [name for name in _NEEDED if name not in store]
    if missing or TRY not in store["status"].dims:
        raise InputError(
            f"the store lacks {', '.join(missing) or f'the dimension {TRY}'}; give one that a"
            " sweep has made"
        )
    return tuple(str(name) for name in store["status"].dims if name != TRY)


def verdicts_of(store: xr.Dataset) -> xr.DataArray:
    """Return the verdicts in words, over the axes and tries; "" where there is none."""
    axes_of(store)
    stored = store["verdict"]
    meanings = stored.attrs.get("flag_meanings")
    named = stored.astype(str).values if meanings is None else _named(stored, meanings)
    words = xr.DataArray(named, coords=stored.coords, dims=stored.dims)
    return words.where(store["status"] == DONE, "").transpose(*store["status"].dims)


def varied(store: xr.Dataset) -> tuple[str, ...]:
    """Return the names of the axes with more than one value, in their order."""
    return tuple(name for name in axes_of(store) if store.sizes[name] > 1)


def chosen(store: xr.Dataset, at: Mapping[str, float]) -> xr.Dataset:
    """Return the part of a store at given values of some of its axes, which keep one value each.

    Raises
    ------
    InputError
        There is no such axis, or no such value on it.
    """
    for name, value in at.items():
        if name not in axes_of(store):
            known = ", ".join(axes_of(store))
            raise InputError(f"{name} is no axis of the store; take one of {known}")
        values = store[name].values
        # Values are given to as many digits as people write.
        found = np.flatnonzero(np.isclose(values, value, rtol=1e-6, atol=0.0))
        if not found.size:
            told = ", ".join(f"{each:g}" for each in values)
            raise InputError(f"{name} = {value:g} is no value of the store; take one of {told}")
        store = store.isel({name: found[:1]})
    return store


def _named(stored: xr.DataArray, meanings: object) -> np.ndarray:
    """Return codes in words; a code without a meaning is told as it is."""
    # CF writes meanings into one string, with spaces between them and underscores within.
    words = (
        [word.replace("_", " ") for word in meanings.split()]
        if isinstance(meanings, str)
        else [str(word) for word in meanings]  # type: ignore[attr-defined]
    )
    codes = stored.attrs.get("flag_values", range(len(words)))
    known = {float(code): word for code, word in zip(codes, words, strict=True)}
    flat = [known.get(float(code), f"verdict {code}") for code in stored.values.ravel()]
    return np.array(flat, dtype=object).reshape(stored.shape).astype(str)
