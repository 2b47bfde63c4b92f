"""Nothing of ours overflows, underflows or divides by zero unawares, and singular is told."""

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from undula.app.cli import main
from undula.app.commands import find as finding
from undula.numerics.linalg.bordered import BandFactors

FEW = ["--set", "model.segments=8"]
BENT = ["--set", "model.segments=4", "--set", "model.bending_ratio=2"]
SHORT = ["--set", "time.until=0.05", "--set", "time.samples=60", "--no-movie", "--overwrite"]
COMMANDS = {
    "a beat": ["run", *FEW, *SHORT],
    "a decay": ["run", *FEW, "--set", "load.force=20", *SHORT, "--set", "time.until=2"],
    "no load": ["run", *FEW, "--set", "load.force=0", *SHORT],
    "a kick that is hardly one": ["run", *FEW, *SHORT, "--set", "start.amplitude=1e-9"],
    "a curved body": ["run", *FEW, *SHORT, "--set", "model.natural_curvature=[1, 2]"],
    "a plane": ["run", *FEW, *SHORT, "--set", "model.confined=true"],
    "a chain of one link": ["run", *SHORT, "--set", "model.kind=chain", "--set", "model.links=1"],
    "spinning": ["find", "spinning", *FEW],
    "onsets": ["stability", *FEW],
    "a steep load": [
        "stability",
        *FEW,
        "--set",
        "load.profile=power",
        "--set",
        "load.exponent=300",
    ],
    "a flat load": ["stability", *FEW, "--set", "load.profile=power", "--set", "load.exponent=0"],
    "the least place": ["stability", "--set", "load.profile=point", "--set", "load.position=1e-9"],
    "discrete": ["stability", *FEW, "--set", "stability.method=discrete"],
    "growth": ["stability", *FEW, "--forces", "0:60:4"],
    "a branch": ["follow", "spinning", *FEW, "--along", "load.force=onset:60"],
    "at rest": ["follow", "equilibrium", *FEW, "--along", "model.natural_curvature.k1=-1:1"],
    "a threshold": ["threshold", "spinning-lost", *FEW],
}
#: Those that compile and integrate for longer.
LONG = {
    "flapping": ["find", "flapping", *FEW, "--set", "load.force=120"],
    "a branch of beats": ["follow", "flapping", *FEW, "--along", "load.force=120:130"],
    "periodic": ["find", "periodic", *FEW, "--set", "load.force=200"],
    "to the end": ["run", *FEW, *SHORT, "--set", "time.until='settled'"],
    "exponents": ["run", *FEW, *SHORT, "--lyapunov"],
    "steps": ["step", *FEW, "--along", "load.force=30:50:3", *SHORT[:4]],
}


def quietly(command: list[str], folder: Path, monkeypatch: pytest.MonkeyPatch) -> int:
    """Carry out a command with every floating-point warning an error; return its status."""
    monkeypatch.chdir(folder)
    with np.errstate(all="raise"):
        return main(command)


@pytest.mark.parametrize("name", COMMANDS)
def test_a_command_raises_no_floating_point_warning(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert quietly(COMMANDS[name], tmp_path, monkeypatch) == 0


@pytest.mark.slow
@pytest.mark.parametrize("name", LONG)
def test_a_long_command_raises_no_floating_point_warning(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert quietly(LONG[name], tmp_path, monkeypatch) == 0


@pytest.mark.parametrize(
    "singular",
    [
        lambda: np.linalg.solve(np.zeros((2, 2)), np.ones(2)),
        lambda: BandFactors(np.zeros((3, 3))),
    ],
)
def test_singular_equations_are_told_in_one_sentence(
    singular: Any, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(finding, "kind_by_name", lambda _: singular())
    assert main(["find", "spinning", *FEW]) == 2
    told = capfd.readouterr()
    assert told.out == ""
    assert told.err.count("\n") == 1
    assert "no unique solution" in told.err


def answer(command: list[str], folder: Path, **environment: str) -> dict[str, Any]:
    """Return what a process of its own answers."""
    run = "from undula.app.cli import main; raise SystemExit(main())"
    done = subprocess.run(
        [sys.executable, "-c", run, *command, "--json"],
        cwd=folder,
        env=os.environ | environment,
        capture_output=True,
        text=True,
        check=True,
    )
    told: dict[str, Any] = json.loads(done.stdout)
    return told


@pytest.mark.slow
@pytest.mark.parametrize(
    "command",
    [
        ["find", "spinning", "--set", "model.segments=4"],
        ["stability", "--set", "model.segments=4", "--set", "stability.method=discrete"],
        ["run", "--set", "model.segments=4", *SHORT, "--set", "time.until=0.002"],
        ["run", *BENT, *SHORT, "--set", "time.until=0.001"],
    ],
    ids=lambda command: " ".join([command[0], *command[-1:]]),
)
def test_without_a_compiler_the_answers_are_the_same(command: list[str], tmp_path: Path) -> None:
    compiled, slow = (
        answer(command, tmp_path, NUMBA_DISABLE_JIT=without) for without in ("0", "1")
    )

    def numbers(told: Any) -> list[float]:
        if isinstance(told, dict):
            return [x for key, one in told.items() if "error" not in key for x in numbers(one)]
        if isinstance(told, list):
            return [x for one in told for x in numbers(one)]
        return [told] if isinstance(told, float) else []

    same = ("residual", "trivial_rate", "seconds", "health", "wall_time")
    one, other = (
        numbers({key: value for key, value in told.items() if key not in same})
        for told in (compiled, slow)
    )
    # Sums in another order differ by round-off, which steps and Newton's method amplify somewhat.
    assert other == pytest.approx(one, rel=1e-6, abs=1e-9)
