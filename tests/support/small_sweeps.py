"""Studies that take a moment, and a way to do them in this process."""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import xarray as xr

from undula.sweeps.point import point_records, row_records
from undula.sweeps.store import SweepStore, load_sweep, open_sweep
from undula.sweeps.sweep import Sweep, read_sweep
from undula.sweeps.work_queue import SweepTask, SweepWork

#: Beats and spins of a few links, each point some milliseconds.
QUICK = """
[model]
segments = 4
[load]
profile = "power"
[time]
until = 0.05
samples = 60
"""
AXES = """
[[study.axes]]
key = "load.exponent"
values = [0.5, 2]
[[study.axes]]
key = "load.force"
from = 20
to = 240
count = 5
"""


def sweep_of(folder: Path, text: str, *changes: str) -> Sweep:
    """Return the study that a text describes."""
    path = folder / "study.toml"
    path.write_text(text, encoding="utf-8")
    return read_sweep(path, changes)


def work_off(work: SweepWork, sweep: Sweep, most: int | None = None) -> list[SweepTask]:
    """Do so many pieces of a study in this process, all by default; return them."""
    each = row_records if sweep.whole_rows else point_records
    tasks: list[SweepTask] = []
    while (most is None or len(tasks) < most) and (task := work.take()) is not None:
        work.take_back(task, each(sweep.dump(), task.numbers)[1])
        tasks.append(task)
    work.save()
    return tasks


def done(sweep: Sweep, path: Path, *, retry_failed: bool = False) -> xr.Dataset:
    """Return a study, done in this process."""
    store = open_sweep(path, sweep)
    work_off(SweepWork(store, retry_failed=retry_failed), sweep)
    return load_sweep(path).load()


def differing(one: xr.Dataset, other: xr.Dataset, but: Sequence[str] = ("seconds",)) -> list[str]:
    """Return the names of the variables in which two stored studies differ."""
    assert one.variables.keys() == other.variables.keys()
    return [
        str(name)
        for name in one.variables
        if name not in but and not one[name].identical(other[name])
    ]


def written_in_order(store: SweepStore, act: Callable[[], object]) -> list[str]:
    """Return the variables whose files were written while something was done, in order."""
    before = {path: path.stat().st_mtime_ns for path in store.path.rglob("*") if path.is_file()}
    act()
    after = {path: path.stat().st_mtime_ns for path in store.path.rglob("*") if path.is_file()}
    changed = [path for path, at in after.items() if before.get(path) != at]
    return [path.parent.name for path in sorted(changed, key=lambda path: after[path])]


def verdicts(stored: xr.Dataset) -> set[str]:
    """Return the words that occur."""
    return set(np.unique(stored["verdict"].values).tolist())
