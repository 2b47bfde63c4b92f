"""Claims on result files: exact, whole or not at all, the same bytes for the same content."""

import os
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

import refusal
from refusal import complaint
from undula.storage import run_file as store
from undula.storage.run_file import load_checkpoint, load_result, write_run

# A run that is killed after the temporary file is written and before it is moved into place.
KILLED = """
import os, signal, sys
from pathlib import Path
os.replace = lambda *names: os.kill(os.getpid(), signal.SIGKILL)
from undula.storage.atomic import write_whole
write_whole(Path(sys.argv[1]), b"half", overwrite=True)
"""
# Another process, so that nothing but the content can make the bytes the same.
WRITTEN_ELSEWHERE = """
import sys
from pathlib import Path
sys.path[:0] = sys.argv[2:]
from test_run_file import checkpoint, run
from undula.storage.run_file import write_run
write_run(Path(sys.argv[1]), run(), checkpoint())
"""

PLACES = [str(Path(file).parent) for file in (__file__, refusal.__file__)]

arrays = st.sampled_from([np.float64, np.int64, np.bool_]).flatmap(
    lambda dtype: hnp.arrays(dtype, hnp.array_shapes(min_dims=0, max_dims=3, min_side=0))
)
names = st.from_regex(r"[a-z][a-z0-9_]{0,8}", fullmatch=True)


def run(samples: int = 30) -> xr.Dataset:
    time = np.linspace(0.0, 1.0, samples)
    nodes = np.random.default_rng(3).normal(size=(samples, 5, 3))
    return xr.Dataset(
        {"nodes": (("time", "node", "axis"), nodes), "energy": ("time", time**2)},
        coords={"time": ("time", time, {"units": "zeta L^4 / B"})},
        attrs={"seed": 1, "health": 1e-6, "input": "{}" * 50_000, "verdict": "spinning"},
    )


def checkpoint() -> dict[str, np.ndarray[Any, Any]]:
    return {
        "state": np.arange(12.0).reshape(3, 4),
        "time": np.array(1.0),
        "order": np.array(3),
        "turning": np.array(True),
        "refused": np.array([True, False]),
        "empty": np.zeros((0, 3)),
    }


@pytest.fixture
def stored(tmp_path: Path) -> Path:
    path = tmp_path / "run.nc"
    write_run(path, run(), checkpoint())
    return path


def bits(array: np.ndarray[Any, Any]) -> tuple[np.dtype[Any], tuple[int, ...], bytes]:
    return array.dtype, array.shape, array.tobytes()


def test_a_result_comes_back_as_it_was_written(stored: Path) -> None:
    expected = run().assign_attrs(undula_format="run 1")
    xr.testing.assert_identical(load_result(stored), expected)


def test_a_result_is_in_memory_and_independent_of_its_file(stored: Path) -> None:
    loaded = load_result(stored)
    stored.unlink()
    assert loaded["nodes"].sum() == run()["nodes"].sum()


def test_any_xarray_user_can_open_a_result(stored: Path) -> None:
    with xr.open_dataset(stored) as opened:
        assert dict(opened.sizes) == {"time": 30, "node": 5, "axis": 3}
    with xr.open_datatree(stored) as tree:
        assert set(tree["checkpoint"].data_vars) == {f"saved_{name}" for name in checkpoint()}


@settings(max_examples=25, deadline=None)
@given(st.dictionaries(names, arrays, max_size=4))
def test_a_checkpoint_comes_back_bit_for_bit(
    tmp_path_factory: pytest.TempPathFactory, content: dict[str, np.ndarray[Any, Any]]
) -> None:
    path = tmp_path_factory.mktemp("checkpoint") / "run.nc"
    write_run(path, run(2), content)
    loaded = load_checkpoint(path)
    assert {name: bits(array) for name, array in loaded.items()} == {
        name: bits(array) for name, array in content.items()
    }


def test_not_a_numbers_and_signed_zeros_of_a_checkpoint_keep_their_bits(tmp_path: Path) -> None:
    payload = np.array([0x7FF8000000000001, 0xFFF0000000000001], dtype=np.uint64)
    odd = np.append(payload.view(np.float64), [-0.0, np.inf, 5e-324])
    write_run(tmp_path / "run.nc", run(), {"odd": odd})
    assert bits(load_checkpoint(tmp_path / "run.nc")["odd"]) == bits(odd)


def test_a_checkpoint_array_of_another_type_is_a_programming_error(tmp_path: Path) -> None:
    with pytest.raises(TypeError, match="checkpoint array x has type float32"):
        write_run(tmp_path / "run.nc", run(), {"x": np.zeros(3, dtype=np.float32)})
    assert list(tmp_path.iterdir()) == []


def test_names_of_checkpoint_arrays_cannot_get_in_each_others_way(tmp_path: Path) -> None:
    content = {"x": np.eye(2), "x_axis0": np.arange(2), "axis0": np.ones(3), "node": np.array(1)}
    write_run(tmp_path / "run.nc", run(), content)
    loaded = load_checkpoint(tmp_path / "run.nc")
    assert all(bits(loaded[name]) == bits(content[name]) for name in content)


@pytest.mark.slow
def test_the_same_content_gives_the_same_bytes_in_another_process(
    stored: Path, tmp_path: Path
) -> None:
    other = tmp_path / "other.nc"
    command = [sys.executable, "-c", WRITTEN_ELSEWHERE, str(other), *PLACES]
    subprocess.run(command, check=True, env={**os.environ, "PYTHONHASHSEED": "7"})
    assert other.read_bytes() == stored.read_bytes()


