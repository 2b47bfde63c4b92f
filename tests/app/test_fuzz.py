"""No call of the command line, however odd, ends in a traceback, a hang or a silent failure."""

import contextlib
import json
import signal
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from fuzzing import Files, calls, unknown_parameters
from undula.app.cli import main
from undula.terminal.output import BAD_INPUT, DONE, STOPPED_EARLY

#: No call of a body of six links takes so long [s], compilation of all kernels included.
PATIENCE = 120
#: Options that take numbers: every other one is drawn by its name.
NUMERIC = {
    *("until", "budget", "kick", "seed", "workers", "up_to", "length", "stiffness", "viscosity"),
    *("slenderness", "force", "time", "frequency", "energy"),
    *("force_pn", "time_s", "frequency_hz", "energy_pn_um"),
}
STUDY = """
[model]
segments = 6
[time]
until = 0.01
samples = 11
[[study.axes]]
key = "load.force"
values = [50.0, 60.0]
"""


class HungError(BaseException):
    """A call took longer than any should; no handler of errors may catch it."""


@contextlib.contextmanager
def no_longer_than(seconds: int) -> Iterator[None]:
    """End what takes too long."""

    def end(*_: object) -> None:
        raise HungError

    before = signal.signal(signal.SIGALRM, end)
    signal.alarm(seconds)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Files:
    """Give results of every kind to be read, and a folder to write into."""
    folder = tmp_path_factory.mktemp("fuzz")
    (folder / "study.toml").write_text(STUDY)
    small = ["--set", "model.segments=6", "--set", "time.until=0.01", "--set", "time.samples=11"]
    with contextlib.chdir(folder):
        assert main(["run", *small, "--no-movie", "--out", "."]) == DONE
        assert main(["step", *small, "--along", "load.force=50:52:3", "--out", "."]) == DONE
        assert main(["sweep", "study.toml", "--workers", "1", "--out", "store.zarr"]) == DONE
    return Files(folder)


def check(words: list[str], capfd: Any) -> None:
    """Make one call, and hold its answer against the promises of every command."""
    capfd.readouterr()
    with no_longer_than(PATIENCE):
        status = main(words)
    told = capfd.readouterr()
    assert status in (DONE, BAD_INPUT, STOPPED_EARLY), told.err
    assert "Traceback" not in told.err
    if status == BAD_INPUT:
        sentence = told.err.splitlines()[-1]
        assert sentence.startswith("undula: "), told.err
    if "--json" in words and told.out:
        json.loads(told.out, parse_constant=lambda name: pytest.fail(f"{name} is no JSON"))


def tried(count: int, files: Files, folder: Path, capfd: Any) -> None:
    """Make so many calls, always the same ones."""

    @settings(
        max_examples=count,
        derandomize=True,
        database=None,
        suppress_health_check=list(HealthCheck),
    )
    @given(st.data())
    def each(data: st.DataObject) -> None:
        check(data.draw(calls(files), label="call"), capfd)

    with contextlib.chdir(folder):
        each()


def test_every_option_is_given_values_of_its_kind(files: Files) -> None:
    assert unknown_parameters(files) <= NUMERIC


def test_no_call_ends_in_a_traceback_or_a_hang(files: Files, tmp_path: Path, capfd: Any) -> None:
    tried(40, files, tmp_path, capfd)


@pytest.mark.slow
def test_none_of_thousands_of_calls_does(files: Files, tmp_path: Path, capfd: Any) -> None:
    tried(5000, files, tmp_path, capfd)
