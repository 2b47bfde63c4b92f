"""The commands sweep and status: their answers, and what becomes of killed processes."""

import json
import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib.metadata import version
from pathlib import Path
from typing import Any

import psutil
import pytest
import xarray as xr

from commands import (
    PATIENCE,
    SCRIPTS,
    UNDULA,
    Ask,
    answer,
    ended,
    in_process,
    refused,
    started,
    text,
)
from small_sweeps import AXES, QUICK, differing, done
from undula.sweeps import own_workers
from undula.sweeps import workers as pool_module
from undula.sweeps.store import load_sweep, open_sweep
from undula.sweeps.sweep import read_sweep
from undula.sweeps.work_queue import SweepWork
from undula.sweeps.workers import DiedError, pool

#: Beats of some links for a while, long enough together for whoever is killed in between.
LONGER = """
[model]
segments = 5
confined = true
[time]
until = 1.0
samples = 400
[study]
policy = "random"
tries = 4
[[study.axes]]
key = "model.drag_ratio"
values = [1.5, 2.0, 2.5]
[[study.axes]]
key = "load.force"
from = 100.0
to = 300.0
count = 20
"""


def written(folder: Path, text: str) -> Path:
    path = folder / "study.toml"
    path.write_text(text, encoding="utf-8")
    return path


def done_points(store: Path) -> int:
    return int((load_sweep(store)["status"].values != 0).sum()) if store.exists() else 0


def wait_for(condition: Callable[[], bool], command: subprocess.Popen[str]) -> None:
    end = time.monotonic() + PATIENCE
    while not condition():
        assert command.poll() is None, command.communicate()[1]
        assert time.monotonic() < end
        time.sleep(0.05)


def worker_processes(command: subprocess.Popen[str]) -> list[psutil.Process]:
    """Return the workers of a sweep on this machine."""
    children = psutil.Process(command.pid).children(recursive=True)
    return [child for child in children if is_worker(child)]


def is_worker(process: psutil.Process) -> bool:
    try:
        return "spawn_main" in " ".join(process.cmdline())
    except psutil.Error:  # it is dead, or about to be
        return False


@pytest.fixture(scope="module")
def swept(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, Any]]:
    """Give the file of a small study that two workers swept, and the answer; the store is there."""
    folder = tmp_path_factory.mktemp("swept")
    file = written(folder, QUICK + AXES)
    words = ("sweep", file, "--workers", "2", "--out", folder / "s.zarr", "--json")
    return file, answer(ended(started(UNDULA, *words)))


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, xr.Dataset]:
    """Give the file of a longer study, and what it comes to when nobody disturbs it."""
    folder = tmp_path_factory.mktemp("undisturbed")
    file, store = written(folder, LONGER), folder / "s.zarr"
    answer(ended(started(UNDULA, "sweep", file, "--workers", "2", "--out", store, "--json")))
    return file, load_sweep(store).load()


def test_two_workers_reach_what_this_process_reaches(
    swept: tuple[Path, dict[str, Any]], tmp_path: Path
) -> None:
    here = done(read_sweep(swept[0]), tmp_path / "here.zarr")
    assert differing(here, load_sweep(swept[0].parent / "s.zarr").load()) == []


def test_a_sweep_answers_with_one_object(swept: tuple[Path, dict[str, Any]]) -> None:
    file, found = swept
    assert found["status"] == "done"
    assert found["points"] == {"all": 10, "done": 10, "failed": 0, "to_go": 0}
    assert sum(found["verdicts"].values()) == 10
    assert found["axes"][1] == {"key": "load.force", "count": 5, "first": 20.0, "last": 240.0}
    assert found["store"] == str(file.parent / "s.zarr")
    assert found["failures"] == []
    assert {"load", "units", "seconds", "label", "policy", "keep", "tries"} <= found.keys()


def test_the_status_of_a_store_is_told_without_its_input(
    swept: tuple[Path, dict[str, Any]], ask: Ask
) -> None:
    store = swept[0].parent / "s.zarr"
    found = answer(ask("status", store, "--json"))
    assert found == {key: value for key, value in swept[1].items() if key != "seconds"}
    said = text(ask("status", store))
    for words in ("power load: done", "load.force from 20 to 240, 5 values", "10 of 10 done"):
        assert words in said


