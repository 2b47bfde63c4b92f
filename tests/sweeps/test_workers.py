"""Real workers: what is asked of them, who may talk to them, and what becomes of lost ones."""

import asyncio
import http.client
import json
import os
import signal
import subprocess
import sysconfig
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import dask
import psutil
import pytest
import xarray as xr
from distributed import Security, get_worker, rpc

from cases import mostly_slow
from small_sweeps import AXES, QUICK, differing, done, sweep_of
from undula.app.cli import main
from undula.errors import InputError
from undula.storage.run_file import load_checkpoint, load_result
from undula.sweeps import own_workers
from undula.sweeps import workers as pool_module
from undula.sweeps.own_workers import MEMORY_OF_WORKER, workers_that_fit
from undula.sweeps.point import point_records, row_records
from undula.sweeps.store import load_sweep, open_sweep
from undula.sweeps.sweep import Sweep
from undula.sweeps.work_queue import SweepWork
from undula.sweeps.workers import LostError, Pool, pool

# Dask and tornado leave sockets to the garbage collection, which pytest tells of.
pytestmark = pytest.mark.filterwarnings("ignore")

SCRIPTS = Path(sysconfig.get_path("scripts"))
#: Processes may have to compile the kernels first.
PATIENCE = 300.0


@pytest.fixture(scope="module")
def told() -> list[str]:
    """What a pool says."""
    return []


@pytest.fixture(scope="module")
def one(told: list[str]) -> Iterator[Pool]:
    """Give a pool of one worker, which most tests share."""
    with pool(1, None, told.append) as workers:
        assert asked(workers, os.getpid) != os.getpid()
        yield workers


def asked(workers: Pool, work: Callable[..., Any], *what: Any) -> Any:
    """Return what a worker comes to."""
    workers.give(None, work, *what)
    end = time.monotonic() + PATIENCE
    while not (back := list(workers.come_back(0.05))):
        assert time.monotonic() < end
    return back[0][1]


def swept(workers: Pool, sweep: Sweep, path: Path) -> xr.Dataset:
    """Return a study done by workers, as a sweep does it."""
    work, each = (
        SweepWork(open_sweep(path, sweep)),
        row_records if sweep.whole_rows else point_records,
    )
    while work.left:
        while workers.has_room and (task := work.take()) is not None:
            workers.give(task, each, sweep.dump(), task.numbers)
        for task, (_, records) in workers.come_back(0.2):
            work.take_back(task, records)
    work.save()
    return load_sweep(path).load()


# ---------------------------------------------------------------- whatever is documented for sweeps

#: By what the page on sweeps calls it.
SETTINGS = {
    "keep verdict": 'keep = "verdict"',
    "keep period": 'keep = "period"',
    "keep run": 'keep = "run"',
    "policy random": 'policy = "random"\ntries = 2\nseed = 3',
    "policy neighbour": 'policy = "neighbour"\ndirection = "down"\nkick = 1e-3',
    "undecided solve": 'undecided = "solve"',
    "label solved": 'label = "solved"',
}
FORCES = """
[[study.axes]]
key = "load.force"
values = [20, 60]
"""
LOG = AXES.replace("count = 5", 'count = 2\nspacing = "log"')


@pytest.mark.parametrize(
    "name", mostly_slow(SETTINGS, lambda name: name in ("keep verdict", "keep run"))
)
def test_workers_come_to_what_this_process_comes_to(name: str, one: Pool, tmp_path: Path) -> None:
    table = f"[study]\n{SETTINGS[name]}\n"
    text = QUICK + table + LOG
    if name == "label solved":  # of profiles there are no solved states
        text = text.replace('profile = "power"', "")
        text = text[: text.index("[[study.axes]]")] + FORCES
    sweep = sweep_of(tmp_path, text)
    here, there = done(sweep, tmp_path / "here.zarr"), swept(one, sweep, tmp_path / "there.zarr")
    assert set(there["status"].values.ravel()) == {1}
    assert differing(here, there) == []


