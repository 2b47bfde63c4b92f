"""undula beside the solvers that users would pick: the same filament, window and accuracy.

Run with `make bench`, or `python benchmarks/contest.py [--quick] [spinning] [flapping]`. All
contenders integrate some periods of a motion that is exactly known for their own discretisation,
from a state on it, one thread, one process, in turn. Each has the tolerance with which its method
is quickest among those that leave a frequency error of at most 5e-5. Then come runs from a kick,
PyElastica by its stability limit, and what the layouts are away from the continuum. Times are
processor times, which other work on the machine disturbs least. Ratios are the result; tables go
into docs/benchmarks.md, everything into benchmarks/results.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # one thread for everybody
os.environ.setdefault("OMP_NUM_THREADS", "1")

import sys
from dataclasses import asdict
from functools import cache

from contenders import continuum, distance, kicks, page, push
from contenders.orbits import FORCES
from contenders.windows import BOUND, OURS, STEP, Timed, method_of, names, once, tolerance

QUICK = "--quick" in sys.argv
MOTIONS = [motion for motion in FORCES if motion in sys.argv] or list(FORCES)
SEGMENTS = (20, 40) if QUICK else (20, 40, 100, 200)
PERIODS = 3 if QUICK else 10
#: A run that is expected to take longer is left out [s].
LONGEST = 5.0 if QUICK else 45.0
#: Seconds that the repetitions of a contender may take together, and how many there are at most.
TOGETHER, REPEATED = (1.0, 3) if QUICK else (3.0, 7)
#: From how many segments on tolerances are no longer chosen anew.
LAST_CHOICE = 40
#: The variant of each method that its tolerance is chosen with: its quickest.
CHOOSER = {
    "BDF": "scipy BDF, compiled, sparse Jacobian",
    "Radau": "scipy Radau, compiled, sparse Jacobian",
    "LSODA": "scipy odeint, compiled, band, Jacobian",
    "CVODE": "CVODE, compiled, band, Jacobian",
}


@cache
def chosen(method: str, motion: str, segments: int) -> float:
    """Return the tolerance of a method."""
    if method in OURS:
        given = OURS[method][1]
        return given or tolerance(method, motion, segments, PERIODS)
    return tolerance(CHOOSER[method], motion, segments, PERIODS)


def first(name: str, motion: str, segments: int) -> Timed:
    """Run a contender for the first time, with a tolerance that keeps it within the bound."""
    rtol = chosen(method_of(name), motion, min(segments, LAST_CHOICE))
    while (tried := once(name, motion, segments, PERIODS, rtol)).frequency_error > BOUND:
        if rtol < 1e-9 or tried.best > LONGEST:
            break
        rtol *= STEP
    return tried


def window(motion: str, segments: int, before: dict[str, Timed]) -> dict[str, Timed]:
    """Run all contenders in turn, as often as their time allows."""
    found = {}
    for name in names():
        last = before.get(name)
        # Between the dense linear algebra of some and the Python of others.
        if segments > SEGMENTS[0] and (
            last is None or last.best * (segments / last.segments) ** 1.5 > LONGEST
        ):
            continue
        found[name] = first(name, motion, segments)
        tell(found[name])
    for _ in range(REPEATED - 1):
        for name, one in found.items():
            if sum(one.seconds) + one.best <= TOGETHER:
                one.seconds += once(name, motion, segments, PERIODS, one.rtol).seconds
    return found


def tell(one: Timed) -> None:
    """Print a line."""
    told = f"{one.motion:9} {one.segments:4} {one.name:42} rtol {one.rtol:.1e} {one.best:10.4f} s"
    print(f"{told}  errors {one.frequency_error:.0e} {one.tip_error:.0e}", flush=True)


def in_words(found: list[dict[str, Timed]], pushed: list[push.Pushed]) -> str:
    """Return the table of a motion: times as multiples of undula's in the lab frame."""
    heading = ["contender", *(f"{n} segments" for n in SEGMENTS)]
    rows = [[name, *(cell(name, one) for one in found)] for name in names()]
    at = {one.segments: one for one in pushed}
    row = ["PyElastica (extrapolated)"]
    for one in found:
        ours, n = one["undula, lab frame"], one["undula, lab frame"].segments
        row.append(f"{at[n].window / ours.best:,.0f}" if n in at else "-")
    return page.table(heading, [*rows[: -len(OURS)], row, *rows[-len(OURS) :]])


def cell(name: str, found: dict[str, Timed]) -> str:
    """Return a time as a multiple, or in ms for undula, with its tolerance and its error."""
    one, ours = found.get(name), found["undula, lab frame"]
    if one is None:
        return "too long"
    over = "" if one.frequency_error <= BOUND else f", error {one.frequency_error:.0e}"
    if name in OURS:
        return f"{1e3 * one.best:.3g} ms (median {1e3 * one.median:.3g}; {one.rtol:.1e}{over})"
    ratio = one.best / ours.best
    return f"{ratio:{',.0f' if ratio >= 10 else '.2g'}} ({one.rtol:.1e}{over})"


def compile_all() -> None:
    """Run one of each kind, so that nothing is compiled while a clock runs."""
    for name in (*CHOOSER.values(), *OURS):
        if "Radau" not in name:  # slow, and the same functions as those of BDF
            once(name, "spinning", SEGMENTS[0], 1.25, 1e-4)


def contest(motion: str) -> None:
    """Measure one motion, and write what was found."""
    found: list[dict[str, Timed]] = []
    for segments in SEGMENTS:
        before = {name: one for each in found for name, one in each.items()}
        found.append(window(motion, segments, before))
    pushed = [push.pushed(motion, segments, PERIODS) for segments in SEGMENTS]
    accuracy = push.accuracy(motion)
    away = continuum.distances(motion, SEGMENTS)
    compared = distance.compare(found, pushed, accuracy, away)
    kicked = kicks.measure(motion, SEGMENTS[1], chosen, short=QUICK)
    results = {
        "machine": page.machine(),
        "periods": PERIODS,
        "windows": [asdict(one) for each in found for one in each.values()],
        "PyElastica": [asdict(one) for one in pushed],
        "same distance": compared,
        "continuum": away,
        "kicks": [asdict(one) for one in kicked],
    }
    page.keep(f"contest-{motion}{'-quick' * QUICK}", results)
    for name, text in {
        motion: in_words(found, pushed),
        f"{motion}, continuum": continuum.table(away),
        f"{motion}, same distance": distance.table(compared),
        f"{motion}, kick": kicks.table(kicked),
    }.items():
        print(text, flush=True)
        if not QUICK:
            page.write(name, text)


def main() -> None:
    """Measure the motions that are asked for, or both."""
    compile_all()
    for motion in MOTIONS:
        contest(motion)
    if not QUICK:
        page.write("machine", page.machine())


if __name__ == "__main__":
    main()
