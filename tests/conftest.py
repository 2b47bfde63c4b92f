"""Settings shared by all tests, and what they run commands with."""

import gc
import os
from pathlib import Path

import pytest
from hypothesis import settings

from commands import Ask, Asked, unknown_keys

# No screen is needed, and none is looked for.
os.environ.setdefault("MPLBACKEND", "Agg")

# As on the command line, see `undula.app.cli`.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# Thousands of tests are thousands of objects that stay: looking through them all takes its time.
gc.set_threshold(100_000, 20, 100)

# The first call of a kernel compiles it, which no deadline per example could allow for.
settings.register_profile("undula", deadline=None)
settings.load_profile("undula")


@pytest.fixture
def own_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Give an empty folder, which is the working one."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def ask(capsys: pytest.CaptureFixture[str]) -> Ask:
    """Give a function that runs a command in this process; it holds the keys of its answer."""
    from undula.app.cli import main
    from undula.schema.answer_keys import ANSWERS

    def run(*words: str | Path) -> Asked:
        capsys.readouterr()
        status = main([*map(str, words)])
        said = capsys.readouterr()
        if "--json" in words and words[0] in ANSWERS:
            assert unknown_keys(said.out, ANSWERS[str(words[0])]) == []
        return Asked(status, said.out, said.err)

    return run
