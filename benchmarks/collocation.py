"""Would fewer, dearer steps do? Collocation on the filament's own equations, in counts.

Run with `python benchmarks/collocation.py`. Beats at F = 200 with 20 links, from a state on the
exact beat, with equal steps of Radau IIA (2 to 5 stages, orders 3 to 9, which keep their order on
systems with constraints). The stages of a step are solved for by Newton's method with one matrix a
step, made at its middle, from the last step's polynomial. What comes out is the error of the
frequency and the corrections a step; dense matrices do for counting. What follows for times is in
docs/notes/stepping.md.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from typing import Any

import numba
import numpy as np

from contenders import page
from contenders.orbits import Orbit, orbit
from contenders.windows import instants
from undula.arrays import Array
from undula.numerics.integration.matrices import derivative_half_bandwidth
from undula.numerics.integration.system import derivative, residual
from undula.numerics.linalg.banded import to_dense
from undula.numerics.orbits.radau import Radau, interpolation, radau

SEGMENTS, BEATS = 20, 3
STAGES, STEPS = (2, 3, 4, 5), (12, 16, 20, 24, 28, 36)
#: Corrections end below this [L]; a step that takes more of them has no solution.
NEGLIGIBLE, MOST = 1e-6, 25


@numba.njit
def _residual(system: Any, y: Any, w: Any, c: Any, out: Any) -> None:
    residual(system, y, w, c, out)


@numba.njit
def _derivative(system: Any, y: Any, w: Any, c: Any, band: Any) -> None:
    derivative(system, y, w, c, 0.0, band)


def slope(model: Any, y: Array, w: Array, c: float) -> Array:
    """Return the derivative of the residual along dw = dy as a dense matrix."""
    half = derivative_half_bandwidth(type(model.system))
    band = np.zeros((y.size, 2 * half + 1))
    _derivative(model.system, y, w, c, band)
    return to_dense(band)


def step(model: Any, method: Radau, h: float, y: Array, guess: Array) -> tuple[Array, int]:
    """Return the stages (s, n) of a step of length h from y (n,), and the corrections it took."""
    s, mask, table = method.stages, model.position_mask, method.differentiation

    def moved(stages: Array) -> Array:
        return np.asarray(table @ np.vstack([y, stages]) * mask)

    stages, middle = guess.copy(), s // 2
    whole = slope(model, stages[middle], moved(stages)[middle], h)
    drag = slope(model, stages[middle], np.zeros(y.size), 0.0) * mask[:, None] * mask
    joined = np.kron(table[:, 1:], drag) + np.kron(np.eye(s), whole - drag)
    inverse = np.linalg.inv(joined)
    for corrections in range(1, MOST + 1):
        w, left = moved(stages), np.empty((s, y.size))
        for i in range(s):
            _residual(model.system, stages[i], w[i], h, left[i])
        change = (inverse @ left.ravel()).reshape(s, y.size)
        stages -= change
        if np.abs(change * mask).max() < NEGLIGIBLE:
            return stages, corrections
        if not np.abs(stages).max() < 1e6:
            break
    raise RuntimeError("Newton's method does not converge")


def beat(exact: Orbit, method: Radau, steps: int) -> tuple[float, float]:
    """Return the error of the frequency, and the corrections a step."""
    model: Any = exact.model
    h = 1.0 / (exact.frequency * steps)
    ahead = interpolation(method.grid, 1.0 + method.nodes)
    y = model.unknowns(exact.start)
    guess, states, taken = np.tile(y, (method.stages, 1)), [exact.start], []
    for _ in range(BEATS * steps):
        stages, corrections = step(model, method, h, y, guess)
        guess, y = ahead @ np.vstack([y, stages]), stages[-1]
        states.append(model.positions(y))
        taken.append(corrections)
    times = np.arange(len(states)) * h
    every = np.searchsorted(times, instants(exact, BEATS) - 0.5 * h)  # the nearest steps
    return exact.frequency_error(times[every], np.array(states)[every]), float(np.mean(taken))


def main() -> None:
    """Print and keep the table."""
    exact, rows = orbit("undula", SEGMENTS, "flapping"), []
    for stages in STAGES:
        row = [str(stages)]
        for steps in STEPS:
            try:
                error, corrections = beat(exact, radau(stages), steps)
                row.append(f"{error:.0e} ({corrections:.1f})")
            except RuntimeError:
                row.append("-")
        rows.append(row)
    told = page.table(["stages", *(f"{steps} steps a beat" for steps in STEPS)], rows)
    print(told)
    page.keep("collocation", {"table": told, "machine": page.machine()})


if __name__ == "__main__":
    main()
