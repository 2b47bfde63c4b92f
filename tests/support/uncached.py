"""Compiled entry points for what the tests define, which the cache on disk does not hold."""

import numba

from undula.jit.compilation import FASTMATH

uncached = numba.njit(fastmath=FASTMATH, error_model="numpy")
