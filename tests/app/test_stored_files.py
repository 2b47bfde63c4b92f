"""Files that commands write, read by plot, movie and resume."""

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from commands import Ask, answer, refused
from small_sweeps import AXES, QUICK, sweep_of
from undula.app.cli import main
from undula.sweeps.store import open_sweep

TINY = [
    *("--set", "model.segments=4", "--set", "time.until=0.01", "--set", "time.samples=20"),
]


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Give a folder with a stored ramp, a study and a saved answer."""
    folder = tmp_path_factory.mktemp("results")
    assert main(["step", *TINY, "--along", "load.force=1,2", "--out", str(folder)]) == 0
    open_sweep(folder / "study.zarr", sweep_of(folder, QUICK + AXES))
    (folder / "answer.json").write_text(json.dumps({"status": "done", "points": []}))
    return folder


@pytest.fixture(autouse=True)
def _there(results: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.chdir(results)
    before = {path.name: path.stat().st_mtime_ns for path in results.iterdir()}
    yield
    after = {path.name: path.stat().st_mtime_ns for path in results.iterdir()}
    assert {name: after[name] for name in before if name != "steps.png"} == {
        name: time for name, time in before.items() if name != "steps.png"
    }


def test_a_ramp_is_drawn_from_its_file_as_the_command_has_drawn_it(ask: Ask) -> None:
    first = Path("steps.png").read_bytes()
    assert answer(ask("plot", "steps.nc", "--json")) == {"status": "done", "figure": "steps.png"}
    assert Path("steps.png").read_bytes() == first
    assert ask("plot", "steps.nc", "--out", "ramp.svg")[:2] == (0, "ramp.svg\n")
    assert "<svg" in Path("ramp.svg").read_text()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("movie steps.nc", "steps.nc is a ramp, which has no movie; undula plot draws it"),
        ("movie study.zarr", "study.zarr is a study of many runs, which has no movie"),
        ("resume steps.nc", "steps.nc is a ramp, which the same undula step continues"),
        ("resume study.zarr", "a study of many runs, which the same undula sweep continues"),
        ("plot answer.json", "give --plot FILE to the command that answers with it"),
        ("plot steps.nc --borders", "--borders is about studies, and steps.nc is none"),
        ("plot steps.nc --at load.force=1", "--at is about studies, and steps.nc is none"),
    ],
)
def test_what_cannot_be_made_of_a_file_is_refused_with_the_cure(
    words: str, said: str, ask: Ask
) -> None:
    assert said in refused(ask(*words.split()))
