"""What a study costs beside its bare integrations: judging, scheduling and storing, per point.

Run with `python benchmarks/sweep_overhead.py [POINTS]`; 10,000 points by default, which takes some
minutes. One worker does the whole study, the driver on another processor. Every so many points are
also done in this process, bare and judged in turn, so that ratios are of one run and one moment.
"""

import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import psutil

from undula.analysis.integrate import carry_on
from undula.analysis.simulation import Simulation
from undula.app.pool import pool
from undula.app.sweep_work import SAVE_EVERY, SweepWork
from undula.studies.build import build_model, build_schedule, build_start
from undula.studies.point import point, points
from undula.studies.spec import parse_input
from undula.studies.study import Study, read_study
from undula.studies.study_store import load_study, open_study

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
#: Points that are done in this process as well.
SAMPLED = 600


def study_of(folder: Path, count: int) -> Study:
    """Return a study of about so many points."""
    file = folder / "study.toml"
    file.write_text(TEXT.format(rows=max(2, count // 100)), encoding="utf-8")
    return read_study(file)


def here(study: Study) -> tuple[float, float]:
    """Return milliseconds a point of bare integrations, and of whole points, in this process."""
    bare = whole = 0.0
    # At random: points at equal steps would have few of the forces.
    chosen = np.random.default_rng(1).choice(study.count, min(SAMPLED, study.count), replace=False)
    point(study.job(0))  # by now the kernels are there
    for number in chosen.tolist():
        began = time.perf_counter()
        wanted = parse_input(study.tables(number))
        model = build_model(wanted)
        carry_on(Simulation.begin(model, build_start(wanted, model), build_schedule(wanted)))
        middle = time.perf_counter()
        point(study.job(number))
        bare += middle - began
        whole += time.perf_counter() - middle
    return 1e3 * bare / len(chosen), 1e3 * whole / len(chosen)


@dataclass
class Watched:
    """What a sweep has used."""

    wall: float = 0.0
    driver: float = 0.0
    memory: list[float] = field(default_factory=list)


def swept(study: Study, path: Path) -> Watched:
    """Do a study with one worker; count from its first result on, when all is loaded."""
    watched, process = Watched(), psutil.Process()
    store = open_study(path, study)
    work = SweepWork(store)
    with pool(1, None, print) as workers:
        began: tuple[float, float, int] | None = None
        while work.left:
            while workers.has_room and (piece := work.take()) is not None:
                workers.give(piece, points, study.dump(), piece.numbers)
            for piece, outcome in workers.come_back(0.2):
                work.take_back(piece, outcome[1])
            work.save(SAVE_EVERY)
            if work.left < study.count:
                began = began or (time.perf_counter(), time.process_time(), work.left)
                part = 1.0 - work.left / study.count
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
        study = study_of(Path(folder), count)
        bare, whole = here(study)
        watched = swept(study, Path(folder) / "s.zarr")
        report(study, bare, whole, watched, Path(folder) / "s.zarr")


def report(study: Study, bare: float, whole: float, watched: Watched, path: Path) -> None:
    """Print the table of a sweep."""
    stored = load_study(path)
    inside = 1e3 * float(stored["seconds"].mean())
    files = [file.stat().st_size for file in path.rglob("*") if file.is_file()]
    rows: dict[str, Any] = {
        "bare integration, this process": f"{bare:.2f} ms a point",
        "integration and verdict, this process": f"{whole:.2f} ms a point",
        "the same in the worker": f"{inside:.2f} ms a point",
        "wall time of the sweep, one worker": f"{watched.wall:.2f} ms a point",
        "scheduling and storing": f"{watched.wall - inside:.2f} ms a point",
        "processor time of the driver": f"{watched.driver:.2f} ms a point",
        "sweep / bare": f"{watched.wall / bare:.2f}",
        "verdict / bare": f"{whole / bare:.2f}",
        "memory of the driver at each tenth": ", ".join(f"{m:.0f}" for m in watched.memory) + " MB",
        "store": f"{len(files)} files, {sum(files) / study.count:.0f} bytes a point",
    }
    print(f"{study.count} points")
    for name, told in rows.items():
        print(f"  {name:<38} {told}")


if __name__ == "__main__":
    main()
