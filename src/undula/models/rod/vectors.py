"""Vectors of two or three numbers in compiled code, as tuples, which stay in registers.

A kernel that loops over the links keeps quantities of the last link in such vectors. Small arrays
would be allocated at every call, which takes as long as the arithmetic of a few links.
"""

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

from undula.jit.compilation import kernel


class Vectors(NamedTuple):
    """Vector arithmetic in two or three dimensions.

    Attributes
    ----------
    read : read(x, k)
        Return the vector that begins at x[k].
    write : write(x, k, u)
        Write a vector to x from x[k] on.
    plus, minus : plus(u, v)
        Return sum or difference.
    times : times(a, u)
        Return the product with a number.
    dot : dot(u, v)
        Return the scalar product.
    axis : tuple of float
        The direction of the clamp, e_z.
    """

    read: Callable[..., Any]
    write: Callable[..., Any]
    plus: Callable[..., Any]
    minus: Callable[..., Any]
    times: Callable[..., Any]
    dot: Callable[..., Any]
    axis: tuple[float, ...]


@cache
def vectors(dimension: int) -> Vectors:
    """Return the arithmetic of vectors in a plane (2) or in space (3)."""
    return {2: _in_a_plane, 3: _in_space}[dimension]()


def _in_a_plane() -> Vectors:
    @kernel
    def read(x: Any, k: Any) -> Any:
        return x[k], x[k + 1]

    @kernel
    def write(x: Any, k: Any, u: Any) -> None:
        x[k], x[k + 1] = u

    @kernel
    def plus(u: Any, v: Any) -> Any:
        return u[0] + v[0], u[1] + v[1]

    @kernel
    def minus(u: Any, v: Any) -> Any:
        return u[0] - v[0], u[1] - v[1]

    @kernel
    def times(a: Any, u: Any) -> Any:
        return a * u[0], a * u[1]

    @kernel
    def dot(u: Any, v: Any) -> Any:
        return u[0] * v[0] + u[1] * v[1]

    return Vectors(read, write, plus, minus, times, dot, (0.0, 1.0))


def _in_space() -> Vectors:
    @kernel
    def read(x: Any, k: Any) -> Any:
        return x[k], x[k + 1], x[k + 2]

    @kernel
    def write(x: Any, k: Any, u: Any) -> None:
        x[k], x[k + 1], x[k + 2] = u

    @kernel
    def plus(u: Any, v: Any) -> Any:
        return u[0] + v[0], u[1] + v[1], u[2] + v[2]

    @kernel
    def minus(u: Any, v: Any) -> Any:
        return u[0] - v[0], u[1] - v[1], u[2] - v[2]

    @kernel
    def times(a: Any, u: Any) -> Any:
        return a * u[0], a * u[1], a * u[2]

    @kernel
    def dot(u: Any, v: Any) -> Any:
        return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]

    return Vectors(read, write, plus, minus, times, dot, (0.0, 0.0, 1.0))
