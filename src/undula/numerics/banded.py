"""Banded linear systems: factor once, solve often.

A matrix A with half-bandwidth b is stored by rows, `band[i, j - i + b] = A[i, j]`, so `band` has
shape (n, 2 b + 1) and is zero where a row sticks out of the matrix. Factors are computed in place
without pivoting: the saddle-point matrices of constrained filaments need none, and a pivot that
vanishes is reported.

The factors are A = D L U with unit triangles L, U and D the pivots (stored inverted): then both
sweeps of a solve cost one multiply-add of latency a row. A row is eliminated while it sits in
registers, which takes straight-line code; that is why the kernels are written out for each b.
"""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from undula.compiled import kernel_in_order


def _factor_source(b: int) -> str:
    """Python source of `factor`, with the elimination of a row written out."""
    load = "; ".join(f"r{j} = band[i, {j}]" for j in range(2 * b + 1))
    eliminate = "\n".join(
        f"        r{m + j} -= r{m} * band[i - {b - m}, {b + j}]"
        for m in range(b)
        for j in range(1, b + 1)
    )
    store = "\n".join(f"        band[i, {j}] = r{j} * inverse" for j in range(2 * b + 1) if j != b)
    return f"""
def factor(band):
    n = band.shape[0]
    for i in range(min({b}, n)):
        for m in range({b} - i, {b}):
            for j in range(1, {b} + 1):
                band[i, m + j] -= band[i, m] * band[i - {b} + m, {b} + j]
        if not abs(band[i, {b}]) > 0.0:
            return False
        inverse = 1.0 / band[i, {b}]
        for j in range({2 * b + 1}):
            band[i, j] *= inverse
        band[i, {b}] = inverse
    for i in range({b}, n):
        {load}
{eliminate}
        if not abs(r{b}) > 0.0:
            return False
        inverse = 1.0 / r{b}
{store}
        band[i, {b}] = inverse
    return True
"""


def _solve_source(b: int) -> str:
    """Python source of `solve`: the nearest unknown is subtracted last, as it is known last."""
    forward = " ".join(f"- band[i, {m}] * x[i - {b - m}]" for m in range(b))
    backward = " ".join(f"- band[i, {b + j}] * x[i + {j}]" for j in range(b, 0, -1))
    return f"""
def solve(band, x):
    n = band.shape[0]
    for i in range(min({b}, n)):
        x[i] *= band[i, {b}]
        for m in range({b} - i, {b}):
            x[i] -= band[i, m] * x[i - {b} + m]
    for i in range({b}, n):
        x[i] = x[i] * band[i, {b}] {forward}
    for i in range(n - 1, max(n - 1 - {b}, -1), -1):
        for j in range(1, n - i):
            x[i] -= band[i, {b} + j] * x[i + j]
    for i in range(n - 1 - {b}, -1, -1):
        x[i] = x[i] {backward}
"""


def _written_out(source: str, name: str) -> Callable[..., Any]:
    namespace: dict[str, Any] = {}
    exec(source, namespace)
    return kernel_in_order(namespace[name])


@cache
def factor_kernel(half_bandwidth: int) -> Callable[..., Any]:
    """Return a compiled `factor(band) -> bool`: factors in place, False where a pivot vanishes."""
    return _written_out(_factor_source(half_bandwidth), "factor")


@cache
def solve_kernel(half_bandwidth: int) -> Callable[..., Any]:
    """Return a compiled `solve(band, x)`: overwrite the right-hand side x (n,) by the solution."""
    return _written_out(_solve_source(half_bandwidth), "solve")


def to_dense(band: np.ndarray) -> np.ndarray:
    """Return the (n, n) matrix that `band` (n, 2 b + 1) holds."""
    n, width = band.shape
    b = width // 2
    dense = np.zeros((n, n))
    for offset in range(-b, b + 1):
        rows = np.arange(max(0, -offset), min(n, n - offset))
        dense[rows, rows + offset] = band[rows, b + offset]
    return dense
