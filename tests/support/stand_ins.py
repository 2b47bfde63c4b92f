"""Small stand-ins for what pages take for granted: examples, results, and where work begins."""

from pathlib import Path
from typing import Any, NoReturn

import pytest

from pages import ROOT
from small_sweeps import done, sweep_of
from undula.analysis.parameters import changed, value_of
from undula.analysis.solvers.state_kinds import kind_by_name
from undula.analysis.solvers.thresholds import THRESHOLDS
from undula.app.cli import main
from undula.inputs.build import build_model

STUDY = """
[model]
segments = 4
[load]
profile = "point"
[time]
until = 0.05
samples = 60
[[study.axes]]
key = "load.position"
values = [0.9, 1.0]
[[study.axes]]
key = "load.force"
values = [20, 100]
"""
QUICK = ["--set", "time.until=0.02", "--set", "time.samples=100"]
FEW_LINKS = ["--set", "model.kind=chain", "--set", "time.until=0.5", "--set"]


def examples_in(folder: Path) -> None:
    """Put the examples where a reader has them who stands at the root of the repository."""
    (folder / "examples").symlink_to(ROOT / "examples")


def results_in(folder: Path) -> None:
    """Make small results of the kinds and names that pages open; the folder is the working one."""
    run = ["run", "--set", "model.segments=4", *QUICK, "--no-movie", "--out", "results/spinning"]
    assert main(run) == 0
    for links in range(2, 7):
        along = ["--along", "load.force=1:2:2", "--out", f"results/chain{links}"]
        assert main(["step", *FEW_LINKS, f"model.links={links}", *along]) == 0
    done(sweep_of(folder, STUDY), folder / "results" / "point-loads.zarr")


class BegunError(Exception):
    """A command has understood its line and would begin to work."""


def _begins(*_: Any, **__: Any) -> NoReturn:
    raise BegunError


def _finds(_: Any, kind: str, **__: Any) -> NoReturn:
    kind_by_name(kind)
    raise BegunError


def _follows(model: Any, kind: str, way: Any, **_: Any) -> NoReturn:
    value_of(model, way.parameter)
    if kind != "straight":
        kind_by_name(kind)
    raise BegunError


def _tells(model: Any, threshold: str, along: Any = None, **_: Any) -> NoReturn:
    assert threshold in THRESHOLDS
    if along is not None:
        changed(model, along[0], along[1][0])
    raise BegunError


def _asks(question: Any) -> NoReturn:
    if question.along is not None:
        parameter, values = question.along
        changed(build_model(question.wanted), parameter, values[0])
    raise BegunError


BEGINNINGS = {
    "undula.app.commands.run_job.begin": _begins,
    "undula.app.commands.run_job.resumed": _begins,
    "undula.app.commands.step.run_ramp": _begins,
    "undula.app.commands.stability.analyse": _asks,
    "undula.app.commands.find_start.load_result": _begins,
    "undula.app.commands.find.find_state": _finds,
    "undula.app.commands.follow.follow_along": _follows,
    "undula.app.commands.threshold.answer_threshold": _tells,
    "undula.app.commands.threshold.answer_threshold_curve": _tells,
    "undula.app.commands.sweep.open_sweep": _begins,
    "undula.app.commands.sweep.load_sweep": _begins,
    "undula.app.commands.plot_sweep.plot_sweep": _begins,
    "undula.reproduction.reproduce.tasks_of": _begins,
    "undula.storage.run_file.load_result": _begins,
}


def stop_where_work_begins(monkeypatch: pytest.MonkeyPatch) -> None:
    """Have every command raise `BegunError` where its work would begin."""
    for place, beginning in BEGINNINGS.items():
        monkeypatch.setattr(place, beginning)
