"""Compilation of kernels, and of the entry points that Python calls.

Kernels are inlined into entry points and optimised only there. The machine code of an entry point
is kept on disk (`undula.jit.cache`). An entry point checks the shapes and types of its arguments
(`undula.jit.sizes`).
"""

from collections.abc import Callable
from typing import Any

import numba
from numba.core import codegen
from numba.extending import register_jitable

from undula.jit.cache import keep_on_disk
from undula.jit.sizes import with_argument_check


class _Library(codegen.JITCodeLibrary):
    """A compiled library that does not optimise kernels by themselves.

    By default numba optimises each kernel together with all that it has inlined. As every kernel is
    inlined and optimised again in its entry point, this would cost a third of the compilation time.
    """

    def _optimize_final_module(self) -> None:
        public = [
            list(function.attributes)
            for function in self._final_module.functions
            if not function.is_declaration and function.linkage.name == "external"
        ]
        kernels = [
            attributes
            for attributes in public
            if any(b"alwaysinline" in attribute for attribute in attributes)
        ]
        if not kernels or len(kernels) < len(public):
            super()._optimize_final_module()  # type: ignore[no-untyped-call]


codegen.JITCPUCodegen._library_class = _Library

#: LLVM's fast-math flags. "nnan" and "ninf" are left out: non-finite states must be detected.
FASTMATH = {"contract", "reassoc", "arcp", "nsz"}

#: Options of kernels and of implementations of generic functions, which are inlined into callers.
RESOLVED: Any = {"forceinline": True, "no_cfunc_wrapper": True}

#: Decorator that makes a function a kernel, inlined into the compiled code that calls it. Called
#: from Python, a kernel runs as plain Python. Kernels have to be inlined: a function of its own
#: would be shared between compiled modules in a process that compiles, but not in one that loads
#: them from the cache, and their results would differ by round-off.
kernel = register_jitable(fastmath=FASTMATH, error_model="numpy", **RESOLVED)

#: The same for recurrences, whose sums must keep the order of their terms.
kernel_in_order = register_jitable(fastmath={"contract", "nsz"}, error_model="numpy", **RESOLVED)


def entry(
    sizes: str, where: Callable[..., Any] | None = None
) -> Callable[[Callable[..., Any]], Any]:
    """Return a decorator that compiles an entry point with a check of its arguments.

    An entry point is called from Python, and its machine code is kept on disk.

    Parameters
    ----------
    sizes : str
        Shapes and types of its arrays, in the notation of `undula.jit.sizes`.
    where : callable, optional
        Further condition for every index to stay inside its array: a function of arguments and
        sizes, by their names.

    Returns
    -------
    callable
        The decorator.

    Raises
    ------
    ValueError
        Raised by the decorated function if an argument does not fit the declaration, and by the
        decorator if `sizes` is not a declaration.
    """

    def compiled(function: Callable[..., Any]) -> Any:
        shell = with_argument_check(kernel(function), sizes, where and kernel(where))
        return keep_on_disk(numba.njit(fastmath=FASTMATH, error_model="numpy", nogil=True)(shell))

    return compiled


@kernel
def overwrite(out: Any, values: Any) -> None:
    """Write values (n,) to out (n,); numba takes seconds to compile `out[:] = values`."""
    for i in range(out.shape[0]):
        out[i] = values[i]
