"""LAPACK's banded factorisation and solution, called from compiled code as a stepper would."""

import ctypes
import time
from collections.abc import Callable
from typing import Any

import numba
import numpy as np
from numba.extending import get_cython_function_address

REPEATED, CALLS = 9, 2000


def best(act: Callable[..., object], *given: Any) -> float:
    """Return the microseconds of one of the calls of a compiled loop."""
    act(1, *given)
    taken = []
    for _ in range(REPEATED):
        begun = time.process_time()
        act(CALLS, *given)
        taken.append(time.process_time() - begun)
    return 1e6 * min(taken) / CALLS


def _lapack(name: str, arguments: int) -> Any:
    """Return a routine of LAPACK for compiled code; all its arguments are pointers."""
    address = get_cython_function_address("scipy.linalg.cython_lapack", name)
    return ctypes.CFUNCTYPE(None, *[ctypes.c_void_p] * arguments)(address)


dgbtrf, dgbtrs = _lapack("dgbtrf", 8), _lapack("dgbtrs", 11)


@numba.njit
def lapack_factor(calls: Any, whole: Any, ab: Any, sizes: Any, pivots: Any) -> None:
    """Copy and factor a band: n, b, its rows in `ab` and a place for what LAPACK reports."""
    n, b, rows, info = sizes[0:], sizes[1:], sizes[2:], sizes[3:]
    for _ in range(calls):
        ab[:] = whole
        dgbtrf(
            n.ctypes,
            n.ctypes,
            b.ctypes,
            b.ctypes,
            ab.ctypes,
            rows.ctypes,
            pivots.ctypes,
            info.ctypes,
        )


@numba.njit
def copy(calls: Any, whole: Any, ab: Any) -> None:
    """Copy a band, which is no part of factoring it."""
    for _ in range(calls):
        ab[:] = whole


@numba.njit
def lapack_solve(calls: Any, ab: Any, sizes: Any, pivots: Any, no: Any, right: Any) -> None:
    """Solve for one right-hand side."""
    n, b, rows, info, one = sizes[0:], sizes[1:], sizes[2:], sizes[3:], sizes[4:]
    for _ in range(calls):
        right[0] = 1.0
        dgbtrs(
            no.ctypes,
            n.ctypes,
            b.ctypes,
            b.ctypes,
            one.ctypes,
            ab.ctypes,
            rows.ctypes,
            pivots.ctypes,
            right.ctypes,
            n.ctypes,
            info.ctypes,
        )


def lapack(n: int, b: int) -> dict[str, float]:
    """Time LAPACK's factorisation and solution of a band [us]."""
    whole = np.zeros((n, 3 * b + 1))  # the transpose of what the library calls a band
    whole[:, b:] = np.random.default_rng(1).normal(size=(n, 2 * b + 1))
    whole[:, 2 * b] += 10.0
    ab, pivots = whole.copy(), np.zeros(n, dtype=np.int32)
    sizes = np.array([n, b, 3 * b + 1, 0, 1], dtype=np.int32)
    took = best(lapack_factor, whole, ab, sizes, pivots) - best(copy, whole, ab)
    lapack_factor(1, whole, ab, sizes, pivots)
    no, right = np.frombuffer(b"N", dtype=np.uint8).copy(), np.ones(n)
    found = {"factor": took, "solve": best(lapack_solve, ab, sizes, pivots, no, right)}
    if sizes[3] != 0:
        raise RuntimeError(f"LAPACK reports {sizes[3]}")
    return found
