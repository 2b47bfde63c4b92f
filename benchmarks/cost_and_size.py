"""Seconds a period and memory against the number of segments, 20 to 1280, with fitted exponents.

Run with `make bench`, or `python benchmarks/cost_and_size.py [--quick]`. Spinning in the lab frame
and flapping, each some periods after a start near the attractor has settled. The memory of a run is
that of a fresh process; what it has before the model is made is told apart.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import subprocess
import sys
import time
from dataclasses import asdict, dataclass

import numpy as np

import undula as un
from contenders import page
from contenders.orbits import FORCES, orbit
from undula.analysis.run_settings import Schedule
from undula.analysis.runs.simulation import Simulation
from undula.arrays import Array, State
from undula.numerics.integration import stepper_state as names
from undula.numerics.integration.stepper_state import StepperState
from undula.numerics.integration.time_loop import advance

QUICK = "--quick" in sys.argv
SIZES = (20, 40, 80, 160) if QUICK else (20, 40, 80, 160, 320, 640, 1280)
RTOL = 1e-6
#: Segments of the motion that starts are taken from, and periods to settle and to be timed.
COARSE, SETTLING, TIMED = 80, 3.0, 5.0
REPEATED = 3 if QUICK else 7
NEVER = np.iinfo(np.int64).max


@dataclass(frozen=True)
class Cost:
    """A period of a motion."""

    motion: str
    segments: int
    seconds: float  # a period
    steps: float  # a period
    kilobytes: float  # of the integrator's arrays


def finer(motion: str, segments: int) -> tuple[un.Filament, State]:
    """Return a model with so many segments and a start near its motion."""
    coarse = orbit("undula", COARSE, motion)
    links = np.diff(coarse.start.reshape(-1, 3), axis=0, prepend=np.zeros((1, 3)))
    model = coarse.model.with_(segments=segments)
    old, new = ((np.arange(n) + 0.5) / n for n in (COARSE, segments))
    # The clamp's direction is known at s = 0.
    old, links = np.append(0.0, old), np.vstack([[0.0, 0.0, 1.0 / COARSE], links])
    shape = np.stack([np.interp(new, old, links[:, a]) for a in range(3)], axis=-1)
    return model, model.admissible(np.cumsum(shape, axis=0).ravel())


def settled(model: un.Filament, x: State, period: float) -> StepperState:
    """Return the integrator's memory after some periods in the lab frame."""
    schedule = Schedule(rtol=RTOL)
    memory = Simulation.begin(model, x, schedule).memory
    _go(model, memory, period * SETTLING)
    return memory


def _go(model: un.Filament, memory: StepperState, until: float) -> Array:
    options = Schedule(rtol=RTOL).options(model)._replace(frame=0)
    states = np.empty((1, memory.differences.shape[1]))
    sections = np.empty((0, 1 + states.shape[1]))
    advance(model.system, memory, options, np.array([until]), states, sections, NEVER)
    return states


def costs(motion: str) -> list[Cost]:
    """Time all sizes in turn, and keep the best of each."""
    period = 1.0 / orbit("undula", COARSE, motion).frequency
    ready = []
    for segments in SIZES:
        model, x = finer(motion, segments)
        ready.append((model, settled(model, x, period)))
    best, steps = np.full(len(SIZES), np.inf), np.zeros(len(SIZES))
    for _ in range(REPEATED):
        for k, (model, memory) in enumerate(ready):
            mine = StepperState(*(array.copy() for array in memory))
            end = period * (SETTLING + TIMED)
            begun = time.process_time()
            _go(model, mine, end)
            best[k] = min(best[k], time.process_time() - begun)
            steps[k] = int(mine.count[names.STEPS]) - int(memory.count[names.STEPS])
    return [
        Cost(motion, n, best[k] / TIMED, steps[k] / TIMED, kilobytes(*ready[k]))
        for k, n in enumerate(SIZES)
    ]


def kilobytes(model: un.Filament, memory: StepperState) -> float:
    """Return what the integrator keeps, model tables and a step's scratch included."""
    kept = [*memory, *(table for table in model.system if isinstance(table, np.ndarray))]
    scratch = (
        8 * memory.factored_at.nbytes
    )  # `undula.numerics.integration.workspace.Work` has eight vectors
    return (sum(array.nbytes for array in kept) + scratch) / 1024.0


def peak(segments: int) -> tuple[float, float]:
    """Return the largest memory of a fresh process before and after a run as it comes [MB]."""
    code = (
        "import resource, undula as un\n"
        "use = lambda: resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0\n"
        "small = un.Filament(8, un.TipLoad(75.0))\n"
        "un.integrate(small, un.kicked(small), until=0.001, samples=10).motion\n"
        "before = use()\n"
        f"model = un.Filament({segments}, un.TipLoad(75.0))\n"
        "run = un.integrate(model, un.kicked(model), until=0.05)\n"
        "run.motion\n"
        "print(before, use())\n"
    )
    told = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    before, after = map(float, told.stdout.split())
    return before, after


def exponent(sizes: list[int], values: list[float]) -> float:
    """Return the slope of a power law."""
    return float(np.polyfit(np.log(sizes), np.log(values), 1)[0])


def table(found: dict[str, list[Cost]], peaks: dict[int, tuple[float, float]]) -> str:
    """Return everything as a table in Markdown."""
    heading = ["", *map(str, SIZES), "exponent"]
    sizes, rows = list(SIZES), []
    for motion, all_costs in found.items():
        seconds = [1e3 * cost.seconds for cost in all_costs]
        row = [f"{motion}, ms a period", *(f"{one:.3g}" for one in seconds)]
        rows.append([*row, f"{exponent(sizes, seconds):.2f}"])
        steps = [f"{cost.steps:.0f}" for cost in all_costs]
        rows.append([f"{motion}, steps a period", *steps, ""])
    kept = [cost.kilobytes for cost in next(iter(found.values()))]
    row = ["integrator's arrays, kB", *(f"{one:.0f}" for one in kept)]
    rows.append([*row, f"{exponent(sizes, kept):.2f}"])
    grown = [f"{after - before:.0f}" for before, after in peaks.values()]
    rows.append(["a run with 4000 samples, MB", *grown, ""])
    return page.table(heading, rows)


def main() -> None:
    """Measure and write."""
    found = {motion: costs(motion) for motion in FORCES}
    peaks = {segments: peak(segments) for segments in SIZES}
    told = table(found, peaks)
    print(told)
    results = {motion: [asdict(cost) for cost in one] for motion, one in found.items()}
    name = "cost-and-size-quick" if QUICK else "cost-and-size"
    page.keep(name, {**results, "peaks": peaks, "machine": page.machine()})
    if not QUICK:
        page.write("size", told)


if __name__ == "__main__":
    main()
