"""The stored results that examples in docstrings name, each computed in a moment."""

import contextlib
import io
from pathlib import Path

from small_sweeps import done, sweep_of
from undula.app.cli import main

#: A filament of a few links, run for a moment.
_MODEL = "[model]\nsegments = 4\n[time]\nuntil = 0.05\nsamples = 60\n"
_FORCES = '[[study.axes]]\nkey = "load.force"\nvalues = [25.0, 75.0, 125.0]\n'
_POINT_LOADS = '[load]\nprofile = "point"\n[study]\nkeep = "period"\n'
_POSITIONS = '[[study.axes]]\nkey = "load.position"\nvalues = [0.5, 1.0]\n'
_STARTS = '[study]\npolicy = "random"\ntries = 3\namplitudes = [0.01, 1.0]\n'


def write_results(folder: Path) -> None:
    """Write a run, a ramp and two sweeps below a folder, as their commands do."""
    results = folder / "results"
    results.mkdir()
    short = folder / "short.toml"
    short.write_text(_MODEL, "utf-8")
    _do("run", str(short), "--out", str(results / "spinning"))
    _do("step", str(short), "--along", "load.force=25:75:25", "--out", str(results))
    point_loads = _MODEL + _POINT_LOADS + _POSITIONS + _FORCES
    done(sweep_of(folder, point_loads), results / "point-loads.zarr")
    done(sweep_of(folder, _MODEL + _STARTS + _FORCES), results / "starts.zarr")


def _do(*words: str) -> None:
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        status = main(list(words))
    assert status == 0, words
