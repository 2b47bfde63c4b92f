"""What a step and a period cost: steps, factorisations, solves and microseconds on the attractor.

Run with `make bench`. Everything is measured in one process on one thread, the best of several
repetitions, compilation apart. Beside it stands scipy's `solve_ivp(method="BDF")` with the same
compiled right-hand side on the same window. Seconds hold for one machine and moment; ratios travel.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

import undula as un
from undula.analysis.run_settings import MAX_STALE_DISPLACEMENT, Schedule
from undula.analysis.runs.simulation import Simulation
from undula.numerics.integration import stepper_state as names
from undula.numerics.integration.schemes import NDF
from undula.numerics.integration.step import options
from undula.numerics.integration.time_loop import advance

REPETITIONS = 5
NEVER = np.iinfo(np.int64).max


@dataclass(frozen=True)
class Cost:
    """Counts and the best time of one window, with the frequency that it showed."""

    steps: int
    factorisations: int
    solves: int
    seconds: float
    frequency: float


def attractor(model: un.Filament) -> np.ndarray:
    """Return a state on the settled motion that a kick ends in."""
    run = un.integrate(model, un.kicked(model), until="settled", rtol=1e-8)
    return model.admissible(model.from_nodes(run.motion.nodes[-1]))


def window(model: un.Filament, x: np.ndarray, span: float, rtol: float, *, frame: bool) -> Cost:
    """Integrate over a window from the state x; every repetition is the same computation."""
    chosen = options(
        NDF,
        model.position_mask,
        model.unknowns(model.straight()) * model.position_mask,
        rtol=rtol,
        atol=1e-10,
        stale_after=MAX_STALE_DISPLACEMENT,
        longest_step=np.inf,
        frame=frame,
    )
    best, times = np.inf, np.array([0.0, span])
    for _ in range(REPETITIONS):
        memory = Simulation.begin(model, x, Schedule(rtol=rtol)).memory
        states = np.empty((2, memory.differences.shape[1]))
        sections = np.empty((4000, 1 + states.shape[1]))
        begun = time.perf_counter()
        _, _, found = advance(model.system, memory, chosen, times, states, sections, NEVER)
        best = min(best, time.perf_counter() - begun)
    if found > 20:  # flapping: two maxima of the energy a period
        passed = sections[10:found, 0]
        frequency = 0.5 * (passed.size - 1) / (passed[-1] - passed[0])
    else:
        frequency = abs(states[1, -3] / span / (2.0 * np.pi))
    count = memory.count
    return Cost(
        *(int(count[k]) for k in (names.STEPS, names.FACTORISATIONS, names.SOLVES)), best, frequency
    )


def scipy_seconds(model: un.Filament, x: np.ndarray, span: float, rtol: float) -> float:
    """Time scipy's BDF over a window, with the compiled right-hand side."""
    begun = time.perf_counter()
    solve_ivp(lambda _, x: model.rhs(x), (0.0, span), x, method="BDF", rtol=rtol, atol=1e-9)
    return time.perf_counter() - begun


def compare(force: float, span: float, settings: list[tuple[str, float, bool]]) -> None:
    """Print the table of one force."""
    print(f"\ntip force {force:g}, a window of {span:g} T on the attractor")
    heading = f"{'segments':>8} {'setting':>22} {'steps/period':>12} {'fact/step':>9}"
    print(f"{heading} {'solves/step':>11} {'us/step':>8} {'s per 10 T':>10} {'freq. error':>11}")
    for segments in (20, 40, 100):
        model = un.Filament(segments, un.TipLoad(force))
        x = attractor(model)
        exact = window(model, x, span, 1e-9, frame=True).frequency
        for name, rtol, frame in settings:
            cost = window(model, x, span, rtol, frame=frame)
            print(
                f"{segments:8d} {name:>22} {cost.steps / (span * exact):12.1f}"
                f" {cost.factorisations / cost.steps:9.2f} {cost.solves / cost.steps:11.2f}"
                f" {1e6 * cost.seconds / cost.steps:8.2f} {10.0 * cost.seconds / span:10.3f}"
                f" {abs(cost.frequency / exact - 1.0):11.1e}"
            )


def beside_scipy() -> None:
    """Print our seconds and scipy's over a short window."""
    print("\nscipy solve_ivp BDF, same compiled right-hand side, same rtol 1e-6, two periods")
    for force, span in ((75.0, 0.023), (200.0, 0.0075)):
        for segments in (20, 40):
            model = un.Filament(segments, un.TipLoad(force))
            x = attractor(model)
            ours = window(model, x, span, 1e-6, frame=False).seconds
            theirs = scipy_seconds(model, x, span, 1e-6)
            line = f"F = {force:g}, {segments} segments: {ours:.4f} s against {theirs:.2f} s"
            print(f"{line}, ratio {theirs / ours:.0f} (in the lab frame)")


def growth() -> None:
    """Print the exponent of the cost of a step against the number of segments."""
    sizes = np.array([20, 40, 80, 160, 320, 640, 1280])
    per_step = []
    for segments in sizes:
        model = un.Filament(int(segments), un.TipLoad(200.0))
        cost = window(model, un.planar(model, 0.5), 0.002, 1e-6, frame=False)
        per_step.append(1e6 * cost.seconds / cost.steps)
    slope = np.polyfit(np.log(sizes), np.log(per_step), 1)[0]
    print(
        "\nus/step at " + ", ".join(f"{n}: {t:.1f}" for n, t in zip(sizes, per_step, strict=True))
    )
    print(f"cost of a step grows as segments^{slope:.2f}")


def timed(name: str, act: Callable[[], object]) -> None:
    """Say how long something takes."""
    begun = time.perf_counter()
    act()
    print(f"{name}: {time.perf_counter() - begun:.2f} s")


def main() -> None:
    """Measure and print everything."""
    small = un.Filament(20, un.TipLoad(75.0))
    first = un.kicked(small)
    timed(
        "first run of the process, kernels compiled or loaded", lambda: un.integrate(small, first)
    )
    compare(
        75.0,
        1.0,
        [
            ("rtol 2e-4, lab frame", 2e-4, False),
            ("rtol 1e-6, lab frame", 1e-6, False),
            ("rtol 1e-6, co-rotating", 1e-6, True),
        ],
    )
    compare(200.0, 0.3, [("rtol 2e-4", 2e-4, True), ("rtol 1e-6", 1e-6, True)])
    beside_scipy()
    growth()


if __name__ == "__main__":
    main()
