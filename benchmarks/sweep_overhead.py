"""What a study costs beside its bare integrations: naming, figures, scheduling, storing, per point.

Run with `python benchmarks/sweep_overhead.py [POINTS]`; 10,000 points by default, which takes some
minutes. One worker does the whole study, the driver on another processor. Some points, and some of
flapping, are also done in this process, phase by phase: a bare integration is that of a run until
it has settled and been shown; time that the naming asks for on top is told apart.

What a point gets besides its bare integration is told by one worker that does the same points with
and without it, a piece of either in turn, so that both have the same machine.
"""

import sys
import tempfile
import time
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import psutil

from undula.analysis.runs.integrate import carry_on
from undula.analysis.runs.run import Run
from undula.analysis.runs.simulation import Simulation
from undula.inputs.build import build_model, build_schedule, build_start
from undula.inputs.input import parse_input
from undula.sweeps.point import point_records
from undula.sweeps.store import load_sweep, open_sweep
from undula.sweeps.sweep import Sweep, read_sweep
from undula.sweeps.work_queue import SAVE_EVERY, SweepWork
from undula.sweeps.workers import pool

#: Straight, spinning, and some that ring for long; samples as few as a sweep needs.
TEXT = """
[model]
segments = 20
[time]
until = "settled"
samples = 400
[[study.axes]]
key = "model.drag_ratio"
from = 1.0
to = 3.0
count = {rows}
[[study.axes]]
key = "load.force"
from = 5.0
to = 105.0
count = 100
"""
#: Points that are done in this process as well, each so often that the quickest of each phase is
#: not that of a processor which something else has slowed down.
SAMPLED, TIMES = 600, 5
#: Points that one worker does with and without what a sweep adds, and in a piece of either.
COMPARED, PIECE = 2400, 100
#: The same study at forces under which filaments flap, from a start in a plane.
FLAPPING = {
    "from = 5.0": "from = 150.0",
    "to = 105.0": "to = 300.0",
    '[[study.axes]]\nkey = "model': '[start]\nshape = "planar"\n[[study.axes]]\nkey = "model',
}


