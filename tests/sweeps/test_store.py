"""Claims on a stored study: what is in it, what is trusted, and who may write it."""

import errno
import json
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from zarr.storage import LocalStore

import undula as un
from refusal import complaint
from small_sweeps import (
    AXES,
    QUICK,
    differing,
    done,
    sweep_of,
    verdicts,
    work_off,
    written_in_order,
)
from undula.analysis.observables.shapes import mean_position
from undula.analysis.run_settings import Ending
from undula.analysis.runs.simulation import Simulation
from undula.app.commands.sweep_text import sweep_answer
from undula.inputs.build import build_model, build_start
from undula.inputs.input import parse_input
from undula.sweeps.chunk_grid import MOST_POINTS_OF_CHUNK
from undula.sweeps.point import point_record, point_records
from undula.sweeps.store import load_sweep, open_sweep
from undula.sweeps.work_queue import SweepWork

RANDOM = QUICK + '[study]\npolicy = "random"\ntries = 2\n' + AXES
NEIGHBOUR = QUICK + '[study]\npolicy = "neighbour"\n' + AXES


@pytest.fixture
def small_chunks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Make chunks of a few points, so that a small study has several."""
    monkeypatch.setattr("undula.sweeps.chunk_grid.MOST_POINTS_OF_CHUNK", 4)


def test_xarray_opens_a_store_without_a_warning(tmp_path: Path) -> None:
    sweep = sweep_of(tmp_path, RANDOM)
    open_sweep(tmp_path / "new.zarr", sweep)
    done(sweep, tmp_path / "done.zarr")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        new, full = (xr.open_zarr(tmp_path / f"{name}.zarr").load() for name in ("new", "done"))
    assert new["status"].dims == full["status"].dims == ("load.exponent", "load.force", "try")
    assert full["load.force"].values.tolist() == [20.0, 75.0, 130.0, 185.0, 240.0]
    assert (new["status"].values == 0).all()
    assert (full["status"].values == 1).all()
    assert (new["verdict"].values == "").all()
    assert np.isnan(new["frequency"].values).all()
    assert new["seed"].identical(full["seed"])
    kinds = {name: full[name].dtype.kind for name in ("status", "seed", "verdict", "margin")}
    assert kinds == {"status": "i", "seed": "i", "verdict": "U", "margin": "f"}
    assert full["status"].attrs["flag_meanings"].split() == ["not_done", "done", "failed"]
    assert json.loads(full.attrs["units"])["force"] == "B/L^2"
    assert full["energy_max"].attrs["units"] == "B/L"


def test_a_stored_point_is_what_a_run_of_its_input_tells(tmp_path: Path) -> None:
    sweep = sweep_of(tmp_path, RANDOM)
    stored = done(sweep, tmp_path / "s.zarr")
    for number in (0, 7, 19):
        wanted = parse_input(sweep.tables(number))
        model = build_model(wanted)
        run = un.integrate(model, build_start(wanted, model), until=0.05, samples=60)
        here, told = stored.isel(dict(zip(stored.dims, sweep.place(number), strict=False))), {}
        told = run.summary()
        assert str(here["verdict"].values) == told["verdict"]
        assert str(here["ending"].values) == Ending.DONE.value
        assert float(here["energy_max"]) == told["bending_energy"]["max"]
        assert float(here["tip_radius_min"]) == told["tip_radius"]["min"]
        frequency = np.nan if told["frequency"] is None else told["frequency"]
        np.testing.assert_equal(float(here["frequency"]), frequency)
        assert int(here["seed"]) == wanted.start.seed
    assert len(verdicts(stored)) > 1


def test_the_last_period_is_kept_where_it_is_asked_for(tmp_path: Path) -> None:
    text = QUICK + '[study]\nkeep = "period"\n' + AXES
    stored = done(sweep_of(tmp_path, text), tmp_path / "s.zarr")
    assert stored["shapes"].dims[-3:] == ("shape", "node", "axis")
    assert stored["shapes"].shape == (2, 5, 1, 24, 5, 3)
    # The mean position over several periods ends where that of the last shape is.
    assert stored["path"].shape == (2, 5, 1, 360, 3)
    last = mean_position(stored["shapes"].values[..., -1, :, :])
    assert np.array_equal(stored["path"].values[..., -1, :], last)
    times = stored["shape_times"].values
    assert (np.diff(times, axis=-1) >= 0.0).all()
    tip = np.hypot(stored["shapes"].values[..., -1, 0], stored["shapes"].values[..., -1, 1])
    assert (tip.max(axis=-1) <= stored["tip_radius_max"].values * (1.0 + 1e-12)).all()


def test_whole_runs_are_files_that_every_command_reads(tmp_path: Path) -> None:
    text = QUICK + '[study]\nkeep = "run"\n' + AXES.replace("count = 5", "count = 2")
    stored = done(sweep_of(tmp_path, text), tmp_path / "s.zarr")
    run = un.load(tmp_path / "s.zarr" / "runs" / "1-0-0.nc")
    assert json.loads(run.attrs["input"])["load"] == {
        "profile": "power",
        "force": 20.0,
        "exponent": 2.0,
    }
    assert run.attrs["verdict"] == str(stored["verdict"].values[1, 0, 0])
    assert len(list((tmp_path / "s.zarr" / "runs").iterdir())) == 4
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        xr.open_zarr(tmp_path / "s.zarr")


def test_a_piece_that_takes_too_long_comes_back_in_part_and_loses_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    sweep = sweep_of(tmp_path, QUICK + AXES)
    at_once = done(sweep, tmp_path / "at-once.zarr")
    # Every point takes longer than a piece should.
    monkeypatch.setattr("undula.sweeps.point.TASK_SECONDS", 0.0)
    assert len(point_records(sweep.dump(), range(5))[1]) == 1
    assert differing(done(sweep, tmp_path / "in-part.zarr"), at_once) == []


SOLVED = """
[model]
segments = 6
[load]
profile = "power"
[study]
label = "solved"
"""


@pytest.mark.slow
def test_solved_states_of_a_line_are_those_of_its_points(tmp_path: Path) -> None:
    sweep = sweep_of(tmp_path, SOLVED + AXES)
    assert sweep.whole_rows
    line = done(sweep, tmp_path / "line.zarr")
    assert set(line["verdict"].values.ravel()) >= {"straight", "spinning"}
    for number in (1, 3, 9):
        alone, place = point_record(sweep.request(number)), sweep.place(number)
        assert line["verdict"].values[place] == alone["verdict"]
        # Both are solved for to some 1e-8.
        assert line["frequency"].values[place] == pytest.approx(alone["frequency"], rel=1e-6)


@pytest.mark.slow
def test_a_line_of_solved_states_in_which_a_point_fails_keeps_the_others(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(*_: Any) -> None:
        raise ArithmeticError("no branch")

    monkeypatch.setattr("undula.sweeps.point.stability_along_force", fails)
    found = done(sweep_of(tmp_path, SOLVED + AXES), tmp_path / "s.zarr")
    assert (found["status"] == 1).all()


@pytest.mark.slow
@pytest.mark.usefixtures("small_chunks")
@pytest.mark.parametrize("text", [RANDOM, NEIGHBOUR])
def test_a_study_that_is_gone_on_with_again_and_again_is_the_same(
    text: str, tmp_path: Path
) -> None:
    sweep = sweep_of(tmp_path, text)
    calls = 0
    while True:
        work = SweepWork(open_sweep(tmp_path / "pieces.zarr", sweep))
        if not work_off(work, sweep, 1):
            break
        calls += 1
    assert calls > 1
    at_once = done(sweep, tmp_path / "at-once.zarr")
    assert differing(load_sweep(tmp_path / "pieces.zarr").load(), at_once) == []


@pytest.mark.usefixtures("small_chunks")
def test_the_status_of_a_block_is_written_last_and_no_other_block_is_touched(
    tmp_path: Path,
) -> None:
    sweep = sweep_of(tmp_path, RANDOM)
    store = open_sweep(tmp_path / "s.zarr", sweep)
    work = SweepWork(store)
    work_off(work, sweep, 1)
    names = written_in_order(store, lambda: work_off(work, sweep))
    assert names[-1] == "status"
    assert len(store.grid) > 2
    chunk = {path.name for path in (store.path / "status").iterdir() if path.name[0] != "."}
    statuses = store.statuses()
    assert len(chunk) == len(store.grid)
    assert (statuses == 1).all()


@pytest.mark.slow
@pytest.mark.usefixtures("small_chunks")
@pytest.mark.parametrize("moment", [1, 5, 20, 24])
def test_a_block_that_was_cut_short_while_it_was_written_is_done_again(
    moment: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    sweep = sweep_of(tmp_path, QUICK + AXES)
    put, written = LocalStore.set, 0

    async def cut_short(self: Any, key: str, value: Any) -> None:
        nonlocal written
        written += 1
        if written > moment:
            raise RuntimeError("cut short")
        await put(self, key, value)

    store = open_sweep(tmp_path / "s.zarr", sweep)
    with monkeypatch.context() as patched:
        patched.setattr(LocalStore, "set", cut_short)
        with pytest.raises(RuntimeError):
            work_off(SweepWork(store), sweep)
    unfinished = load_sweep(tmp_path / "s.zarr")["status"].values
    assert (unfinished == 0).sum() >= 10 - 4 * (moment // 20)
    whole = done(sweep, tmp_path / "whole.zarr")
    assert differing(done(sweep, tmp_path / "s.zarr"), whole) == []


def test_a_full_disk_is_told_in_a_sentence_and_what_was_done_is_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("undula.sweeps.chunk_grid.MOST_POINTS_OF_CHUNK", 4)
    sweep = sweep_of(tmp_path, QUICK + AXES)
    store = open_sweep(tmp_path / "s.zarr", sweep)
    work = SweepWork(store)
    work_off(work, sweep, 2)
    kept = load_sweep(store.path)["status"].values.sum()

    async def full(*_: Any) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as patched:
        patched.setattr(LocalStore, "set", full)
        told = complaint(lambda: work_off(work, sweep))
    assert told == (
        f"the disk that holds {tmp_path} is full; free some space or choose another folder"
    )
    assert load_sweep(store.path)["status"].values.sum() == kept > 0


@pytest.mark.slow
def test_failing_points_are_recorded_and_done_again_on_request_only(tmp_path: Path) -> None:
    sweep = sweep_of(tmp_path, QUICK + AXES)
    done(sweep_of(tmp_path, QUICK + '[study]\nkeep = "run"\n' + AXES), tmp_path / "runs.zarr")
    start = tmp_path / "runs.zarr" / "runs" / "0-4-0.nc"
    text = QUICK + f'[start]\nshape = "state"\nfile = "{start}"\n' + AXES
    sweep = sweep_of(tmp_path, text)
    hidden = start.rename(start.with_suffix(".away"))
    failed = done(sweep, tmp_path / "s.zarr")
    assert (failed["status"].values == 2).all()
    assert f"there is no result file {start}" in str(failed["reason"].values[0, 0, 0])
    answer = sweep_answer(failed)
    assert answer["points"] == {"all": 10, "done": 0, "failed": 10, "to_go": 0}
    assert answer["failures"][1] == {
        "load.exponent": 0.5,
        "load.force": 75.0,
        "try": 0,
        "reason": f"there is no result file {start}; check the name",
    }
    hidden.rename(start)
    assert (done(sweep, tmp_path / "s.zarr")["status"].values == 2).all()
    again = done(sweep, tmp_path / "s.zarr", retry_failed=True)
    assert (again["status"].values == 1).all()
    assert differing(again, done(sweep, tmp_path / "other.zarr")) == []


def test_a_fault_in_a_point_is_a_failure_with_its_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    def fault(*_: object) -> None:
        raise ZeroDivisionError("nothing\nleft")

    monkeypatch.setattr(Simulation, "begin", fault)
    job = {"tables": {"model": {"segments": 4}}, "label": "runs", "keep": "verdict"}
    record = point_record(job)
    assert (record["status"], record["reason"]) == (2, "ZeroDivisionError: nothing left")


def test_neighbours_begin_with_what_the_one_before_has_come_to(tmp_path: Path) -> None:
    # Without a kick the straight state stays straight, whatever the force, though nothing stays
    # there: no verdict says so. A bent one leaves it.
    text = NEIGHBOUR.replace("from = 20", "from = 60").replace("[study]", "[study]\nkick = 0.0")
    straight = text + '\n[start]\nshape = "straight"\n'
    stood = done(sweep_of(tmp_path, straight), tmp_path / "straight.zarr")
    assert verdicts(stood) == {"undecided"}
    assert all("has not moved" in reason for reason in stood["reason"].values.ravel())
    # A kick of the next point is of its own seed, and makes it move.
    kicked = straight.replace("kick = 0.0", "kick = 0.1")
    moved = done(sweep_of(tmp_path, kicked), tmp_path / "kicked.zarr")
    assert verdicts(moved) != {"straight"}


def test_neighbours_go_up_or_down(tmp_path: Path) -> None:
    # Far too short to settle, a run is still marked by where it began.
    text = NEIGHBOUR.replace("until = 0.05", "until = 0.002") + '[start]\nshape = "helix"\n'
    up = done(sweep_of(tmp_path, text), tmp_path / "up.zarr")
    down = done(sweep_of(tmp_path, text, 'study.direction="down"'), tmp_path / "down.zarr")
    alone = done(sweep_of(tmp_path, text.replace("neighbour", "same")), tmp_path / "alone.zarr")
    energies = [stored["energy_max"].values[:, :, 0] for stored in (up, down, alone)]
    assert (np.abs(energies[0] - energies[2])[:, 1:] > 1e-6).all()
    assert (np.abs(energies[1] - energies[2])[:, :-1] > 1e-6).all()


def test_the_store_of_another_study_or_version_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "s.zarr"
    open_sweep(path, sweep_of(tmp_path, RANDOM))
    for change, told in {
        "time.until=0.06": "with time.until = 0.05 instead of 0.06",
        "study.seed=2": "with study.seed = 1 instead of 2",
        "study.tries=3": "with study.tries = 2 instead of 3",
    }.items():
        other = sweep_of(tmp_path, RANDOM, change)
        assert told in complaint(lambda other=other: open_sweep(path, other))
    same = sweep_of(tmp_path, RANDOM)
    with monkeypatch.context() as patched:
        patched.setattr("undula.sweeps.store.software", lambda: "9.9")
        told = complaint(lambda: open_sweep(path, same))
    assert f"made by undula {un_version()} and cannot be gone on with by undula 9.9" in told
    with open_sweep(path, same).alone():
        told = complaint(lambda: open_sweep(path, same).alone().__enter__())
    assert "another undula sweep is at work" in told


def test_what_is_no_store_is_refused(tmp_path: Path) -> None:
    sweep = sweep_of(tmp_path, RANDOM)
    assert "there is no study" in complaint(lambda: load_sweep(tmp_path / "none"))
    for other in (tmp_path, tmp_path / "study.toml"):
        assert "is no stored study" in complaint(lambda other=other: open_sweep(other, sweep))
    xr.Dataset({"a": 1}).to_zarr(tmp_path / "other.zarr", zarr_format=2)
    assert "has the format None" in complaint(lambda: load_sweep(tmp_path / "other.zarr"))


def test_thousands_of_points_make_few_files(tmp_path: Path) -> None:
    axes = AXES.replace("[0.5, 2]", str(list(range(40)))).replace("count = 5", "count = 100")
    store = open_sweep(tmp_path / "s.zarr", sweep_of(tmp_path, QUICK + axes))
    assert store.sweep.count == 4000
    # One file a variable and chunk, of up to MOST_POINTS_OF_CHUNK points each.
    assert len(store.grid) <= 4000 / MOST_POINTS_OF_CHUNK * 1.5


def un_version() -> str:
    """Return the version of the package."""
    from importlib.metadata import version

    return version("undula")
