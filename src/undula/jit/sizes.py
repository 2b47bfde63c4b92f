"""Declared shapes and types of the arrays of an entry point, checked before it runs.

Compiled code does not check that an index is inside its array. Therefore each entry point declares
its arrays, as in

    y (n), w (n), band (n, b), places (n, 3) int

A name stands for one number throughout the declaration. Any other size is an expression of such
names and of other arguments. Arrays hold floats, or the type after the parenthesis: int or complex.
The checks are compiled into the entry point and take nanoseconds.
"""

import inspect
import re
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

from numba.core import types
from numba.extending import overload

_ARRAY = re.compile(r"([\w.]+) \(([^()]*)\)( int| complex)?(?:, |$)")


class DeclaredArray(NamedTuple):
    """An array of an entry point.

    Attributes
    ----------
    name : str
        Name of the argument, or of a field of a record, as ``stepper.real``.
    sizes : tuple of str
        Its shape: names and expressions.
    dtype : {"float", "int", "complex"}
        Type of its numbers.
    """

    name: str
    sizes: tuple[str, ...]
    dtype: str


def parse_declaration(sizes: str) -> tuple[DeclaredArray, ...]:
    """Return the arrays of a declaration.

    Parameters
    ----------
    sizes : str
        The declaration.

    Returns
    -------
    tuple of DeclaredArray
        Its arrays, in order.

    Raises
    ------
    ValueError
        The text is not a declaration.
    """
    matches = list(_ARRAY.finditer(sizes))
    if "".join(match.group() for match in matches) != sizes:
        raise ValueError(f"{sizes!r} declares no arrays; write it like y (n), band (n, b)")
    return tuple(
        DeclaredArray(
            match[1],
            tuple(size.strip() for size in match[2].split(",")),
            (match[3] or "float").strip(),
        )
        for match in matches
    )


def with_argument_check(
    function: Callable[..., Any], sizes: str, where: Callable[..., Any] | None
) -> Callable[..., Any]:
    """Return a function that checks its arguments and then calls a kernel.

    It is compiled from generated source, as numba needs the names of all arguments.

    Parameters
    ----------
    function : callable
        The kernel.
    sizes : str
        The declaration.
    where : callable, optional
        A kernel of arguments and sizes, by their names, that returns whether they fit one another.

    Returns
    -------
    callable
        A Python function with the name, the docstring and the arguments of `function`. It raises
        ValueError for arguments that do not fit.
    """
    arguments = list(inspect.signature(function).parameters)
    source = "\n    ".join(
        [
            f"def {function.__name__}({', '.join(arguments)}):",
            *_lines(function.__name__, arguments, sizes, where),
            f"return _unchecked({', '.join(arguments)})",
        ]
    )
    namespace: dict[str, Any] = {"_unchecked": function, "_condition": where, **_HOLDS}
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
    """Yield the statements that check the arguments."""
    defined = set(arguments)

    def unless(condition: str, culprit: str) -> str:
        message = f"{name}: {culprit} not fit; it takes {sizes}"
        return f"if not ({condition}): raise ValueError({message!r})"

    for array in parse_declaration(sizes):
        yield unless(f"_holds_{array.dtype}({array.name})", f"{array.name} does")
        for axis, size in enumerate(array.sizes):
            if size.isidentifier() and size not in defined:
                yield f"{size} = {array.name}.shape[{axis}]"
                defined.add(size)
            else:
                yield unless(f"{array.name}.shape[{axis}] == {size}", f"{array.name} does")
    if where is not None:
        names = ", ".join(inspect.signature(where).parameters)
        yield unless(f"_condition({names})", f"{names} do")


def _holding(dtype: types.Type) -> Callable[[Any], bool]:
    """Return a function that returns whether an array holds numbers of a type."""

    def holds(array: Any) -> bool:
        return bool(array.dtype == str(dtype))

    def holds_compiled(array: Any) -> Any:
        matches = isinstance(array, types.Array) and array.dtype == dtype
        return (lambda array: True) if matches else (lambda array: False)  # noqa: ARG005

    overload(holds, strict=False)(holds_compiled)
    return holds


_HOLDS = {
    "_holds_float": _holding(types.float64),
    "_holds_int": _holding(types.int64),
    "_holds_complex": _holding(types.complex128),
}
