"""Sizes of arrays, declared at each entry point and compared before it runs.

Compiled code writes where an index points to, inside of an array or not. So an entry point says
what its arrays have to be, as in

    y (n), w (n), band (n, b), places (n, 3) int

A name stands for a number that is the same wherever it occurs; anything else in the place of one is
an expression of such names and of other arguments. Arrays hold floats, or what stands behind the
parenthesis: int or complex. The comparisons are compiled into the entry point, where they take
nanoseconds.
"""

import inspect
import re
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

from numba.core import types
from numba.extending import overload

_ARRAY = re.compile(r"([\w.]+) \(([^()]*)\)( int| complex)?(?:, |$)")


class Declared(NamedTuple):
    """An array of an entry point: its name, its sizes as they are written, and what it holds."""

    name: str
    sizes: tuple[str, ...]
    holds: str


def declared(sizes: str) -> tuple[Declared, ...]:
    """Return the arrays of a declaration.

    Raises
    ------
    ValueError
        It is none.
    """
    found = list(_ARRAY.finditer(sizes))
    if "".join(one.group() for one in found) != sizes:
        raise ValueError(f"{sizes!r} declares no arrays; write it like y (n), band (n, b)")
    return tuple(
        Declared(
            one[1], tuple(size.strip() for size in one[2].split(",")), (one[3] or "float").strip()
        )
        for one in found
    )


def checked(
    function: Callable[..., Any], sizes: str, where: Callable[..., Any] | None
) -> Callable[..., Any]:
    """Return the function behind a check of its arguments, which raises ValueError.

    Parameters
    ----------
    function : callable
        A kernel.
    sizes : str
        The declaration.
    where : callable, optional
        A kernel of arguments and sizes, by their names, that tells whether they go together.
    """
    arguments = list(inspect.signature(function).parameters)
    source = "\n    ".join(
        [
            f"def {function.__name__}({', '.join(arguments)}):",
            *_lines(function.__name__, arguments, sizes, where),
            f"return _unchecked({', '.join(arguments)})",
        ]
    )
    namespace: dict[str, Any] = {"_unchecked": function, "_go_together": where, **_HOLDS}
    exec(source, namespace)
    shell: Any = namespace[function.__name__]
    shell.__code__ = shell.__code__.replace(
        co_filename=function.__code__.co_filename, co_firstlineno=function.__code__.co_firstlineno
    )
    shell.__module__, shell.__qualname__ = function.__module__, function.__qualname__
    shell.__doc__, shell.sizes = function.__doc__, sizes
    return shell  # type: ignore[no-any-return]


def _lines(
    name: str, arguments: list[str], sizes: str, where: Callable[..., Any] | None
) -> Iterator[str]:
    """Yield the statements of a check."""
    known = set(arguments)

    def unless(condition: str, culprit: str) -> str:
        told = f"{name}: {culprit} not fit; it takes {sizes}"
        return f"if not ({condition}): raise ValueError({told!r})"

    for array in declared(sizes):
        yield unless(f"_holds_{array.holds}({array.name})", f"{array.name} does")
        for axis, size in enumerate(array.sizes):
            if size.isidentifier() and size not in known:
                yield f"{size} = {array.name}.shape[{axis}]"
                known.add(size)
            else:
                yield unless(f"{array.name}.shape[{axis}] == {size}", f"{array.name} does")
    if where is not None:
        asked = ", ".join(inspect.signature(where).parameters)
        yield unless(f"_go_together({asked})", f"{asked} do")


def _holding(dtype: types.Type) -> Callable[[Any], bool]:
    """Return the function that tells whether an array holds numbers of a type."""

    def holds(array: Any) -> bool:
        return bool(array.dtype == str(dtype))

    def holds_compiled(array: Any) -> Any:
        told = isinstance(array, types.Array) and array.dtype == dtype
        return (lambda array: True) if told else (lambda array: False)  # noqa: ARG005

    overload(holds, strict=False)(holds_compiled)
    return holds


_HOLDS = {
    "_holds_float": _holding(types.float64),
    "_holds_int": _holding(types.int64),
    "_holds_complex": _holding(types.complex128),
}
