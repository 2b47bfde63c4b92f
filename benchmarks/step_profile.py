"""Where the time of a step goes: each part beside the least that it could take.

Run with `make bench`, or `python benchmarks/step_profile.py`. Flapping at F = 200 and rtol 1e-6,
whose matrix is that of motions in a plane; that of motions in space stands beside it. Floors are
LAPACK's banded factorisation and solution (dgbtrf, dgbtrs) of the same size and band, and the
arithmetic at the rate that this processor reaches in a sum of products of arrays in its nearest
cache. Everything in one process on one thread; the best of several repetitions.
"""
# ruff: noqa: ARG001
# (loops over parts give all of them the same arguments, used or not)

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import time
from typing import Any

import numba
import numpy as np

import undula as un
from contenders import page
from contenders.lapack import REPEATED, best, lapack
from contenders.orbits import AZIMUTH, Orbit, orbit
from undula.analysis.run_settings import Schedule
from undula.analysis.runs.simulation import Simulation
from undula.jit.compilation import FASTMATH
from undula.numerics.integration import stepper_state as names
from undula.numerics.integration.matrices import (
    factor,
    planar_factor,
    planar_solve,
    planar_structure_of,
    solve,
    structure_of,
)
from undula.numerics.integration.system import matrix, planar_matrix, plane, rates, residual, rotate
from undula.numerics.integration.time_loop import advance
from undula.numerics.linalg.banded import Structure, filled

SEGMENTS, RTOL, BEATS = (20, 40, 100), 1e-6, 20
NEVER = np.iinfo(np.int64).max
#: Additions and multiplications a node of a filament in space, counted in the sources.
RESIDUAL_COUNT, MATRIX_COUNT, PLANAR_MATRIX_COUNT = 113, 165, 118

#: Compile a part of a step, to be repeated in a loop.
part = numba.njit(fastmath=FASTMATH, error_model="numpy", forceinline=True)


@part
def _residual(system: Any, y: Any, w: Any, band: Any, out: Any) -> None:
    residual(system, y, w, 1e-5, out)


@part
def _matrix(system: Any, y: Any, w: Any, band: Any, out: Any) -> None:
    matrix(system, y, w, 1e-5, 0.0, band)


@part
def _matrix_and_factor(system: Any, y: Any, w: Any, band: Any, out: Any) -> None:
    matrix(system, y, w, 1e-5, 0.0, band)
    factor(system, band)


@part
def _solve(system: Any, y: Any, w: Any, band: Any, out: Any) -> None:
    out[0] = 1.0  # so that numbers stay of one size
    solve(system, band, out)


@part
def _plane(system: Any, y: Any, w: Any, band: Any, out: Any) -> None:
    out[0], out[1] = plane(system, y, w)


@part
def _turning(system: Any, y: Any, w: Any, band: Any, out: Any) -> None:
    rotate(system, y, 0.3, out)


@part
def _planar_matrix(system: Any, y: Any, w: Any, band: Any, out: Any) -> None:
    planar_matrix(system, y, w, AZIMUTH, 1e-5, band)


@part
def _planar_matrix_and_factor(system: Any, y: Any, w: Any, band: Any, out: Any) -> None:
    planar_matrix(system, y, w, AZIMUTH, 1e-5, band)
    planar_factor(system, band)


@part
def _planar_solve(system: Any, y: Any, w: Any, band: Any, out: Any) -> None:
    out[0] = 1.0
    planar_solve(system, band, out)


@part
def _rates(system: Any, y: Any, w: Any, band: Any, out: Any) -> None:
    rates(system, y, w, out)


@numba.njit(fastmath=True)
def products(calls: Any, a: Any, b: Any) -> Any:
    """Sum products of arrays: two operations an entry."""
    total = 0.0
    for _ in range(calls):
        for i in range(a.size):
            total += a[i] * b[i]
        a[0] = total * 1e-30
    return total


def repeated(part: Any) -> Any:
    """Return a compiled loop over a part, which is inlined as in a step."""

    @numba.njit
    def loop(calls: Any, system: Any, y: Any, w: Any, band: Any, out: Any) -> None:
        for _ in range(calls):
            part(system, y, w, band, out)

    return loop


def parts(model: un.Filament, exact: Orbit) -> dict[str, float]:
    """Time the parts of a step at a state of the beat [us]."""
    y, b = model.unknowns(exact.start), model.system.half_bandwidth
    w = model.unknowns(exact.at(np.array([1e-4]))[0] - exact.start) * model.position_mask
    given = (model.system, y, w, np.zeros((y.size, 2 * b + 1)), np.zeros(y.size))
    took = {
        name: best(repeated(part), *given)
        for name, part in {
            "residual": _residual,
            "matrix": _matrix,
            "factor": _matrix_and_factor,
            "solve": _solve,
            "plane": _plane,
            "planar matrix": _planar_matrix,
            "planar factor": _planar_matrix_and_factor,
            "planar solve": _planar_solve,
            "turning": _turning,
            "rates": _rates,
        }.items()
    }
    took["factor"] -= took["matrix"]
    took["planar factor"] -= took["planar matrix"]
    return took


