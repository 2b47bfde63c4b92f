"""Compilation of kernels, with an on-disk cache that notices every change of what is compiled.

numba's own cache looks at the one file that holds a function, so an edited kernel would go on
running in its old form wherever another file calls it. Here every cached function is stamped with a
digest of all sources that compiled code is made of: any change of any of them makes all of it new.

Kernels are inlined into such functions, and optimised there and nowhere else.
"""

import hashlib
from functools import cache
from pathlib import Path
from typing import Any

import numba
from numba.core import caching, codegen
from numba.extending import register_jitable

PACKAGE = Path(__file__).resolve().parent


#: The floors that compiled code takes functions and constants from, in any of their files.
COMPILED_FLOORS = ("numerics", "models")
#: What a file elsewhere imports to have functions compiled.
_COMPILES = b"undula.compiled"


@cache
def kernel_digest() -> str:
    """Digest of every source that compiled code is made of: the version of that code."""
    digest = hashlib.sha256()
    for source in sorted(PACKAGE.rglob("*.py")):
        place, content = source.relative_to(PACKAGE), source.read_bytes()
        floor = place.parts[0] if len(place.parts) > 1 else None
        if floor in (None, *COMPILED_FLOORS) or _COMPILES in content:
            digest.update(place.as_posix().encode())
            digest.update(content)
    return digest.hexdigest()


def _stamped_by_package(locator: Any) -> Any:
    """Return numba's cache `locator`, restricted to this package and stamped with the digest."""

    class PackageLocator(locator):  # type: ignore[misc]
        @classmethod
        def from_function(cls, py_func: Any, py_file: str) -> Any:
            if PACKAGE not in Path(py_file).resolve().parents:
                return None
            return super().from_function(py_func, py_file)

        def get_source_stamp(self) -> str:
            return kernel_digest()

    return PackageLocator


caching.CacheImpl._locator_classes[:0] = [
    _stamped_by_package(locator)
    for locator in (
        caching.UserProvidedCacheLocator,
        caching.InTreeCacheLocator,
        caching.UserWideCacheLocator,
    )
]


class _Library(codegen.JITCodeLibrary):
    """A compiled library that leaves kernels to be optimised with what they become a part of.

    numba would optimise each of them by itself, and with it once more all that it has inlined,
    which takes a third of the time of compiling.
    """

    def _optimize_final_module(self) -> None:
        public = [
            list(function.attributes)
            for function in self._final_module.functions
            if not function.is_declaration and function.linkage.name == "external"
        ]
        kernels = [one for one in public if any(b"alwaysinline" in each for each in one)]
        if not kernels or len(kernels) < len(public):
            super()._optimize_final_module()  # type: ignore[no-untyped-call]


codegen.JITCPUCodegen._library_class = _Library

#: Not "nnan" and "ninf": a non-finite state has to be noticed.
FASTMATH = {"contract", "reassoc", "arcp", "nsz"}

#: What generic functions are resolved to becomes a part of what calls them.
RESOLVED: Any = {"forceinline": True, "no_cfunc_wrapper": True}

#: Make a function a kernel, which becomes a part of whatever compiled code calls it. Called from
#: Python it is what is written, and so are generic functions in it: only compiled code goes by the
#: type of a system. Left as a function of its own, a kernel would be shared between compiled
#: modules in a process that compiles and not in one that loads them from the cache, and the two
#: would differ by round-off.
kernel = register_jitable(fastmath=FASTMATH, error_model="numpy", **RESOLVED)

#: The same for recurrences, whose sums must keep the order in which their terms become known.
kernel_in_order = register_jitable(fastmath={"contract", "nsz"}, error_model="numpy", **RESOLVED)

#: Compile an entry point, called from Python and cached on disk.
entry = numba.njit(fastmath=FASTMATH, error_model="numpy", cache=True, nogil=True)


@kernel
def overwrite(out: Any, values: Any) -> None:
    """Write values (n,) to out (n,). numba takes seconds to compile `out[:] = values`."""
    for i in range(out.shape[0]):
        out[i] = values[i]
