"""Damage done to stored files on purpose, and what becomes of those who read them.

``python tests/support/damage.py KIND COUNT SEED`` damages the files of a kind so many times, in a
process that ends itself where a reading hangs, and prints how the readings ended.
"""

import contextlib
import faulthandler
import io
import json
import random
import shutil
import sys
import tempfile
import traceback
import warnings
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

import undula as un
from small_sweeps import QUICK, sweep_of, work_off
from undula.analysis.maps.stability_boundaries import StabilityBoundaries
from undula.analysis.maps.stability_intervals import Change, StabilityIntervals
from undula.app.cli import main
from undula.errors import InputError
from undula.reproduction.claims.catalogue import TaskEntry
from undula.reproduction.tasks.task import ReproductionTask
from undula.storage.ramp_file import stored_steps
from undula.storage.unchecked import StoredWarning
from undula.sweeps.boundary_cache import read_boundaries, write_boundaries
from undula.sweeps.store import open_sweep
from undula.sweeps.work_queue import SweepWork

#: How a reading ends: as without damage, refused in a sentence, computed again; or wrongly.
SAME, TOLD, AGAIN = "same", "told", "again"
BELIEVED, TRACEBACK = "believed", "traceback"
#: Seconds after which a reading hangs: the slowest takes ten, on a machine with nothing else to do.
PATIENCE = 300.0


@dataclass(frozen=True)
class Kind:
    """A kind of stored files.

    Attributes
    ----------
    make
        Makes them in a folder.
    files
        Which of them are damaged, as a pattern.
    outcome
        What reading them comes to: something to compare, None where all is to be computed again.
    """

    make: Callable[[Path], None]
    files: str
    outcome: Callable[[Path], Any]


def damaged(image: bytes, chance: random.Random) -> bytes:
    """Return the bytes of a file with some bits flipped, a stretch of zeros, or a part cut off."""
    broken, at = bytearray(image), chance.randrange(max(1, len(image)))
    way = chance.choice(("bit", "bits", "zeros", "cut", "end"))
    if way == "cut":
        return bytes(broken[:at])
    if way == "end":
        return bytes(broken[: -chance.randrange(1, 200)])
    if way == "zeros":
        stretch = broken[at : at + chance.choice((1, 4, 16, 512, 4096))]
        broken[at : at + len(stretch)] = bytes(len(stretch))
        return bytes(broken)
    for _ in range(1 if way == "bit" else chance.randrange(2, 9)):
        broken[chance.randrange(len(broken))] ^= 1 << chance.randrange(8)
    return bytes(broken)


def ending(kind: Kind, folder: Path, whole: Any) -> str:
    """Return how reading the files of a folder ends, and print what should not have been."""
    try:
        outcome = kind.outcome(folder)
    except InputError as error:
        return TOLD if len(str(error).splitlines()) == 1 else TRACEBACK
    except Exception:
        traceback.print_exc()
        return TRACEBACK
    if outcome is None:
        return AGAIN
    return SAME if outcome == whole else BELIEVED


def counts(name: str, count: int, seed: int) -> dict[str, int]:
    """Return how the readings of files of a kind ended, damaged so many times."""
    kind, chance, found = KINDS[name], random.Random(f"{name}{seed}"), Counter[str]()
    warnings.simplefilter("ignore", StoredWarning)
    with tempfile.TemporaryDirectory() as made:
        folder, again = Path(made) / "whole", Path(made) / "again"
        folder.mkdir()
        kind.make(folder)
        files = sorted(
            path for path in folder.glob(kind.files) if path.is_file() and path.stat().st_size
        )
        # Of a copy: reading goes on with a run or a study, too.
        whole = kind.outcome(shutil.copytree(folder, again))
        for _ in range(count):
            faulthandler.dump_traceback_later(PATIENCE, exit=True)
            shutil.rmtree(again, ignore_errors=True)
            shutil.copytree(folder, again)
            path = again / chance.choice(files).relative_to(folder)
            image = path.read_bytes()
            while (broken := damaged(image, chance)) == image:
                pass
            path.write_bytes(broken)
            how = ending(kind, again, whole)
            if how in (BELIEVED, TRACEBACK):
                sys.stderr.write(f"{how}: {path.relative_to(again)}\n")
            found[how] += 1
        faulthandler.cancel_dump_traceback_later()
    return dict(found)


# ---------------------------------------------------------------- kinds


def command(*words: str | Path) -> dict[str, Any]:
    """Return the answer of a command; what it refuses in one sentence is an `InputError` again."""
    said, told = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(told):
        status = main([*map(str, words), "--json"])
    answer: dict[str, Any] = json.loads(said.getvalue())
    if status not in (0, 3):
        raise InputError(answer["error"])
    return answer


def make_run(folder: Path) -> None:
    short = ("--set", "model.segments=6", "--set", "time.until=0.02", "--set", "time.samples=60")
    command("run", *short, "--no-movie", "--out", folder)