def test_runs_that_workers_keep_are_results_that_can_be_resumed(one: Pool, tmp_path: Path) -> None:
    sweep = sweep_of(tmp_path, QUICK + '[study]\nkeep = "run"\n' + LOG)
    swept(one, sweep, tmp_path / "s.zarr")
    done(sweep, tmp_path / "here.zarr")
    kept = sorted((tmp_path / "s.zarr" / "runs").iterdir())
    assert len(kept) == sweep.count
    for path in kept:
        assert load_result(path).sizes["time"] == load_checkpoint(path)["states"].shape[0]
        assert path.read_bytes() == (tmp_path / "here.zarr" / "runs" / path.name).read_bytes()


# ---------------------------------------------------------------- nobody else is let in


def ports() -> set[int]:
    """Return the ports on which this process and its children listen."""
    tree = [psutil.Process(), *psutil.Process().children(recursive=True)]
    found = [one for process in tree for one in process.net_connections("tcp")]
    return {one.laddr.port for one in found if one.status == psutil.CONN_LISTEN}


def answers(address: str, security: Security) -> bool:
    """Tell whether a scheduler or worker talks to somebody with these keys."""

    async def ask() -> None:
        arguments = security.get_connection_args("client")
        async with rpc(address, timeout=1.0, connection_args=arguments) as there:
            await asyncio.wait_for(there.identity(), 2.0)

    try:
        asyncio.run(ask())
    except (OSError, TimeoutError):
        return False
    return True


def test_whoever_has_not_the_key_of_the_moment_cannot_talk_to_workers(one: Pool) -> None:
    scheduler = one._client.scheduler.address
    assert answers(scheduler, one._client.security)
    found = ports()
    assert len(found) >= 4  # a scheduler, its pages, a worker, and who watches over it
    for port in found:
        assert not answers(f"tcp://127.0.0.1:{port}", Security())
        assert not answers(f"tls://127.0.0.1:{port}", Security.temporary())


def test_the_dashboard_is_found_by_whoever_was_told_its_address(one: Pool, told: list[str]) -> None:
    assert one.busy is False
    (link,) = [sentence.removeprefix("dashboard: ") for sentence in told if "dashboard" in sentence]
    host, word, page = link.removeprefix("http://").split("/")
    assert page == "status"
    assert len(word) >= 32
    assert _status_of(host, f"/{word}/status") == 200
    assert _status_of(host, f"/{word}/statics/css/base.css") == 200
    for path in ("/", "/status", "/sitemap.json", "/json/counts.json", f"/{word[:-1]}/status"):
        assert _status_of(host, path) == 404


def _status_of(host: str, path: str) -> int:
    connection = http.client.HTTPConnection(host, timeout=10.0)
    connection.request("GET", path)
    status = connection.getresponse().status
    connection.close()
    return status


def _profiled() -> tuple[bool, list[str]]:
    return (
        dask.config.get("distributed.worker.profile.enabled"),
        [name for name in get_worker().periodic_callbacks if "profile" in name],
    )


def test_workers_keep_no_record_of_what_they_were_at(one: Pool) -> None:
    assert asked(one, _profiled) == (False, [])


def _blocked() -> set[int]:
    return set(signal.pthread_sigmask(signal.SIG_BLOCK, ()))


def test_workers_leave_signals_to_the_driver(one: Pool) -> None:
    assert asked(one, _blocked) >= {signal.SIGINT, signal.SIGTERM, signal.SIGHUP}
    assert _blocked() == set()


# ---------------------------------------------------------------- workers that are lost


def _workers() -> list[psutil.Process]:
    found = psutil.Process().children(recursive=True)
    return [process for process in found if "spawn_main" in " ".join(process.cmdline())]


def test_killed_workers_are_made_good(one: Pool) -> None:
    before = asked(one, os.getpid)
    for process in _workers():
        process.kill()
    assert asked(one, os.getpid) != before


def test_a_worker_that_was_given_up_is_made_good(
    one: Pool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pool_module, "REPLACE_EVERY", 0.5)
    before = asked(one, os.getpid)
    cluster = one._client.cluster
    # What watches over the worker ends, as it does if the worker cannot start.
    cluster.sync(next(iter(cluster.workers.values())).close)
    one._replace_due = 0.0
    assert asked(one, os.getpid) != before


