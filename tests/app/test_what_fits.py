"""What cannot fit is refused before it runs, with what it would take; ends are told."""

import math
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest

import undula as un
from refusal import complaint
from small_sweeps import sweep_of
from undula.analysis.ramps.ramp import MOST_STEPS, Ramp
from undula.analysis.run_settings import MAX_SAMPLES, Schedule
from undula.analysis.runs import memory_needed as room
from undula.analysis.runs.memory_needed import memory, needed_memory, refuse_too_large
from undula.analysis.runs.progress import Progress
from undula.inputs.input import parse_input
from undula.inputs.overrides import read_toml
from undula.inputs.ramp_values import parse_ramp
from undula.inputs.ranges import parse_values
from undula.inputs.sweep_table import MOST_POINTS
from undula.sweeps import disk_space as store_room
from undula.sweeps.store import open_sweep
from undula.terminal.run_progress import far_too_long

UNDULA = str(Path(sysconfig.get_path("scripts")) / "undula")
TEN = un.Filament(10, un.TipLoad(75.0))

AXES = """
[model]
segments = 10
[[study.axes]]
key = "load.force"
from = 20.0
to = 100.0
count = {count}
"""


# ------------------------------------------------------------------ memory


def test_samples_that_do_not_fit_are_refused_with_the_memory_they_take(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(room, "memory", lambda: 16 * 10**9)
    for until in (1.0, "settled", "solved"):
        many = Schedule(until=until, samples=10**8)
        told = complaint(lambda many=many: refuse_too_large(TEN, many))
        assert "samples = 100000000 of 11 nodes" in told
        assert "16 GB" in told
        refuse_too_large(TEN, Schedule(until=until, samples=10**5))
    # Positions alone, 24 bytes a node, are 26 GB.
    assert needed_memory(TEN, Schedule(samples=10**8)) > 26 * 10**9


def test_what_is_refused_is_so_before_anything_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(room, "memory", lambda: 10**8)
    assert "memory" in complaint(lambda: un.integrate(TEN, un.kicked(TEN), samples=10**6))


def test_a_study_is_refused_for_one_point_that_does_not_fit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(room, "memory", lambda: 10**9)
    told = complaint(lambda: sweep_of(tmp_path, AXES.format(count=3), "time.samples=100000000"))
    assert "cannot run at load.force = 20.0" in told
    assert "memory" in told


def test_what_a_run_takes_is_no_more_than_is_told() -> None:
    # The arrays themselves; and what is told is at most some times that.
    run = un.integrate(TEN, un.kicked(TEN), until=0.01, samples=20000)
    held = run.checkpoint["states"].nbytes + run.motion.nodes.nbytes
    assert held < needed_memory(TEN, run.schedule) < 3 * held


def test_memory_is_that_of_the_machine_or_less() -> None:
    found = memory()
    assert found is None or 10**7 < found < 10**15


LIMITED = """
import resource, sys
resource.setrlimit(resource.RLIMIT_AS, (6_000_000_000, 6_000_000_000))
from undula.app.cli import main
sys.exit(main(sys.argv[1:]))
"""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="limits of address space are Linux's")
def test_the_command_keeps_to_the_limit_of_its_process(tmp_path: Path) -> None:
    words = ["run", "--set", "model.segments=10", "--set", "time.until=0.01", "--no-movie"]
    words += ["--set", "time.samples=100000000", "--out", str(tmp_path / "r")]
    asked = subprocess.run(
        [sys.executable, "-c", LIMITED, *words],
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert asked.returncode == 2, asked.stderr
    assert len(asked.stderr.strip().splitlines()) == 1
    assert "GB" in asked.stderr
    assert not list(tmp_path.rglob("*.nc"))


# ------------------------------------------------------------------ upper ends


@pytest.mark.parametrize(
    ("tables", "end"),
    [
        ({"time": {"samples": 10**15}}, MAX_SAMPLES),
        ({"model": {"segments": 10**6}}, 2000),
        ({"model": {"kind": "chain", "links": 10**6}}, 1000),
        ({"time": {"atol": 1.0}}, 0.01),
        ({"time": {"rtol": 1.0}}, 0.01),
    ],
)
def test_a_number_with_a_zero_too_many_is_told_its_end(tables: dict, end: float) -> None:
    assert f"{end}" in complaint(lambda: parse_input(tables))


def test_tries_values_and_steps_have_ends_that_are_told(tmp_path: Path) -> None:
    random = ('study.policy="random"', "study.tries=1000000000")
    assert f"{MOST_POINTS}" in complaint(lambda: sweep_of(tmp_path, AXES.format(count=3), *random))
    assert f"{MOST_POINTS}" in complaint(lambda: sweep_of(tmp_path, AXES.format(count=10**7)))
    assert f"{MOST_STEPS}" in complaint(lambda: parse_ramp("--along", "load.force=0:1e9:1"))
    assert f"{MOST_STEPS}" in complaint(lambda: Ramp("load.force", (1.0,) * (MOST_STEPS + 1)))
    assert "1000000" in complaint(lambda: parse_values("--forces", "0:1:10000000"))
    assert "1000000" in complaint(lambda: parse_values("--forces", "1," * 10**6 + "1"))
    for segments in (2001, 10**8, True):
        assert "2000" in complaint(lambda n=segments: un.Filament(n, un.TipLoad(75.0)))


# ------------------------------------------------------------------ files


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="there is no file without end")
def test_a_file_without_end_is_not_read_for_ever() -> None:
    assert "32 MB" in complaint(lambda: read_toml(Path("/dev/zero")))


@pytest.mark.parametrize("keep", ["verdict", "period", "run"])
def test_a_study_that_cannot_fit_on_the_disk_is_refused_before_it_is_laid_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, keep: str
) -> None:
    sweep = sweep_of(tmp_path, AXES.format(count=1000), f"study.keep={keep}")
    monkeypatch.setattr(store_room, "_free", lambda _: 10_000)
    told = complaint(lambda: open_sweep(tmp_path / "s.zarr", sweep))
    assert "1000 points" in told
    assert "10000 bytes" in told
    assert not (tmp_path / "s.zarr").exists()
    monkeypatch.undo()
    open_sweep(tmp_path / "s.zarr", sweep)


# ------------------------------------------------------------------ time


def at(time: float, seconds: float, step: float = 1e-10) -> Progress:
    return Progress(time=time, end=1.0, step=step, steps=10, seconds=seconds)


def test_work_that_takes_days_says_so_once_its_pace_is_known() -> None:
    told = far_too_long(at(1e-6, 20.0), at(0.0, 1.0), settling=False)
    assert "days" in told
    assert "1e-10 T" in told
    assert "--budget" in told
    # Work of minutes does not, nor what was not watched long enough.
    assert far_too_long(at(0.5, 20.0), at(0.0, 1.0), settling=False) == ""
    assert far_too_long(at(1e-6, 2.0), at(0.0, 1.0), settling=False) == ""
    # No time gained at all is as bad.
    assert math.isfinite(len(far_too_long(at(0.0, 20.0), at(0.0, 1.0), settling=True)))
    assert "does not get on" in far_too_long(at(0.0, 20.0), at(0.0, 1.0), settling=True)
