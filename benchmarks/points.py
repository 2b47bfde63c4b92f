"""What a settled, classified point costs, a diagram of many, a run that spins on, and a cold start.

Run with `python benchmarks/points.py [--until settled] [--rtol X] [--points N] [--diagram N]`.
Prints

- the milliseconds of a point (20 segments, a force at the tip drawn evenly from 30 to 300, started
  from a kick, run until it is solved for or settled) by verdict and by phase, beside what solved
  states say of the same points: wrong names, undecided points, and how far the frequency is from
  theirs;
- the wall time of `undula sweep` and `undula plot` for a diagram of exponent and force, of such
  points;
- the milliseconds from a kick to 100 T of spinning at F = 75 with 40 segments;
- the seconds of a cold start, each in a process of its own.

Times are those of the processor (core time) in one thread for points, of the clock for the rest.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # the matrices are small

import argparse
import subprocess
import sys
import tempfile
import time
from dataclasses import astuple, dataclass
from pathlib import Path

import numpy as np

import undula as un
from undula.analysis.observables.fundamental import Frequency
from undula.analysis.regimes.verdict import Verdict
from undula.analysis.runs.integrate import carry_on
from undula.analysis.runs.run import Run
from undula.analysis.runs.simulation import Simulation
from undula.inputs.build import build_model, build_schedule, build_start
from undula.inputs.input import parse_input

#: The command line, whether it is installed or only to be imported.
UNDULA = ("-c", "import sys; from undula.app.cli import main; sys.exit(main())")
SEGMENTS, LEAST, LARGEST = 20, 30.0, 300.0
#: Samples of a run, as few as a sweep needs.
SAMPLES = 400
#: All points are done in so many rounds: the quickest time of each is not one of a minute in which
#: other programs have slowed the machine down.
ROUNDS = 9
DIAGRAM = """
[model]
segments = 20
[load]
profile = "power"
[time]
until = "{until}"
rtol = {rtol}
samples = 400
[[study.axes]]
key = "load.exponent"
from = 0.0
to = 6.0
count = {side}
[[study.axes]]
key = "load.force"
from = 0.0
to = 400.0
count = {side}
"""
#: What is in a fresh process on the way to a first run.
COLD = {
    "import undula": "import undula",
    "import, Filament and integrate": "import undula; undula.Filament, undula.integrate",
    "a second process, to the end of a first run": (
        "import undula as u; m = u.Filament(20, u.TipLoad(75.0));"
        "u.integrate(m, u.kicked(m), until=0.01, samples=10)"
    ),
}


@dataclass(frozen=True)
class Way:
    """How a point is run."""

    until: str
    rtol: float


@dataclass(frozen=True)
class Timing:
    """Milliseconds of a point by phase."""

    build: float
    integration: float
    naming: float
    figures: float

    @property
    def total(self) -> float:
        """All phases together."""
        return sum(astuple(self))


@dataclass(frozen=True)
class Point:
    """A point as it was named, and the quickest of its times."""

    force: float
    verdict: Verdict
    frequency: Frequency | None
    steps: int
    timing: Timing


class Timed(Simulation):
    """A run that counts the time of its own steps."""

    def advance(self) -> bool:
        """Go on, and count the time."""
        began = time.process_time()
        goes_on = super().advance()
        vars(self)["spent"] = vars(self).get("spent", 0.0) + time.process_time() - began
        return goes_on


def timed(force: float, way: Way) -> Point:
    """Do a point once."""
    marks = [time.process_time()]
    tables = {
        "model": {"segments": SEGMENTS},
        "load": {"force": force},
        "time": {"until": way.until, "rtol": way.rtol, "samples": SAMPLES},
    }
    wanted = parse_input(tables)
    model = build_model(wanted)
    simulation = Timed.begin(model, build_start(wanted, model), build_schedule(wanted))
    marks.append(time.process_time())
    run = carry_on(simulation) or Run.of(simulation)
    assert run.verdict.name
    marks.append(time.process_time())
    run.figures()
    marks.append(time.process_time())
    build, running, figures = (1e3 * np.diff(marks)).tolist()
    steps = 1e3 * vars(simulation)["spent"]
    timing = Timing(build, steps, running - steps, figures)
    return Point(force, run.verdict, run.frequency, run.health.steps, timing)


def done(count: int, way: Way) -> list[Point]:
    """Do points at forces that are drawn evenly, each in every round."""
    forces = np.sort(np.random.default_rng(1).uniform(LEAST, LARGEST, count)).tolist()
    timed(75.0, way), timed(250.0, way)  # by now the kernels are there
    points = [timed(force, way) for force in forces]
    for _ in range(ROUNDS - 1):
        points = [quicker(point, timed(point.force, way)) for point in points]
    return points


def quicker(one: Point, other: Point) -> Point:
    """Return the one that took less."""
    return min(one, other, key=lambda point: point.timing.total)


def thresholds(records: list[dict], forces: list[float]) -> list[float]:
    """Return the forces at which a solved state gains or loses stability, from its rates."""
    found = []
    for kind in ("straight", "spinning", "flapping"):
        rates = np.array([record[f"{kind}_rate"] for record in records])
        crossed = np.flatnonzero(rates[:-1] * rates[1:] < 0.0).tolist()
        found += [_crossing(rates[at : at + 2], forces[at : at + 2]) for at in crossed]
    return found


def _crossing(rates: np.ndarray, forces: list[float]) -> float:
    order = np.argsort(rates)
    return float(np.interp(0.0, rates[order], np.asarray(forces)[order]))


def tell_times(points: list[Point], way: Way) -> None:
    """Print the table of times."""
    print(f"{len(points)} points, {SEGMENTS} segments, until {way.until} with rtol = {way.rtol:g}")
    print(f"  ms of core time, the best of {ROUNDS}, and steps in the mean")
    titles = (
        "points",
        "mean",
        "median",
        "95 %",
        "most",
        "build",
        "integr.",
        "naming",
        "figures",
        "steps",
    )
    print("  " + "".ljust(18) + "".join(title.rjust(9) for title in titles))
    groups: dict[str, list[Point]] = {}
    for point in points:
        groups.setdefault(point.verdict.name, []).append(point)
    for name, group in [*groups.items(), ("all", points)]:
        total = np.array([point.timing.total for point in group])
        told = [total.mean(), *np.quantile(total, (0.5, 0.95, 1.0))]
        told += np.mean([astuple(point.timing) for point in group], axis=0).tolist()
        told.append(float(np.mean([point.steps for point in group])))
        print(f"  {name:<18}{len(group):9}" + "".join(f"{value:9.2f}" for value in told))


def tell_names(points: list[Point], rtol: float) -> None:
    """Print how names and frequencies agree with solved states."""
    forces = [point.force for point in points]
    records = un.stability_along_force(un.Filament(SEGMENTS, un.TipLoad(LEAST)), forces)
    borders = thresholds(records, forces)
    print("  thresholds of solved states near " + ", ".join(f"{f:.2f}" for f in sorted(borders)))
    wrong, open_, off = [], [], []
    for point, record in zip(points, records, strict=True):
        name = point.verdict.name
        right = {record["verdict"], *record["also"].split(", ")}
        near = min((abs(point.force - f) for f in borders), default=np.nan)
        told = f"{name} at F = {point.force:.3f}, {near:.2f} from the nearest threshold"
        if name == "undecided":
            open_.append(f"{told}: {point.verdict.reason}")
        elif name not in right:
            wrong.append(f"{told}, solved states say {', '.join(filter(None, right))}")
        elif (found := point.frequency) is not None:
            kind = "spinning" if name == "spinning" else "flapping"
            away = abs(abs(found.value) / record[f"{kind}_frequency"] - 1.0)
            off.append((away, found.error / abs(found.value), point.force))
    print(f"  undecided: {len(open_)} of {len(points)}", *open_, sep="\n    ")
    print(f"  named wrongly: {len(wrong)} of {len(points)}", *wrong, sep="\n    ")
    away, stated, at = np.array(off).T
    worst = int(np.argmax(away))
    print(
        f"  frequency off the solved one: median {np.median(away):.1e}, 95 % below"
        f" {np.quantile(away, 0.95):.1e}, at most {away[worst]:.1e} (F = {at[worst]:.2f});"
        f" stated: median {np.median(stated):.1e}; off by more than stated + rtol:"
        f" {np.count_nonzero(away > stated + rtol)}"
    )


def tell_diagram(count: int, way: Way) -> None:
    """Print the wall time of a diagram of about so many points, on all cores."""
    side = max(2, round(count**0.5))
    with tempfile.TemporaryDirectory() as folder:
        file, store = Path(folder) / "diagram.toml", str(Path(folder) / "diagram.zarr")
        file.write_text(DIAGRAM.format(side=side, until=way.until, rtol=way.rtol), encoding="utf-8")
        sweep, plot = (
            _seconds(*UNDULA, *command)
            for command in (("sweep", str(file), "--out", store), ("plot", store))
        )
        records = un.load(Path(store))
        core = float(records["seconds"].sum())
    told = "" if side == 100 else " (asked are 100 x 100)"
    print(f"diagram of {side} x {side} points{told} on {os.cpu_count()} cores")
    print(f"  sweep {sweep:.1f} s, plot {plot:.1f} s, inside points {core:.1f} s of core time")
    print(f"  {1e3 * core / side**2:.2f} ms a point")


def tell_spinning(times: int = 20) -> None:
    """Print the time from a kick to 100 T at F = 75 with 40 segments."""
    model = un.Filament(40, un.TipLoad(75.0))
    taken = []
    for _ in range(times):
        began = time.perf_counter()
        run = un.integrate(model, un.kicked(model), until=100.0, samples=SAMPLES)
        taken.append(1e3 * (time.perf_counter() - began))
    radius = np.linalg.norm(run.motion.nodes[:, -1, :2], axis=-1)[-SAMPLES // 2 :]
    print("spinning at F = 75 from a kick to 100 T, 40 segments")
    print(f"  {min(taken):.2f} ms at best, {np.median(taken):.2f} in the median of {times}")
    print(f"  radius of the tip's path over the later half steady to {np.ptp(radius):.1e} L")


def tell_cold_start() -> None:
    """Print what a user waits for, with everything compiled before."""
    _seconds("-c", COLD["a second process, to the end of a first run"])
    print("cold start, each in a fresh process, the best of 3")
    rows = {name: ("-c", code) for name, code in COLD.items()}
    for name, command in {**rows, "undula --help": (*UNDULA, "--help")}.items():
        print(f"  {name:<45}{min(_seconds(*command) for _ in range(3)):6.2f} s")


def _seconds(*arguments: str) -> float:
    began = time.perf_counter()
    subprocess.run([sys.executable, *arguments], check=True, capture_output=True)
    return time.perf_counter() - began


def main() -> None:
    """Measure and print everything."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--points", type=int, default=300, help="points that are timed alone")
    parser.add_argument("--diagram", type=int, default=400, help="points of the diagram; 0: none")
    parser.add_argument("--until", choices=("settled", "solved"), default="solved")
    parser.add_argument("--rtol", type=float, default=1e-4, help="error tolerance of a step")
    asked = parser.parse_args()
    way = Way(asked.until, asked.rtol)
    points = done(asked.points, way)
    tell_times(points, way)
    tell_names(points, way.rtol)
    tell_spinning()
    tell_cold_start()
    if asked.diagram:
        tell_diagram(asked.diagram, way)


if __name__ == "__main__":
    main()
