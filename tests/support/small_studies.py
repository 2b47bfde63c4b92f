"""Studies that take a moment, and a way to do them in this process."""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import xarray as xr

from undula.sweeps.point import line, points
from undula.sweeps.store import StudyStore, load_sweep, open_study
from undula.sweeps.sweep import Study, read_study
from undula.sweeps.work_queue import Piece, SweepWork

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


def study_of(folder: Path, text: str, *changes: str) -> Study:
    """Return the study that a text describes."""
    path = folder / "study.toml"
    path.write_text(text, encoding="utf-8")
    return read_study(path, changes)


def work_off(work: SweepWork, study: Study, most: int | None = None) -> list[Piece]:
    """Do so many pieces of a study in this process, all by default; return them."""
    each = line if study.whole_lines else points
    pieces: list[Piece] = []
    while (most is None or len(pieces) < most) and (piece := work.take()) is not None:
        work.take_back(piece, each(study.dump(), piece.numbers)[1])
        pieces.append(piece)
    work.save()
    return pieces


def done(study: Study, path: Path, *, retry_failed: bool = False) -> xr.Dataset:
    """Return a study, done in this process."""
    store = open_study(path, study)
    work_off(SweepWork(store, retry_failed=retry_failed), study)
    return load_sweep(path).load()


def differing(one: xr.Dataset, other: xr.Dataset, but: Sequence[str] = ("seconds",)) -> list[str]:
    """Return the names of the variables in which two stored studies differ."""
    assert one.variables.keys() == other.variables.keys()
    return [
        str(name)
        for name in one.variables
        if name not in but and not one[name].identical(other[name])
    ]


def written_in_order(store: StudyStore, act: Callable[[], object]) -> list[str]:
    """Return the variables whose files were written while something was done, in order."""
    before = {path: path.stat().st_mtime_ns for path in store.path.rglob("*") if path.is_file()}
    act()
    after = {path: path.stat().st_mtime_ns for path in store.path.rglob("*") if path.is_file()}
    changed = [path for path, at in after.items() if before.get(path) != at]
    return [path.parent.name for path in sorted(changed, key=lambda path: after[path])]


def verdicts(stored: xr.Dataset) -> set[str]:
    """Return the words that occur."""
    return set(np.unique(stored["verdict"].values).tolist())