def test_no_time_of_writing_is_kept_in_a_file(stored: Path) -> None:
    with h5py.File(stored) as file:
        places = [file.id, *(file[name].id for name in ("nodes", "energy", "checkpoint"))]
        assert [h5py.h5g.get_objinfo(place).mtime for place in places] == [0] * len(places)


def test_a_result_that_was_read_writes_the_same_bytes_again(stored: Path, tmp_path: Path) -> None:
    again = tmp_path / "again.nc"
    write_run(again, load_result(stored), load_checkpoint(stored))
    assert again.read_bytes() == stored.read_bytes()


def test_writing_leaves_the_given_dataset_as_it_was(tmp_path: Path) -> None:
    given_dataset = run()
    write_run(tmp_path / "run.nc", given_dataset, checkpoint())
    xr.testing.assert_identical(given_dataset, run())


def test_missing_folders_are_made(tmp_path: Path) -> None:
    path = tmp_path / "a" / "b" / "run.nc"
    write_run(path, run(), checkpoint())
    assert load_result(path).attrs["verdict"] == "spinning"


@pytest.mark.parametrize("kept", [1.0, 0.999, 0.9, 0.7, 0.5, 0.3, 0.1, 0.03, 0.01])
def test_a_truncated_file_is_refused_with_one_sentence(stored: Path, kept: float) -> None:
    content = stored.read_bytes()
    stored.write_bytes(content[: min(int(kept * len(content)), len(content) - 1)])
    sentence = f"{stored} is cut short or damaged; make it again with undula run"
    assert complaint(lambda: load_result(stored)) == sentence
    assert complaint(lambda: load_checkpoint(stored)) == sentence


def test_a_file_truncated_anywhere_in_its_head_is_refused(stored: Path) -> None:
    content = stored.read_bytes()
    sentence = f"{stored} is cut short or damaged; make it again with undula run"
    for kept in [*range(1, 120), 500, 800, 1000, 2047, 2048, 4096]:
        stored.write_bytes(content[:kept])
        assert complaint(lambda: load_result(stored)) == sentence


@pytest.mark.parametrize("content", [b"", b"x,y\n1,2\n", b"CDF\x01" + bytes(100), b"PK\x03\x04"])
@pytest.mark.parametrize("load", [load_result, load_checkpoint])
def test_a_file_of_another_kind_is_refused(
    tmp_path: Path, content: bytes, load: Callable[[Path], object]
) -> None:
    path = tmp_path / "run.nc"
    path.write_bytes(content)
    sentence = f"{path} is not a NetCDF4 file; give a result file written by undula run"
    assert complaint(lambda: load(path)) == sentence


@pytest.mark.parametrize("load", [load_result, load_checkpoint])
def test_a_netcdf_file_from_elsewhere_is_refused(
    tmp_path: Path, load: Callable[[Path], object]
) -> None:
    path = tmp_path / "foreign.nc"
    run().to_netcdf(path, engine="h5netcdf")
    sentence = f"{path} was not written by undula; give a result file written by undula run"
    assert complaint(lambda: load(path)) == sentence


def test_a_bare_hdf5_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "bare.nc"
    with h5py.File(path, "w") as file:
        file["numbers"] = np.arange(3)
    assert str(path) in complaint(lambda: load_result(path))


def test_a_result_of_another_format_is_refused_by_its_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "later.nc"
    with monkeypatch.context() as later:
        later.setattr(store, "RUN", store.Kind("run 9", "undula run"))
        write_run(path, run(), checkpoint())
    assert "has the format 'run 9', but" in complaint(lambda: load_result(path))


@pytest.mark.parametrize("load", [load_result, load_checkpoint])
def test_a_missing_file_is_named(tmp_path: Path, load: Callable[[Path], object]) -> None:
    path = tmp_path / "none.nc"
    assert complaint(lambda: load(path)) == f"there is no result file {path}; check the name"


def test_a_folder_in_place_of_a_result_is_named(tmp_path: Path) -> None:
    sentence = complaint(lambda: load_result(tmp_path))
    assert sentence.startswith(f"cannot read the result file {tmp_path} (")


def test_an_existing_result_is_replaced_only_when_asked(stored: Path) -> None:
    before = stored.read_bytes()
    sentence = f"{stored} exists already; give --overwrite to replace it"
    assert complaint(lambda: write_run(stored, run(9), {})) == sentence
    assert stored.read_bytes() == before


def test_overwriting_replaces_the_whole_file(stored: Path) -> None:
    write_run(stored, run(7), {}, overwrite=True)
    assert load_result(stored).sizes["time"] == 7
    assert load_checkpoint(stored) == {}


def test_a_kill_before_the_move_leaves_the_earlier_file_valid(stored: Path) -> None:
    before = stored.read_bytes()
    killed = subprocess.run([sys.executable, "-c", KILLED, str(stored)], check=False)
    assert killed.returncode == -signal.SIGKILL
    # The kill did come after the temporary file: it is still there.
    assert len(list(stored.parent.glob(".run.nc.*.part"))) == 1
    assert stored.read_bytes() == before
    xr.testing.assert_identical(load_result(stored), run().assign_attrs(undula_format="run 1"))
