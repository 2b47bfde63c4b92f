"""Cost of states solved for, beside that of runs that wait for them.

Prints, for several numbers of links, the median time of finding a spinning and a flapping state at
F = 75 from nothing but the model, of following both branches from F = 40 to 300 with stability all
along, and of a run to the settled state from a kick at F = 75 and at F = 185, where the transition
is near. Everything is warm: kernels are compiled before the clock starts.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # the matrices are small

import statistics
import time
from collections.abc import Callable

import undula as un


def median(task: Callable[[], object], repeats: int = 5) -> float:
    """Return the median time of a task [ms], after one time that does not count."""
    task()
    times = []
    for _ in range(repeats):
        began = time.perf_counter()
        task()
        times.append(1e3 * (time.perf_counter() - began))
    return statistics.median(times)


def settle(model: un.Filament) -> un.Run:
    """Return a run from a kick to the settled state."""
    return un.integrate(model, un.kicked(model, 1e-2), until="settled", limit=20.0)


def main() -> None:
    """Print the table."""
    print(
        "| links | find spinning | find flapping | follow spinning | follow flapping"
        " | run at 75 | run at 185 |"
    )
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for segments in (20, 40, 80):
        at = {force: un.Filament(segments, un.TipLoad(force)) for force in (40.0, 75.0, 185.0)}
        spinning, flapping = un.find(at[40.0], "spinning"), un.find(at[40.0], "flapping")
        times = [
            median(lambda model=at[75.0]: un.find(model, "spinning")),
            median(lambda model=at[75.0]: un.find(model, "flapping")),
            median(lambda state=spinning: un.follow(state, "load.force", 300.0), 1),
            median(lambda state=flapping: un.follow(state, "load.force", 300.0), 1),
            median(lambda model=at[75.0]: settle(model)),
            median(lambda model=at[185.0]: settle(model)),
        ]
        print(f"| {segments} | " + " | ".join(f"{one:.3g} ms" for one in times) + " |", flush=True)


if __name__ == "__main__":
    main()