@pytest.mark.slow
def test_a_study_without_workers_is_left_after_a_while(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    # Python reads this at its start, and no worker ever comes.
    (tmp_path / "sitecustomize.py").write_text("import os; os._exit(1)\n", encoding="utf-8")
    monkeypatch.setattr(own_workers, "MEMORY", {"PYTHONPATH": str(tmp_path)})
    # Dask sets it in this process, too, where it was not set: it is forgotten afterwards.
    monkeypatch.setenv("PYTHONPATH", "")
    monkeypatch.delenv("PYTHONPATH")
    monkeypatch.setattr(pool_module, "OWN_PATIENCE", 3.0)
    monkeypatch.setattr(pool_module, "REPLACE_EVERY", 1.0)
    sweep_of(tmp_path, QUICK + AXES)
    words = ["sweep", str(tmp_path / "study.toml"), "--workers", "1", "--json"]
    assert main([*words, "--out", str(tmp_path / "s.zarr")]) == 3
    said = capsys.readouterr()
    assert json.loads(said.out)["status"] == "no workers"
    assert "the study was left without workers with 10 of 10 points to go" in said.err
    assert "Traceback" not in said.err


# ---------------------------------------------------------------- what does not fit


@pytest.mark.parametrize(
    ("count", "told"),
    [
        (100_000, "--workers 100000 would take 12500 processors with 8 processes on each"),
        (12, "--workers 12 would take 3.6 GB of memory, about 300 MB each, and there are 2.0 GB"),
    ],
)
def test_workers_that_do_not_fit_are_refused_before_anything_begins(
    count: int,
    told: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(own_workers, "CPU_COUNT", 2)
    monkeypatch.setattr(own_workers, "MEMORY_LIMIT", 2e9)
    sweep_of(tmp_path, QUICK + AXES)
    words = ["sweep", str(tmp_path / "study.toml"), "--workers", str(count)]
    assert main([*words, "--out", str(tmp_path / "s.zarr")]) == 2
    assert told in capsys.readouterr().err
    assert not (tmp_path / "s.zarr").exists()
    assert main(["reproduce", "--workers", str(count), "--out", str(tmp_path / "report")]) == 2
    assert told in capsys.readouterr().err
    assert not (tmp_path / "report").exists()


def test_without_a_number_as_many_workers_start_as_fit(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(own_workers, "CPU_COUNT", 8)
    monkeypatch.setattr(own_workers, "MEMORY_LIMIT", 2e9)
    assert workers_that_fit(None) == 6
    assert workers_that_fit(1) == 1
    monkeypatch.setattr(own_workers, "MEMORY_LIMIT", 0.5 * MEMORY_OF_WORKER)
    assert workers_that_fit(None) == 1


# ---------------------------------------------------------------- a scheduler of its own


@contextmanager
def scheduler_alone(folder: Path) -> Iterator[tuple[str, subprocess.Popen[bytes]]]:
    """Yield the address of a scheduler without workers, and its process."""
    file = folder / "scheduler.json"
    words = ["--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--scheduler-file", str(file)]
    process = subprocess.Popen(
        [SCRIPTS / "python", "-m", "distributed.cli.dask_scheduler", *words],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    try:
        end = time.monotonic() + PATIENCE
        while not (file.exists() and file.read_text().strip()):
            assert time.monotonic() < end
            time.sleep(0.05)
        yield json.loads(file.read_text())["address"], process
    finally:
        process.kill()
        process.wait()


@pytest.mark.slow
def test_a_scheduler_without_workers_and_one_that_is_gone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(pool_module, "NOTIFY_AFTER", 0.5)
    sweep = sweep_of(tmp_path, QUICK + AXES)
    words = ["sweep", str(tmp_path / "study.toml"), "--out", str(tmp_path / "s.zarr"), "--json"]
    with scheduler_alone(tmp_path) as (address, process):

        def ended(*more: str) -> tuple[str, str]:
            assert main([*words, "--scheduler", address, *more]) == 3
            said = capsys.readouterr()
            assert "10 of 10 points to go" in said.err
            assert "Traceback" not in said.err
            return json.loads(said.out)["status"], said.err

        status, told = ended("--budget", "3")
        assert status == "out of time"
        assert "the scheduler has no workers; waiting for 600 s for some" in told
        with monkeypatch.context() as patch:
            patch.setattr(pool_module, "FOREIGN_PATIENCE", 1.5)
            assert ended()[0] == "no workers"
        with pool(None, address, print) as workers:
            # It stops for good amid a study, wherever the driver is just then.
            workers.give(None, point_records, sweep.dump(), (0,))
            process.kill()
            process.wait()
            with pytest.raises(LostError, match="left by its scheduler"):
                asked(workers, point_records, sweep.dump(), (1,))
            for act in (lambda: workers.has_room, lambda: list(workers.come_back(0.1))):
                workers._count_due = 0.0
                with pytest.raises(LostError):
                    act()
    monkeypatch.setattr(pool_module, "PATIENCE", 1.0)
    with pytest.raises(InputError, match="no Dask scheduler answers"), pool(None, address, print):
        pass


# ---------------------------------------------------------------- the whole command


def started(*words: str | Path) -> subprocess.Popen[str]:
    """Start a sweep in a process group of its own."""
    command = [str(SCRIPTS / "undula"), "sweep", *map(str, words)]
    pipe = subprocess.PIPE
    return subprocess.Popen(command, stdout=pipe, stderr=pipe, text=True, start_new_session=True)


@pytest.mark.slow
def test_of_sweeps_that_begin_together_one_goes_on_and_the_other_says_so(tmp_path: Path) -> None:
    sweep_of(tmp_path, QUICK.replace("0.05", "2.0") + AXES)
    store = tmp_path / "s.zarr"
    both = [started(tmp_path / "study.toml", "--workers", "1", "--out", store) for _ in range(2)]
    told = [command.communicate(timeout=PATIENCE)[1] for command in both]
    assert sorted(command.returncode for command in both) == [0, 2], told
    (refused,) = [said for command, said in zip(both, told, strict=True) if command.returncode]
    assert refused == (
        f"undula: another undula sweep is at work on {store}; wait for it, or give another --out\n"
    )
    assert set(load_sweep(store)["status"].values.ravel()) == {1}


ENDLESS = QUICK.replace("0.05", "50.0") + '[study]\npolicy = "random"\ntries = 100\n' + AXES
slow = pytest.mark.slow


@pytest.mark.slow
@pytest.mark.parametrize(
    ("ending", "after"),
    [
        (signal.SIGTERM, 0.0),
        pytest.param(signal.SIGINT, 0.0, marks=slow),
        pytest.param(signal.SIGINT, 0.7, marks=slow),
        pytest.param(signal.SIGHUP, 0.7, marks=slow),
        pytest.param(signal.SIGTERM, 6.0, marks=slow),
        pytest.param(signal.SIGHUP, 6.0, marks=slow),
    ],
)
def test_a_sweep_that_is_ended_keeps_all_also_while_workers_start(
    ending: signal.Signals, after: float, tmp_path: Path
) -> None:
    sweep_of(tmp_path, ENDLESS)
    store = tmp_path / "s.zarr"
    command = started(tmp_path / "study.toml", "--workers", "2", "--out", store, "--json")
    assert command.stderr is not None
    first = command.stderr.readline()
    while "dashboard" not in first:
        first = command.stderr.readline()
        assert command.poll() is None
    time.sleep(after)
    children = psutil.Process(command.pid).children(recursive=True)
    # As a terminal or a batch system does: to all processes of the command.
    os.killpg(command.pid, ending)
    said, told = command.communicate(timeout=PATIENCE)
    assert command.returncode == 3, told
    answer = json.loads(said)
    assert answer["status"] == "interrupted"
    lines = [line for line in told.splitlines() if not line.startswith("sweeping")]
    assert len(lines) == 1, told
    assert lines[0].startswith("undula: the study was interrupted with")
    counts = answer["points"]
    assert counts["done"] == int((load_sweep(store)["status"].values == 1).sum())
    assert psutil.wait_procs(children, timeout=PATIENCE)[1] == []
