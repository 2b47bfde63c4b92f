"""General-purpose stiff solvers, called as their users call them, on the textbook's equations.

Every `Solver` takes a rod, a start, increasing times of which the first is 0, and a relative
tolerance, and returns the states at these times. Absolute tolerances are a tenth of the relative
ones, lengths being 1: the best for them of those tried (see docs/benchmarks.md).
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.integrate import odeint, solve_ivp
from scipy.sparse import csc_array, dia_array

from contenders import compiled, textbook
from contenders.textbook import HALF_BANDWIDTH, Array, Rod

#: atol / rtol.
ABSOLUTE = 0.1
_DIAGONALS = np.arange(HALF_BANDWIDTH, -HALF_BANDWIDTH - 1, -1)
Run = Callable[[Rod, Array, Array, float], Array]


@dataclass(frozen=True)
class Solver:
    """A contender: its name, the method whose tolerances it shares, and how it runs."""

    name: str
    method: str
    run: Run


def sparse(x: Array, rod: Rod) -> csc_array:
    """Return the Jacobian as scipy's implicit methods want it."""
    return dia_array((compiled.band(x, rod), _DIAGONALS), shape=(x.size, x.size)).tocsc()


def pattern(size: int) -> csc_array:
    """Return where the Jacobian is not 0."""
    return dia_array((np.ones((_DIAGONALS.size, size)), _DIAGONALS), shape=(size, size)).tocsc()


def by_scipy(method: str, given: str, rhs: Callable[[Array, Rod], Array] = compiled.rhs) -> Run:
    """Return how `solve_ivp` runs with nothing, the sparsity, the band, or the Jacobian given."""

    def run(rod: Rod, x: Array, times: Array, rtol: float) -> Array:
        more: dict[str, Any] = {}
        if given == "sparsity":
            more["jac_sparsity"] = pattern(x.size)
        if given == "jacobian":
            more["jac"] = lambda _, x: sparse(x, rod)
        if given.startswith("band"):
            more |= {"lband": HALF_BANDWIDTH, "uband": HALF_BANDWIDTH}
        if given == "band, jacobian":
            more["jac"] = lambda _, x: compiled.band(x, rod)
        solved = solve_ivp(
            lambda _, x: rhs(x, rod),
            (0.0, times[-1]),
            x,
            method=method,
            t_eval=times,
            rtol=rtol,
            atol=ABSOLUTE * rtol,
            **more,
        )
        if not solved.success:
            raise RuntimeError(solved.message)
        return np.asarray(solved.y.T)

    return run


def by_odeint(rod: Rod, x: Array, times: Array, rtol: float) -> Array:
    """Run scipy's older interface to LSODA, whose loop over steps is compiled."""
    states, told = odeint(
        lambda _, x: compiled.rhs(x, rod),
        x,
        times,
        Dfun=lambda _, x: compiled.band(x, rod),
        ml=HALF_BANDWIDTH,
        mu=HALF_BANDWIDTH,
        rtol=rtol,
        atol=ABSOLUTE * rtol,
        mxstep=10_000_000,
        tfirst=True,
        full_output=True,
    )
    if told["message"] != "Integration successful.":
        raise RuntimeError(told["message"])
    return np.asarray(states)


def by_cvode(given: str) -> Run:
    """Return how CVODE runs with a dense or a banded matrix, by differences or given."""

    def run(rod: Rod, x: Array, times: Array, rtol: float) -> Array:
        from sksundae.cvode import CVODE  # of an extra that the tests do without

        def rhs(_: float, x: Array, out: Array) -> None:
            out[:] = compiled.rhs(x, rod)

        def jacobian(_: float, x: Array, __: Array, out: Array) -> None:
            compiled.fill(compiled.band(x, rod), out)

        more: dict[str, Any] = {"linsolver": "dense" if given == "dense" else "band"}
        if given != "dense":
            more |= {"lband": HALF_BANDWIDTH, "uband": HALF_BANDWIDTH}
        if given == "band, jacobian":
            more["jacfn"] = jacobian
        solver = CVODE(rhs, rtol=rtol, atol=ABSOLUTE * rtol, max_num_steps=10_000_000, **more)
        solved = solver.solve(times, x)
        if not solved.success:
            raise RuntimeError(solved.message)
        return np.asarray(solved.y)

    return run


def solvers() -> list[Solver]:
    """Return all contenders that are general-purpose solvers."""
    found = []
    for method in ("BDF", "Radau"):
        name = f"scipy {method}"
        found += [
            Solver(f"{name}, numpy", method, by_scipy(method, "nothing", textbook.rhs)),
            Solver(f"{name}, compiled", method, by_scipy(method, "nothing")),
            Solver(f"{name}, compiled, sparsity", method, by_scipy(method, "sparsity")),
            Solver(f"{name}, compiled, sparse Jacobian", method, by_scipy(method, "jacobian")),
        ]
    found += [
        Solver("scipy LSODA, numpy", "LSODA", by_scipy("LSODA", "nothing", textbook.rhs)),
        Solver("scipy LSODA, compiled", "LSODA", by_scipy("LSODA", "nothing")),
        Solver("scipy LSODA, compiled, band", "LSODA", by_scipy("LSODA", "band")),
        Solver(
            "scipy LSODA, compiled, band, Jacobian", "LSODA", by_scipy("LSODA", "band, jacobian")
        ),
        Solver("scipy odeint, compiled, band, Jacobian", "LSODA", by_odeint),
        Solver("CVODE, compiled, dense", "CVODE", by_cvode("dense")),
        Solver("CVODE, compiled, band", "CVODE", by_cvode("band")),
        Solver("CVODE, compiled, band, Jacobian", "CVODE", by_cvode("band, jacobian")),
    ]
    return found
