"""Damage is told or mended, never believed: of every kind of file, in every way."""

import json
import os
import shutil
import subprocess
import sys
import sysconfig
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import xarray as xr
import zarr

import damage
import undula as un
from damage import AGAIN, KINDS, SAME, TOLD, command, job, keep_answer, make_run, make_sweep, sweep
from refusal import complaint
from small_sweeps import work_off
from undula.app.cli import main
from undula.reproduction.tasks.task import ReproductionTask
from undula.storage import trial_reading
from undula.storage.seal import Condition, condition
from undula.storage.unchecked import StoredWarning
from undula.sweeps.store import load_sweep, open_sweep
from undula.sweeps.work_queue import SweepWork

UNDULA = Path(sysconfig.get_path("scripts")) / "undula"
#: Seconds for a process that damages and reads: it hangs if it takes longer on any machine.
PATIENCE = 1800.0


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Give a folder with a run and a study, to be copied."""
    folder = tmp_path_factory.mktemp("made")
    make_run(folder)
    make_sweep(folder)
    return folder


@pytest.fixture
def run(made: Path, tmp_path: Path) -> Path:
    path = tmp_path / "run.nc"
    path.write_bytes((made / "run.nc").read_bytes())
    return path


@pytest.fixture
def store(made: Path, tmp_path: Path) -> Path:
    shutil.copytree(made / "s.zarr", tmp_path / "s.zarr")
    return tmp_path / "s.zarr"


def damaged_at_random(kind: str, count: int, seed: int) -> dict[str, int]:
    """Return how readings ended, of a process of its own that a hang cannot outlive."""
    words = [
        sys.executable,
        damage.__file__,
        kind,
        str(count),
        str(seed),
    ]
    done = subprocess.run(
        words,
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        check=False,
        env={**os.environ, "MPLBACKEND": "Agg", "OPENBLAS_NUM_THREADS": "1"},
    )
    assert done.returncode == 0, done.stderr
    found: dict[str, int] = json.loads(done.stdout)
    assert found.keys() <= {SAME, TOLD, AGAIN}, done.stderr
    return found


# ---------------------------------------------------------------- at random


@pytest.mark.parametrize("kind", ["run", "answer", pytest.param("store", marks=pytest.mark.slow)])
def test_random_damage_is_never_believed(kind: str) -> None:
    assert sum(damaged_at_random(kind, 25, 1).values()) == 25


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_no_random_damage_of_hundreds_is_believed(kind: str) -> None:
    assert sum(damaged_at_random(kind, 300, 2).values()) == 300


# ---------------------------------------------------------------- files


def test_every_single_bit_of_a_small_file_matters(run: Path) -> None:
    image = run.read_bytes()
    chance = np.random.default_rng(4)
    for at in chance.integers(0, len(image), 2000):
        broken = bytearray(image)
        broken[at] ^= 1 << int(chance.integers(8))
        with pytest.MonkeyPatch.context() as patched:
            # Without a line that holds good no library may see a byte, whatever else is looked at.
            patched.setattr("undula.storage.seal.is_readable", lambda _: False)
            assert condition(bytes(broken)) is Condition.DAMAGED


@pytest.mark.parametrize("engine", [None, "h5netcdf"])
def test_other_software_opens_a_file_with_a_checksum_as_before(run: Path, engine: Any) -> None:
    with xr.open_dataset(run, engine=engine) as opened, h5py.File(run) as file:
        assert np.array_equal(opened["nodes"].values, file["nodes"][...])
        assert opened.attrs["verdict"] == file.attrs["verdict"]


def as_python_stores_it(run: Path) -> Path:
    filament = un.Filament(6, un.TipLoad(75.0))
    of = un.integrate(filament, un.kicked(filament), until=0.02, samples=20)
    un.dataset_of(of).to_netcdf(run)
    return run


def annotated(run: Path) -> Path:
    un.load(run).assign_attrs(note="mine").to_netcdf(run.with_name("noted.nc"))
    return run.with_name("noted.nc")


def annotated_in_place(run: Path) -> Path:
    with h5py.File(run, "a") as file:
        file.attrs["note"] = "mine"
    return run


@pytest.mark.parametrize("store_it", [as_python_stores_it, annotated, annotated_in_place])
def test_what_other_software_stored_is_read_drawn_and_said_to_be_unchecked(
    store_it: Callable[[Path], Path], run: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = store_it(run)
    with pytest.warns(StoredWarning, match=f"{path} carries no checksum"):
        stored = un.load(path)
    assert main(["plot", str(path)]) == 0
    said = capsys.readouterr().err
    assert said.count("carries no checksum") == said.count("\n") == 1
    # And again, as often as anyone likes.
    stored.to_netcdf(path.with_name("again.nc"))
    with pytest.warns(StoredWarning):
        xr.testing.assert_identical(un.load(path.with_name("again.nc")), stored)


@pytest.mark.filterwarnings("ignore:.*carries no checksum")
def test_an_annotated_run_goes_on_if_its_checkpoint_is_whole(run: Path, made: Path) -> None:
    def reached(path: Path) -> dict[str, Any]:
        answer = command("resume", path, "--until", "0.03", "--no-movie")
        return {key: answer[key] for key in ("bending_energy", "tip_radius", "winding_angle")}

    with h5py.File(run, "a") as file:
        del file.attrs["verdict"]
        file.attrs["note"] = "mine"
    other = made / "other.nc"
    other.write_bytes((made / "run.nc").read_bytes())
    assert reached(run) == reached(other)


@pytest.mark.filterwarnings("ignore:.*carries no checksum")
@pytest.mark.parametrize("what", ["input", "versions", "summary", "states", "nothing left"])
def test_a_checkpoint_that_is_not_whole_is_refused_in_one_sentence(
    what: str, run: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with h5py.File(run, "a") as file:
        if what == "nothing left":
            del file["checkpoint"]
        elif what == "states":
            saved = file["checkpoint"]["saved_states"]
            saved[...] = np.nextafter(saved[...], 9.0)
        else:
            file.attrs[what] = str(file.attrs[what]).replace("0.02", "0.03").replace("0.1", "0.2")
    told = complaint(lambda: command("resume", run, "--until", "0.03"))
    assert main(["resume", str(run), "--until", "0.03"]) == 2
    assert capsys.readouterr().err == f"undula: {told}\n"
    assert ("holds no checkpoint" if what == "nothing left" else "not as undula run wrote") in told


def test_a_file_without_checksum_that_makes_hdf5_hang_is_ended(
    run: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    annotated_in_place(run)
    # A stand-in for the loops in HDF5: any reading that goes on for longer than it may.
    monkeypatch.setattr(trial_reading, "_SECONDS", 1)
    slow = run.with_name("slow")
    slow.mkdir()
    (slow / "h5py.py").write_text("while True: pass\n", encoding="utf-8")
    monkeypatch.syspath_prepend(str(slow))
    assert not trial_reading._succeeds(run.read_bytes())


@pytest.mark.filterwarnings("ignore:.*carries no checksum")
def test_a_file_without_checksum_that_was_cut_or_grew_is_refused(run: Path) -> None:
    image = annotated_in_place(run).read_bytes()
    for broken in (image[:-1], image + b"\0", image[: len(image) // 2]):
        run.write_bytes(broken)
        assert "is cut short or damaged" in complaint(lambda: un.load(run))


# ---------------------------------------------------------------- studies


def shorten(file: Path) -> None:
    file.write_bytes(file.read_bytes()[:-1])


def empty(file: Path) -> None:
    file.write_bytes(b"")


def flip(file: Path) -> None:
    image = bytearray(file.read_bytes())
    image[len(image) // 2] ^= 4
    file.write_bytes(bytes(image))


@pytest.mark.parametrize("spoil", [shorten, empty, flip, Path.unlink])
@pytest.mark.parametrize("name", ["verdict", "lyapunov", "shapes", "status"])
def test_points_of_a_damaged_or_missing_chunk_are_not_done_and_done_again(
    name: str, spoil: Callable[[Path], None], store: Path, made: Path
) -> None:
    whole = load_sweep(made / "s.zarr").load()
    chunk = next((store / name).glob("[0-9]*"))
    spoil(chunk)
    if name == "status" and spoil is Path.unlink:
        found = load_sweep(store).load()  # as if it had not been written yet
    else:
        with pytest.warns(StoredWarning, match="3 of its points count as not done; undula sweep"):
            found = load_sweep(store).load()
    assert (found["status"] == 0).all()
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("undula.sweeps.work_queue.warn_damaged", lambda *_: None)
        again = open_sweep(store, sweep(made, "period"))
        work_off(SweepWork(again), again.sweep)
    xr.testing.assert_identical(
        load_sweep(store).load().drop_vars("seconds"), whole.drop_vars("seconds")
    )


@pytest.mark.parametrize("name", ["load.force", "seed", "try"])
def test_axes_and_seeds_that_are_damaged_are_those_of_the_study(
    name: str, store: Path, made: Path
) -> None:
    flip(next((store / name).glob("[0-9]*")))
    xr.testing.assert_identical(load_sweep(store).load(), load_sweep(made / "s.zarr").load())


@pytest.mark.parametrize("files", [".zmetadata", "*/.zarray", ".zattrs", ".zgroup", "*/.zattrs"])
def test_either_copy_of_what_a_store_says_of_itself_will_do_and_the_other_is_mended(
    files: str, store: Path, made: Path
) -> None:
    whole = load_sweep(made / "s.zarr").load()
    for file in store.glob(files):
        flip(file)
    xr.testing.assert_identical(load_sweep(store).load(), whole)
    SweepWork(open_sweep(store, sweep(made, "period")))
    xr.testing.assert_identical(xr.open_zarr(store).load(), xr.open_zarr(made / "s.zarr").load())


def test_a_store_whose_metadata_are_all_damaged_is_refused(store: Path) -> None:
    for file in (store / ".zmetadata", store / ".zattrs"):
        file.write_text(file.read_text(encoding="utf-8").replace("60.0", "61.0"), encoding="utf-8")
    assert "what it says of itself is damaged" in complaint(lambda: load_sweep(store)).replace(
        f"what {store} says", "what it says"
    )


def strange(store: Path, **changed: Any) -> str:
    """Return the sentence with which a store is refused of which an array says something else."""
    for file in (store / ".zmetadata", store / "verdict" / ".zarray"):
        told = json.loads(file.read_text(encoding="utf-8"))
        array = told["metadata"]["verdict/.zarray"] if "metadata" in told else told
        array |= changed
        file.write_text(json.dumps(told), encoding="utf-8")
    for file in (store / ".zmetadata", store / ".zattrs"):  # as if it had never been sealed
        told = json.loads(file.read_text(encoding="utf-8"))
        attributes = told["metadata"][".zattrs"] if "metadata" in told else told
        del attributes["undula_digest"]
        file.write_text(json.dumps(told), encoding="utf-8")
    return complaint(lambda: load_sweep(store))


@pytest.mark.parametrize(
    "changed",
    [
        {"filters": [{"id": "pickle"}]},
        {"compressor": {"id": "pickle"}},
        {"filters": [{"id": "json2"}], "dtype": "|O"},
        {"dtype": "|V8"},
        {"dtype": [["a", "<f8"]]},
    ],
)
def test_codecs_and_types_that_are_not_ours_are_refused_before_zarr_sees_them(
    changed: dict[str, Any], store: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(zarr, "open_group", lambda *_, **__: pytest.fail("Zarr has seen them"))
    told = strange(store, **changed)
    assert "which undula does not write and does not run" in told


@pytest.mark.filterwarnings("ignore:.*carries no checksum", "ignore::FutureWarning")
@pytest.mark.filterwarnings("ignore:.*does not have a Zarr V3", "ignore:Consolidated metadata")
@pytest.mark.parametrize("again", ["third.zarr", "second.zarr", "study.nc"])
def test_a_study_that_python_stored_again_is_read_and_drawn_but_not_gone_on_with(
    again: str, store: Path, made: Path
) -> None:
    whole, path = load_sweep(store), store.with_name(again)
    if again == "study.nc":
        whole.to_netcdf(path)
    else:
        whole.to_zarr(path, **({"zarr_format": 2} if again == "second.zarr" else {}))
    xr.testing.assert_equal(load_sweep(path), whole.load())
    assert main(["status", str(path)]) == 0
    if path.is_dir():
        assert main(["plot", str(path)]) == 0
        told = complaint(lambda: open_sweep(path, sweep(made, "period")))
        assert "can be drawn but not gone on with" in told


@pytest.mark.filterwarnings("ignore:.*carries no checksum", "ignore:Consolidated metadata")
@pytest.mark.filterwarnings("ignore:.*does not have a Zarr V3")
def test_a_run_that_python_stored_again_as_zarr_is_read(run: Path) -> None:
    whole = un.load(run)
    whole.to_zarr(run.with_name("run.zarr"))
    xr.testing.assert_equal(un.load(run.with_name("run.zarr")), whole)


def test_a_store_of_ours_in_the_third_format_with_a_strange_codec_is_refused(
    tmp_path: Path,
) -> None:
    path = tmp_path / "third.zarr"
    xr.Dataset({"a": ("x", [1.0])}).to_zarr(path, zarr_format=3, consolidated=False)
    file = path / "a" / "zarr.json"
    told = json.loads(file.read_text(encoding="utf-8"))
    told["codecs"].append({"name": "numcodecs.pickle"})
    file.write_text(json.dumps(told), encoding="utf-8")
    assert "asks for the codec 'numcodecs.pickle'" in complaint(lambda: load_sweep(path))


@pytest.mark.slow
def test_a_sweep_in_processes_of_its_own_does_damaged_points_again(store: Path, made: Path) -> None:
    whole = load_sweep(made / "s.zarr").load()
    flip(next((store / "verdict").glob("[0-9]*")))
    words = [UNDULA, "sweep", made / "study.toml", "--workers", "1", "--out", store, "--json"]
    told = subprocess.run(words, capture_output=True, text=True, timeout=300, check=False)
    assert told.returncode == 0, told.stderr
    assert told.stderr.count("3 of its points count as not done") == 1
    assert "Traceback" not in told.stderr
    xr.testing.assert_identical(
        load_sweep(store).load().drop_vars("seconds"), whole.drop_vars("seconds")
    )


# ---------------------------------------------------------------- what a report keeps


def kept_job(folder: Path) -> ReproductionTask:
    keep_answer(folder)
    return job(folder)


@pytest.mark.parametrize("name", ["answer.json", "run.nc", "steps.nc"])
def test_a_task_of_which_a_file_is_damaged_is_done_again(
    name: str, run: Path, tmp_path: Path
) -> None:
    task = kept_job(tmp_path / "task")
    if name != "answer.json":
        (task.folder / name).write_bytes(run.read_bytes())
    assert task.is_done()
    flip(task.folder / name)
    assert not task.is_done()
    task.prepare()
    # A series would go on with damaged steps; an answer is replaced.
    assert not (task.folder / name).exists() or name == "answer.json"


def test_a_task_of_which_the_study_is_damaged_is_done_again(store: Path, tmp_path: Path) -> None:
    task = kept_job(tmp_path / "task")
    shutil.copytree(store, task.folder / "study.zarr")
    assert task.is_done()
    flip(next((task.folder / "study.zarr" / "verdict").glob("[0-9]*")))
    with pytest.warns(StoredWarning, match="3 of its points count as not done"):
        assert not task.is_done()
