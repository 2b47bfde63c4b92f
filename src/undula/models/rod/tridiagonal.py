"""Tridiagonal linear systems."""

from typing import Any

from undula.jit.compilation import kernel


@kernel
def solve_tridiagonal(lower: Any, diagonal: Any, upper: Any, x: Any) -> None:
    """Overwrite x (n,) by the solution, without pivoting; the matrix is overwritten too."""
    n = x.shape[0]
    for i in range(1, n):
        factor = lower[i] / diagonal[i - 1]
        diagonal[i] -= factor * upper[i - 1]
        x[i] -= factor * x[i - 1]
    x[n - 1] /= diagonal[n - 1]
    for i in range(n - 2, -1, -1):
        x[i] = (x[i] - upper[i] * x[i + 1]) / diagonal[i]
