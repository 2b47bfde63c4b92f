"""A contender on a window of an exactly known motion: what it takes and how far it is off."""

import statistics
import time
from dataclasses import dataclass, field

import numpy as np

from contenders.orbits import FORCES, Orbit, orbit
from contenders.ours import called, stepped
from contenders.solvers import Solver, solvers
from contenders.textbook import Array, textbook

#: Relative error of the frequency that all are allowed.
BOUND = 5e-5
#: Relative tolerances to choose from, and how often in a row one has to meet the bound.
STEP = 10.0 ** (-1.0 / 6.0)
TOLERANCES = tuple(STEP**k for k in range(9, 49))
IN_A_ROW = 3
SAMPLES_A_PERIOD = 8
OURS = {
    "undula, lab frame": (stepped(turning=False), None),
    "undula, co-rotating": (stepped(turning=True), None),
    "undula, as it comes": (called, 1e-6),
}


@dataclass
class Timed:
    """Runs of one contender over one window."""

    name: str
    motion: str
    segments: int
    rtol: float
    frequency_error: float
    tip_error: float
    seconds: list[float] = field(default_factory=list)

    @property
    def best(self) -> float:
        """The shortest time [s]."""
        return min(self.seconds)

    @property
    def median(self) -> float:
        """The median time [s]."""
        return statistics.median(self.seconds)


def instants(motion: Orbit, periods: float) -> Array:
    """Return the times at which a window is compared."""
    return np.linspace(
        0.0, periods / motion.frequency, 1 + round(SAMPLES_A_PERIOD * periods), dtype=float
    )


def names() -> list[str]:
    """Return the names of all contenders that are run, in the order of the tables."""
    return [solver.name for solver in solvers()] + list(OURS)


def method_of(name: str) -> str:
    """Return the method whose tolerances a contender shares."""
    return next((s.method for s in solvers() if s.name == name), name)


def once(name: str, motion: str, segments: int, periods: float, rtol: float) -> Timed:
    """Run a contender once; a solver that gives up has infinite errors."""
    ours = name in OURS
    exact = orbit("undula" if ours else "textbook", segments, motion)
    times = instants(exact, periods)
    begun = time.process_time()
    try:
        if ours:
            shown, states = OURS[name][0](exact.model, exact.start, times, rtol)
        else:
            solver: Solver = next(s for s in solvers() if s.name == name)
            rod = textbook(segments, FORCES[motion])
            shown, states = times, solver.run(rod, exact.start, times, rtol)
    except RuntimeError:
        return Timed(name, motion, segments, rtol, np.inf, np.inf, [np.inf])
    spent = time.process_time() - begun
    found = exact.frequency_error(shown, states), exact.tip_error(shown, states)
    return Timed(name, motion, segments, rtol, *found, [spent])


def tolerance(name: str, motion: str, segments: int, periods: float) -> float:
    """Choose the tolerance with which a contender is quickest within the bound.

    From loose to tight, until three in a row are within it: a single one may be so by luck, and
    the loosest need not be the quickest.
    """
    within: list[Timed] = []
    for rtol in TOLERANCES:
        tried = once(name, motion, segments, periods, rtol)
        within = [*within, tried] if tried.frequency_error <= BOUND else []
        if len(within) == IN_A_ROW:
            break
    if not within:
        raise RuntimeError(f"{name} never comes within {BOUND:g} at {segments} segments")
    return min(within, key=lambda one: one.best).rtol
