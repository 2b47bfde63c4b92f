"""Sweeps from Python, through a real worker, as the command makes them."""

from pathlib import Path
from typing import Any

import numpy as np

import undula as un
from commands import Ask
from refusal import complaint

TABLES: dict[str, Any] = {
    "model": {"segments": 4},
    "load": {"profile": "tip"},
    "time": {"until": 0.05, "samples": 50},
    "study": {"axes": [{"key": "load.force", "values": [10.0, 60.0]}]},
}
TOML = """
[model]
segments = 4
[load]
profile = "tip"
[time]
until = 0.05
samples = 50
[[study.axes]]
key = "load.force"
values = [10.0, 60.0]
"""


def test_python_and_the_command_make_one_store(tmp_path: Path, ask: Ask) -> None:
    stored = un.sweep(TABLES, tmp_path / "python.zarr", workers=1)
    assert stored.attrs["ending"] == "done"
    np.testing.assert_array_equal(stored["load.force"].values, [10.0, 60.0])
    # What is done is not done again, and the command goes on in the same store.
    file = tmp_path / "sweep.toml"
    file.write_text(TOML, encoding="utf-8")
    done = ask("sweep", file, "--out", tmp_path / "python.zarr", "--workers", "1", "--json")
    assert done.status == 0
    again = un.load(tmp_path / "python.zarr")
    for name in set(stored.data_vars) - {"seconds"}:
        np.testing.assert_array_equal(stored[name].values, again[name].values)


def test_wrong_input_is_answered_in_a_sentence(tmp_path: Path) -> None:
    store = tmp_path / "s.zarr"
    assert "varies nothing" in complaint(lambda: un.sweep({"model": {}}, store, workers=1))
    assert "at least 1" in complaint(lambda: un.sweep(TABLES, store, workers=0))
    assert "no input of a sweep" in complaint(lambda: un.sweep(3, store, workers=1))  # type: ignore[arg-type]
    wrong = TABLES | {"model": {"segmnts": 4}}
    assert "segmnts" in complaint(lambda: un.sweep(wrong, store, workers=1))
    assert not store.exists()