def test_a_study_that_is_done_starts_no_workers(
    swept: tuple[Path, dict[str, Any]],
    ask: Ask,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("undula.sweeps.compute.pool", lambda *_: pytest.fail("they were started"))
    store = swept[0].parent / "s.zarr"
    again = answer(ask("sweep", swept[0], "--out", store, "--json"))
    assert again["verdicts"] == swept[1]["verdicts"]


REFUSED = {
    "--set time.samples=70": "holds another study, with time.samples = 60 instead of 70",
    "--workers 0": "--workers 0 is out of range",
    "--workers 2 --scheduler tcp://127.0.0.1:9": "leave out one of them",
    "--budget nan": "--budget nan is out of range",
    "--set load.force=x": "load.force = 'x' is text",
}


@pytest.mark.parametrize("words", REFUSED)
def test_a_wrong_call_gets_one_sentence_and_status_2(
    words: str, swept: tuple[Path, dict[str, Any]], ask: Ask
) -> None:
    store = swept[0].parent / "s.zarr"
    asked = ask("sweep", swept[0], "--out", store, *words.split(), "--json")
    assert REFUSED[words] in answer(asked, status=2)["error"]
    assert len(asked.told.splitlines()) == 1


def test_a_scheduler_that_does_not_answer_is_told(
    tmp_path: Path, ask: Ask, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pool_module, "PATIENCE", 0.2)
    file = written(tmp_path, QUICK + AXES)
    words = ["--scheduler", "tcp://127.0.0.1:1", "--out", tmp_path / "s.zarr"]
    told = refused(ask("sweep", file, *words))
    assert "no Dask scheduler answers at --scheduler tcp://127.0.0.1:1" in told


@pytest.mark.slow
def test_a_budget_and_ctrl_c_leave_a_study_that_goes_on(
    undisturbed: tuple[Path, xr.Dataset], tmp_path: Path
) -> None:
    file, whole = undisturbed
    words = ("sweep", file, "--workers", "2", "--out", tmp_path / "s.zarr", "--json")
    first = answer(ended(started(UNDULA, *words, "--budget", "1")), status=3)
    assert first["status"] == "out of time"
    second = started(UNDULA, *words)
    wait_for(lambda: done_points(tmp_path / "s.zarr") > first["points"]["done"], second)
    # As from a terminal: to all processes of the command.
    os.killpg(second.pid, signal.SIGINT)
    said, told = second.communicate(timeout=PATIENCE)
    assert second.returncode == 3, told
    assert "the same command goes on" in told
    assert "Traceback" not in told
    counts = json.loads(said)["points"]
    assert 0 < counts["to_go"] < counts["all"] == whole["status"].size
    assert answer(ended(started(UNDULA, *words)))["status"] == "done"
    assert differing(load_sweep(tmp_path / "s.zarr").load(), whole) == []


@pytest.mark.slow
def test_killed_workers_and_a_killed_driver_change_nothing(
    undisturbed: tuple[Path, xr.Dataset], tmp_path: Path
) -> None:
    file, whole = undisturbed
    chance, store = random.Random(1), tmp_path / "s.zarr"
    words = ("sweep", file, "--workers", "2", "--out", store, "--json")
    command = started(UNDULA, *words)
    for _ in range(3):
        wait_for(lambda: len(worker_processes(command)) == 2, command)
        time.sleep(chance.uniform(0.5, 4.0))
        for worker in worker_processes(command):
            worker.kill()
    already = done_points(store)
    wait_for(lambda: done_points(store) > already, command)
    workers = worker_processes(command)
    command.kill()
    command.communicate(timeout=PATIENCE)
    assert psutil.wait_procs(workers, timeout=PATIENCE)[1] == []
    before = done_points(store)
    assert 0 < before < whole["status"].size
    found = answer(ended(started(UNDULA, *words)))
    assert found["points"]["done"] == whole["status"].size
    assert differing(load_sweep(store).load(), whole) == []


@contextmanager
def scheduler_of_its_own(folder: Path) -> Iterator[tuple[str, Callable[[], Any]]]:
    """Yield the address of a scheduler that was started by its own command, and how to add workers.

    A worker that is killed is gone: nobody watches over it.
    """
    file = folder / "scheduler.json"
    here = ("--host", "127.0.0.1")
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    processes = []

    def start(*words: str) -> subprocess.Popen[bytes]:
        command = [str(SCRIPTS / "dask"), *words, *here, "--scheduler-file", str(file)]
        processes.append(subprocess.Popen(command, **quiet))
        return processes[-1]

    def add() -> subprocess.Popen[bytes]:
        return start("worker", "--nthreads", "1", "--no-nanny", "--no-dashboard")

    try:
        start("scheduler", "--port", "0", "--no-dashboard")
        end = time.monotonic() + PATIENCE
        while not (file.exists() and file.read_text().strip()):
            assert time.monotonic() < end
            time.sleep(0.05)
        yield json.loads(file.read_text())["address"], add
    finally:
        for process in processes:
            process.kill()
            process.wait()


@pytest.mark.slow
def test_the_same_holds_with_a_scheduler_and_workers_of_their_own(
    undisturbed: tuple[Path, xr.Dataset], tmp_path: Path
) -> None:
    file, whole = undisturbed
    chance, store = random.Random(2), tmp_path / "s.zarr"
    with scheduler_of_its_own(tmp_path) as (address, add):
        workers = [add(), add()]
        words = ("sweep", file, "--scheduler", address, "--out", store, "--json")
        command = started(UNDULA, *words)
        for _ in range(3):
            time.sleep(chance.uniform(2.0, 6.0))
            for worker in workers:
                worker.kill()
            workers = [add(), add()]
        already = done_points(store)
        wait_for(lambda: done_points(store) > already, command)
        command.kill()
        command.communicate(timeout=PATIENCE)
        assert 0 < done_points(store) < whole["status"].size
        assert answer(ended(started(UNDULA, *words)))["status"] == "done"
    assert differing(load_sweep(store).load(), whole) == []


def test_a_point_that_kills_its_workers_is_found_and_recorded(tmp_path: Path) -> None:
    sweep = read_sweep(written(tmp_path, QUICK + AXES))
    work = SweepWork(open_sweep(tmp_path / "s.zarr", sweep))
    deadly, deaths = 3, 0
    while (task := work.take()) is not None:
        if deadly in task.numbers:
            deaths += 1
            work.died(task)
        else:
            work.take_back(task, [{"status": 1, "seconds": 0.2}] * len(task.numbers))
    work.save()
    stored = load_sweep(tmp_path / "s.zarr")
    assert stored["status"].values.ravel().tolist() == [1, 1, 1, 2, 1, 1, 1, 1, 1, 1]
    assert "every worker died" in str(stored["reason"].values.ravel()[3])
    # In the second piece, of five; in a half of it, of two; and twice alone.
    assert deaths == 4


def deadly(jobs: list[dict[str, int]]) -> None:
    """Kill the process that does this."""
    assert jobs
    os.kill(os.getpid(), signal.SIGKILL)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
def test_a_piece_under_which_every_worker_dies_comes_back(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(own_workers, "DEATHS", 1)
    with pool(1, None, print) as workers:
        workers.give("piece", deadly, [{"number": 1}])
        end, back = time.monotonic() + PATIENCE, []
        while not back and time.monotonic() < end:
            back = list(workers.come_back(0.5))
    assert back[0][0] == "piece"
    assert isinstance(back[0][1], DiedError)


@pytest.mark.parametrize("name", ["dask", "zarr", "distributed", "xarray"])
def test_help_on_sweeps_loads_nothing_heavy(name: str) -> None:
    code = (
        "import sys; from undula.app.cli import main; main(['sweep', '--help']);"
        f" sys.exit({name!r} in sys.modules)"
    )
    assert in_process(sys.executable, "-c", code).status == 0


def test_a_store_tells_the_version_that_made_it(swept: tuple[Path, dict[str, Any]]) -> None:
    attributes = load_sweep(swept[0].parent / "s.zarr").attrs
    assert attributes["software"] == version("undula")
    assert json.loads(attributes["versions"])["undula"] == version("undula")
    assert json.loads(attributes["study"])["study"]["axes"][0] == {
        "key": "load.exponent",
        "values": [0.5, 2.0],
    }
