"""Compilation of kernels and of the entry points that Python calls.

Kernels are inlined into entry points, and optimised there and nowhere else. What an entry point was
compiled to is kept on disk (`cache`), and whatever it is called with has to fit (`sizes`).
"""

from collections.abc import Callable
from typing import Any

import numba
from numba.core import codegen
from numba.extending import register_jitable

from undula.jit.cache import keep
from undula.jit.sizes import checked


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
#: Python it is what is written. Left as a function of its own, a kernel would be shared between
#: compiled modules in a process that compiles and not in one that loads them from the cache, and
#: the two would differ by round-off.
kernel = register_jitable(fastmath=FASTMATH, error_model="numpy", **RESOLVED)

#: The same for recurrences, whose sums must keep the order in which their terms become known.
kernel_in_order = register_jitable(fastmath={"contract", "nsz"}, error_model="numpy", **RESOLVED)


def entry(
    sizes: str, where: Callable[..., Any] | None = None
) -> Callable[[Callable[..., Any]], Any]:
    """Compile an entry point, called from Python and kept on disk, with a check of its arguments.

    Parameters
    ----------
    sizes : str
        The shapes of its arrays, see `undula.jit.sizes`.
    where : callable, optional
        What else has to hold for no index to leave its array: a function of arguments and sizes, by
        their names.
    """

    def compiled(function: Callable[..., Any]) -> Any:
        shell = checked(kernel(function), sizes, where and kernel(where))
        return keep(numba.njit(fastmath=FASTMATH, error_model="numpy", nogil=True)(shell))

    return compiled


@kernel
def overwrite(out: Any, values: Any) -> None:
    """Write values (n,) to out (n,). numba takes seconds to compile `out[:] = values`."""
    for i in range(out.shape[0]):
        out[i] = values[i]
