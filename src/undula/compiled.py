"""Compilation of kernels, with an on-disk cache that notices every change of the package.

numba's own cache looks at the one file that holds a function, so an edited kernel would go on
running in its old form wherever another file calls it. Here every cached function is stamped with a
digest of all sources of the package: any change of any file makes all of them new.
"""

import hashlib
from functools import cache
from pathlib import Path
from typing import Any

import numba
from numba.core import caching

PACKAGE = Path(__file__).resolve().parent


@cache
def package_digest() -> str:
    """Digest of every Python source of the package: the version of its compiled code."""
    digest = hashlib.sha256()
    for source in sorted(PACKAGE.rglob("*.py")):
        digest.update(source.relative_to(PACKAGE).as_posix().encode())
        digest.update(source.read_bytes())
    return digest.hexdigest()


def _stamped_by_package(locator: Any) -> Any:
    """Return numba's cache `locator`, restricted to this package and stamped with its digest."""

    class PackageLocator(locator):  # type: ignore[misc]
        @classmethod
        def from_function(cls, py_func: Any, py_file: str) -> Any:
            if PACKAGE not in Path(py_file).resolve().parents:
                return None
            return super().from_function(py_func, py_file)

        def get_source_stamp(self) -> str:
            return package_digest()

    return PackageLocator


caching.CacheImpl._locator_classes[:0] = [
    _stamped_by_package(locator)
    for locator in (
        caching.UserProvidedCacheLocator,
        caching.InTreeCacheLocator,
        caching.UserWideCacheLocator,
    )
]

# Not "nnan" and "ninf": a non-finite state has to be noticed.
_FASTMATH = {"contract", "reassoc", "arcp", "nsz"}

#: Compile a kernel, to become a part of whatever calls it. Left as a function of its own, it would
#: be shared between compiled modules in a process that compiles and not in one that loads them from
#: the cache, and the two would differ by round-off.
kernel = numba.njit(fastmath=_FASTMATH, error_model="numpy", forceinline=True)

#: The same for recurrences, whose sums must keep the order in which their terms become known.
kernel_in_order = numba.njit(fastmath={"contract", "nsz"}, error_model="numpy", forceinline=True)

#: The same for what generic functions are resolved to.
RESOLVED: Any = {"forceinline": True}

#: Compile an entry point, called from Python and cached on disk.
entry = numba.njit(fastmath=_FASTMATH, error_model="numpy", cache=True, nogil=True)