def sweep_of(folder: Path, count: int, changes: Mapping[str, str] = MappingProxyType({})) -> Sweep:
    """Return a study of about so many points, with changes of its text."""
    file, text = folder / "study.toml", TEXT.format(rows=max(2, count // 100))
    for old, new in changes.items():
        text = text.replace(old, new)
    file.write_text(text, encoding="utf-8")
    return read_sweep(file)


@dataclass
class Clock:
    """Milliseconds of a point by phase."""

    build: float = 0.0
    bare: float = 0.0
    asked: float = 0.0
    naming: float = 0.0
    figures: float = 0.0


class Timed(Simulation):
    """A run that tells how long its integration took, until it first ended and after that."""

    def advance(self) -> bool:
        """Go on, and count the time."""
        began = time.perf_counter()
        goes_on = super().advance()
        spent = vars(self).setdefault("spent", [0.0, 0.0])
        spent[vars(self).get("ended", 0)] += 1e3 * (time.perf_counter() - began)
        if not goes_on:
            vars(self)["ended"] = 1
        return goes_on


def phases(sweep: Sweep, number: int) -> tuple[str, Clock]:
    """Do a point in this process; return its verdict and its times."""
    marks = [time.perf_counter()]
    wanted = parse_input(sweep.tables(number))
    model = build_model(wanted)
    simulation = Timed.begin(model, build_start(wanted, model), build_schedule(wanted))
    marks.append(time.perf_counter())
    run = carry_on(simulation) or Run.of(simulation)
    name = run.verdict.name
    marks.append(time.perf_counter())
    run.figures()
    marks.append(time.perf_counter())
    build, running, figures = (1e3 * np.diff(marks)).tolist()
    bare, asked = vars(simulation)["spent"]
    return name, Clock(build, bare, asked, running - bare - asked, figures)


def here(sweep: Sweep, count: int) -> dict[str, list[Clock]]:
    """Return the quickest times of some points, by verdict."""
    # At random: points at equal steps would have few of the forces.
    chosen = np.random.default_rng(1).choice(sweep.count, min(count, sweep.count), replace=False)
    phases(sweep, 0)  # by now the kernels are there
    found: dict[str, list[Clock]] = {}
    for number in chosen.tolist():
        names, clocks = zip(*(phases(sweep, number) for _ in range(TIMES)), strict=True)
        quickest = (min(getattr(clock, f.name) for clock in clocks) for f in fields(Clock))
        found.setdefault(names[0], []).append(Clock(*quickest))
    return found


def tell(found: Mapping[str, list[Clock]]) -> float:
    """Print the mean times by verdict; return that of a bare integration with its building."""
    names = [field.name for field in fields(Clock)]
    print("  ms a point".ljust(26) + "points".rjust(8) + "".join(n.rjust(10) for n in names))
    everything = [clock for clocks in found.values() for clock in clocks]
    for name, clocks in [*sorted(found.items()), ("all", everything)]:
        means = [float(np.mean([getattr(clock, n) for clock in clocks])) for n in names]
        print(f"    {name:<22}{len(clocks):8}" + "".join(f"{mean:10.2f}" for mean in means))
    return float(np.mean([clock.build + clock.bare for clock in everything]))


def integrated(tables: list[Mapping[str, Any]]) -> float:
    """Integrate points and do nothing else, in a worker; return the seconds it took."""
    began = time.perf_counter()
    for each in tables:
        wanted = parse_input(each)
        model = build_model(wanted)
        simulation = Simulation.begin(model, build_start(wanted, model), build_schedule(wanted))
        while simulation.advance():
            pass
    return time.perf_counter() - began


def done(sweep: Mapping[str, Any], numbers: tuple[int, ...]) -> float:
    """Do points as a sweep does them, in a worker; return the seconds it took."""
    began = time.perf_counter()
    while numbers:
        _, records = point_records(sweep, numbers)
        numbers = numbers[len(records) :]
    return time.perf_counter() - began


def in_turn(sweep: Sweep, count: int) -> tuple[float, float]:
    """Return milliseconds of a bare integration and of a whole point, in one worker, in turn."""
    chosen = np.random.default_rng(2).choice(sweep.count, min(count, sweep.count), replace=False)
    tasks = [tuple(task.tolist()) for task in np.array_split(chosen, max(count // PIECE, 2))]
    spent = np.zeros(2)
    with pool(1, None, print) as workers:

        def ask(work: Any, *what: Any) -> float:
            workers.give(None, work, *what)
            while not (back := list(workers.come_back(0.05))):
                pass
            return float(back[0][1])

        ask(done, sweep.dump(), tasks[0][:2])  # by now all is loaded
        for turn, task in enumerate(tasks):
            for which in (0, 1) if turn % 2 else (1, 0):
                whole = which == 1
                what = (sweep.dump(), task) if whole else ([sweep.tables(n) for n in task],)
                spent[which] += ask(done if whole else integrated, *what)
    bare, whole_point = (1e3 * spent / chosen.size).tolist()
    return bare, whole_point


@dataclass
class Watched:
    """What a sweep has used."""

    wall: float = 0.0
    driver: float = 0.0
    memory: list[float] = field(default_factory=list)


def swept(sweep: Sweep, path: Path) -> Watched:
    """Do a study with one worker; count from its first result on, when all is loaded."""
    watched, process = Watched(), psutil.Process()
    store = open_sweep(path, sweep)
    work = SweepWork(store)
    with pool(1, None, print) as workers:
        began: tuple[float, float, int] | None = None
        while work.left:
            while workers.has_room and (task := work.take()) is not None:
                workers.give(task, point_records, sweep.dump(), task.numbers)
            for task, outcome in workers.come_back(0.2):
                work.take_back(task, outcome[1])
            work.save(SAVE_EVERY)
            if work.left < sweep.count:
                began = began or (time.perf_counter(), time.process_time(), work.left)
                part = 1.0 - work.left / sweep.count
                if part >= 0.1 * (len(watched.memory) + 1):
                    watched.memory.append(process.memory_info().rss / 2**20)
        work.save()
        assert began is not None
        watched.wall = 1e3 * (time.perf_counter() - began[0]) / began[2]
        watched.driver = 1e3 * (time.process_time() - began[1]) / began[2]
    return watched


def main() -> None:
    """Measure and print everything."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
    with tempfile.TemporaryDirectory() as folder:
        sweep = sweep_of(Path(folder), count)
        bare = tell(here(sweep, SAMPLED))
        tell(here(sweep_of(Path(folder), count, FLAPPING), SAMPLED // 10))
        compared = in_turn(sweep, COMPARED)
        watched = swept(sweep, Path(folder) / "s.zarr")
        report(sweep, bare, compared, watched, Path(folder) / "s.zarr")


def report(
    sweep: Sweep, bare: float, compared: tuple[float, float], watched: Watched, path: Path
) -> None:
    """Print the table of a sweep."""
    stored = load_sweep(path)
    inside = 1e3 * float(stored["seconds"].mean())
    files = [file.stat().st_size for file in path.rglob("*") if file.is_file()]
    rows: dict[str, Any] = {
        "input and bare integration": f"{bare:.2f} ms a point, in this process",
        "the same in a worker, in turn with": f"{compared[0]:.2f} ms a point",
        "a whole point": f"{compared[1]:.2f} ms a point",
        "naming, figures and record": f"{compared[1] - compared[0]:.2f} ms a point",
        "a whole point in the sweep": f"{inside:.2f} ms a point",
        "wall time of the sweep, one worker": f"{watched.wall:.2f} ms a point",
        "scheduling and storing": f"{watched.wall - inside:.2f} ms a point",
        "processor time of the driver": f"{watched.driver:.2f} ms a point",
        "sweep / bare": f"{watched.wall / bare:.2f}",
        "memory of the driver at each tenth": ", ".join(f"{m:.0f}" for m in watched.memory) + " MB",
        "store": f"{len(files)} files, {sum(files) / sweep.count:.0f} bytes a point",
    }
    print(f"{sweep.count} points")
    for name, told in rows.items():
        print(f"  {name:<38} {told}")


if __name__ == "__main__":
    main()