def annotate(folder: Path) -> None:
    """Make a run to which a note was added, so that only its checkpoint carries a digest."""
    import h5py

    make_run(folder)
    with h5py.File(folder / "run.nc", "a") as file:
        file.attrs["note"] = "mine"


def read_run(folder: Path) -> Any:
    return as_bytes(un.load(folder / "run.nc"))


def drawn(folder: Path) -> Any:
    command("plot", folder / "run.nc", "--out", folder / "drawn.png", "--overwrite")
    return (folder / "drawn.png").read_bytes()


def resumed(folder: Path) -> Any:
    answer = command("resume", folder / "run.nc", "--until", "0.03", "--no-movie")
    but = ("seconds", "output", "figure", "movie")
    return {key: told for key, told in answer.items() if key not in but}


def make_steps(folder: Path) -> None:
    two = ("--set", "model.kind=chain", "--set", "model.links=2", "--along", "load.force=4:8:1.5")
    command("step", *two, "--out", folder)


def read_steps(folder: Path) -> Any:
    stored = un.load(folder / "steps.nc")
    return as_bytes(stored), len(stored_steps(stored))


def make_sweep(folder: Path, keep: str = "period") -> None:
    store = open_sweep(folder / "s.zarr", sweep(folder, keep))
    work_off(SweepWork(store), store.sweep)


def make_sweep_with_runs(folder: Path) -> None:
    make_sweep(folder, "run")


def sweep(folder: Path, keep: str) -> Any:
    axes = '\n[[study.axes]]\nkey = "load.force"\nvalues = [60.0, 90.0, 120.0]\n'
    return sweep_of(folder, f'{QUICK}[study]\nkeep = "{keep}"\n{axes}')


def gone_on_with(folder: Path, keep: str = "period") -> Any:
    """Read a study, then do again what is damaged of it, and read that."""
    before = read_sweep(folder)
    store = open_sweep(folder / "s.zarr", sweep(folder, keep))
    work_off(SweepWork(store), store.sweep)
    runs = {path.name: path.read_bytes() for path in (store.path / "runs").glob("*.nc")}
    after = un.load(store.path).load()
    done = (before["status"] == 1).values
    names = [name for name in after if after[name].dims[:2] == before["status"].dims]
    shown = [
        name
        for name in names
        if name != "seconds"
        and not np.array_equal(
            before[name].values[done],
            after[name].values[done],
            equal_nan=after[name].dtype.kind == "f",
        )
    ]
    # What was shown as done before it was done again has to be what it is after.
    return shown, as_bytes(after.drop_vars("seconds")), runs


def read_sweep(folder: Path) -> xr.Dataset:
    return un.load(folder / "s.zarr").load()


def gone_on_with_runs(folder: Path) -> Any:
    return gone_on_with(folder, "run")


def make_borders(folder: Path) -> None:
    make_sweep(folder)
    state = StabilityIntervals(
        "spinning", 37.5, ((37.5, 187.2),), 240.0, lost=Change(187.2, 1e-8, 4.1)
    )
    borders = StabilityBoundaries(None, (float("nan"),), 240.0, ({"spinning": state},))
    write_boundaries(folder / "s.zarr", read_sweep(folder), borders)


def kept_borders(folder: Path) -> Any:
    return read_boundaries(folder / "s.zarr", read_sweep(folder)) or None


def job(folder: Path) -> ReproductionTask:
    entry = TaskEntry(call="stability")
    return ReproductionTask(
        "onset", "onset", entry, ("stability",), folder, "7" * 64, frozenset(), True
    )


def keep_answer(folder: Path) -> None:
    numbers = [{"force": 37.69491 * k, "error": 3e-9 * k} for k in range(20)]
    job(folder).prepare()
    job(folder).store({"status": 0, "answer": {"later": numbers}, "said": "", "seconds": 0.5})


def kept_answer(folder: Path) -> Any:
    found = job(folder).stored()
    job(folder).prepare()
    return found


def as_bytes(stored: xr.Dataset) -> Any:
    """Return all that a dataset holds, to be compared bit for bit."""
    plain = {
        str(name): (one.dims, str(one.dtype), one.values.tolist().__repr__(), str(one.attrs))
        for name, one in stored.variables.items()
    }
    return plain, str(stored.attrs)


KINDS = {
    "run": Kind(make_run, "run.nc", read_run),
    "run that is drawn": Kind(make_run, "run.nc", drawn),
    "checkpoint": Kind(make_run, "run.nc", resumed),
    "annotated checkpoint": Kind(annotate, "run.nc", resumed),
    "steps": Kind(make_steps, "steps.nc", read_steps),
    "store": Kind(make_sweep, "s.zarr/**/*", gone_on_with),
    "store of runs": Kind(make_sweep_with_runs, "s.zarr/**/*", gone_on_with_runs),
    "borders": Kind(make_borders, "s.zarr/borders.json", kept_borders),
    "answer": Kind(keep_answer, "*", kept_answer),
}

if __name__ == "__main__":
    sys.stdout.write(json.dumps(counts(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]))))