def peak() -> float:
    """Return the operations a microsecond of sums of products."""
    a, b = np.ones(2000), np.ones(2000)
    return 2.0 * a.size / best(products, a, b)


def beats(model: un.Filament, exact: Orbit) -> tuple[float, Any]:
    """Return the microseconds of a step in the middle of a run, and the counts of a step."""
    schedule = Schedule(rtol=RTOL)
    options = schedule.options(model)._replace(frame=0)
    span, taken = BEATS / exact.frequency, []
    for _ in range(REPEATED):
        memory = Simulation.begin(model, exact.start, schedule).memory
        states = np.empty((1, memory.differences.shape[1]))
        sections = np.empty((0, 1 + states.shape[1]))
        advance(model.system, memory, options, np.array([0.1 * span]), states, sections, NEVER)
        before = memory.count.copy()
        begun = time.process_time()
        advance(model.system, memory, options, np.array([span]), states, sections, NEVER)
        taken.append(time.process_time() - begun)
    count = memory.count - before
    return 1e6 * min(taken) / int(count[names.STEPS]), count / count[names.STEPS]


def banded_operations(structure: Structure) -> tuple[int, int]:
    """Return the operations a block of a factorisation and of a solution."""
    rows = filled(structure)
    beside = sum(len(lower) + len(upper) for lower, upper in rows)
    # Eliminating takes a product and a difference for each pair; then the row is divided.
    eliminating = sum(2 * len(rows[c][1]) for lower, _ in rows for _, c in lower)
    return eliminating + beside, 2 * beside + len(rows)


def profile(segments: int, rate: float) -> list[list[str]]:
    """Return the rows of the table for a number of segments."""
    exact = orbit("undula", segments, "flapping")
    model: Any = exact.model
    step, count = beats(model, exact)
    took, floor = parts(model, exact), lapack(4 * segments, model.system.half_bandwidth)
    made, solved = count[names.FACTORISATIONS], count[names.SOLVES]
    # A residual is turned into the plane and its solution back, a state once more to be kept.
    times = {
        "residual": solved,
        "plane": made,
        "planar matrix": made,
        "planar factor": made,
        "planar solve": solved,
        "turning": 2.0 * solved + made,
        "rates": 1.0,
    }
    in_space, in_plane = structure_of(type(model.system)), planar_structure_of(type(model.system))
    assert in_plane is not None
    operations = {
        "residual": RESIDUAL_COUNT,
        "matrix": MATRIX_COUNT,
        "planar matrix": PLANAR_MATRIX_COUNT,
    }
    operations["factor"], operations["solve"] = banded_operations(in_space)
    operations["planar factor"], operations["planar solve"] = banded_operations(in_plane)
    told = []
    for part, each in took.items():
        least = segments * operations[part] / rate if part in operations else np.nan
        told.append(
            [
                str(segments),
                part,
                f"{times[part]:.2f}" if part in times else "in space",
                f"{each:.2f}",
                f"{each * times[part]:.2f}" if part in times else "",
                f"{floor[part]:.2f}" if part in floor else "",
                f"{least:.2f}" if part in operations else "",
            ]
        )
    rest = step - sum(times[part] * took[part] for part in times)
    told.append([str(segments), "control and the rest", "1", "", f"{rest:.2f}", "", ""])
    bound = made * floor["factor"] + solved * floor["solve"]
    told.append(
        [
            str(segments),
            "**step**",
            "",
            "",
            f"**{step:.2f}**",
            f"{bound:.2f}: step / floor = **{step / bound:.2f}**",
            "",
        ]
    )
    return told


def main() -> None:
    """Measure and write."""
    rate = peak()
    rows = [row for segments in SEGMENTS for row in profile(segments, rate)]
    heading = [
        "segments",
        "part",
        "times a step",
        "us",
        "us a step",
        "LAPACK, us",
        "arithmetic, us",
    ]
    told = page.table(heading, rows)
    print(f"sums of products: {rate / 1e3:.1f} operations a nanosecond\n{told}")
    page.keep("step-profile", {"rows": [heading, *rows], "rate": rate, "machine": page.machine()})
    page.write(
        "step profile", f"{told}\n\nSums of products: {rate / 1e3:.1f} operations a nanosecond."
    )


if __name__ == "__main__":
    main()
