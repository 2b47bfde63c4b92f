"""Whole transients: from a kick until the motion has grown up."""

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

import undula as un
from contenders import page
from contenders.orbits import FORCES, model_of
from contenders.ours import stepped
from contenders.solvers import solvers
from contenders.textbook import Array, textbook
from contenders.windows import OURS, method_of

#: Ends [T], some 25 periods each; the contenders, one of each kind that serves.
ENDS = {"spinning": 0.3, "flapping": 0.1}
CONTENDERS = (
    "scipy BDF, numpy",
    "scipy BDF, compiled, sparse Jacobian",
    "scipy LSODA, compiled, band, Jacobian",
    "scipy odeint, compiled, band, Jacobian",
    "CVODE, compiled, band, Jacobian",
)
#: Reference: undula's integrator on the same discretisation, at this tolerance.
TIGHT = 1e-9


@dataclass(frozen=True)
class Kick:
    """A run from a kick."""

    name: str
    motion: str
    segments: int
    rtol: float
    seconds: float
    tip_error: float  # largest distance from the reference [L]


def measure(
    motion: str,
    segments: int,
    tolerance: Callable[[str, str, int], float],
    *,
    short: bool,
) -> list[Kick]:
    """Run the contenders from the same kick, with the tolerances of their windows."""
    found = []
    for names, layout in ((CONTENDERS[short:], "textbook"), (OURS, "undula")):
        model = model_of(layout, segments, FORCES[motion])
        start = model.admissible(un.kicked(model))
        times = np.linspace(0.0, ENDS[motion], 401)
        states = stepped(turning=False)(model, start, times, TIGHT)[1]
        for name in names:
            rtol = tolerance(method_of(name), motion, segments)
            found.append(_run(name, motion, model, start, (times, states), rtol))
    return found


def _run(
    name: str,
    motion: str,
    model: un.Filament,
    start: Array,
    exact: tuple[Array, Array],
    rtol: float,
) -> Kick:
    times, wanted = exact
    solver = next((s for s in solvers() if s.name == name), None)
    best = np.inf
    for _ in range(3):
        begun = time.process_time()
        if solver:
            shown, states = (
                times,
                solver.run(textbook(model.segments, FORCES[motion]), start, times, rtol),
            )
        else:
            shown, states = OURS[name][0](model, start, times, rtol)
        best = min(best, time.process_time() - begun)
        if best > 3.0:
            break
    tips = np.array([np.interp(times, shown, states[:, k]) for k in (-3, -2, -1)]).T
    error = float(np.linalg.norm(tips - wanted[:, -3:], axis=1).max())
    return Kick(name, motion, model.segments, rtol, best, error)


def table(found: list[Kick]) -> str:
    """Return the runs as a table in Markdown."""
    ours = next(k.seconds for k in found if k.name == "undula, as it comes")
    rows = []
    for k in found:
        ratio, error = f"{k.seconds / ours:,.3g}", f"{k.tip_error:.0e}"
        rows.append([k.name, f"{k.rtol:.1e}", f"{k.seconds:.3g} s", ratio, error])
    heading = ["from a kick", "rtol", "time", "over undula as it comes", "largest error of the tip"]
    return page.table(heading, rows)
