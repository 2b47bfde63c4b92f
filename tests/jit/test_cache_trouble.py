"""A cache that is damaged, full, shared or nowhere costs time and never the answer."""

import errno
import os
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path

import numba
import pytest
from numba.core import event

from undula.jit import cache, compilation
from undula.terminal import compile_notice as compiling

OUTER = """
from toy.jit.compilation import entry, kernel


@entry("x (n)")
def outer(x):
    return x[0] + 1.0


@kernel
def deep(x):
    return x[x.shape[0] + 5] * 0.0


@entry("x (n)")
def beyond(x):
    return deep(x)
"""
SHOW = """
import numpy as np
from toy.jit.cache import why_not_kept
from toy.outer import outer
print(outer(np.ones(3)), sum(outer.stats.cache_hits.values()), why_not_kept())
"""
#: What a process prints that computes, and finds the function on disk or not.
FOUND, MADE = "2.0 1 None", "2.0 0 None"
ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def toy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return the folder of a package that compiles as ours does, with a cache beside it."""
    package = tmp_path / "toy"
    shutil.copytree(
        Path(compilation.__file__).parent,
        package / "jit",
        ignore=shutil.ignore_patterns("__pycache__"),
    )
    for source in (package / "jit").glob("*.py"):
        source.write_text(source.read_text().replace("undula", "toy"))
    (package / "__init__.py").write_text("")
    (package / "outer.py").write_text(OUTER)
    monkeypatch.setenv("PYTHONDONTWRITEBYTECODE", "1")
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "cache"))
    return tmp_path


def command(what: str = SHOW) -> list[str]:
    return [sys.executable, "-c", what]


def shown(folder: Path, what: str = SHOW) -> str:
    """Run the toy in a process of its own; return what it prints. Anything told is a failure."""
    done = subprocess.run(
        command(what), cwd=folder, capture_output=True, text=True, timeout=120, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout.strip()


def cut(content: bytes) -> bytes:
    return content[:100]


def emptied(content: bytes) -> bytes:  # noqa: ARG001
    return b""


def flipped(content: bytes) -> bytes:
    """Return the content with one bit of its machine code turned over."""
    middle = len(content) // 2
    return content[:middle] + bytes([content[middle] ^ 1]) + content[middle + 1 :]


def of_zeros(content: bytes) -> bytes:
    return bytes(len(content))


def plus_one(x: float) -> float:
    return x + 1.0


def plus_two(x: float) -> float:
    return x + 2.0


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Let functions be kept in a folder of their own, and no trouble be known."""
    monkeypatch.setattr(cache, "_folder", lambda _: str(tmp_path))
    monkeypatch.setattr(cache, "_reasons", [])
    return tmp_path


def called(function: Callable[[float], float]) -> tuple[float, bool]:
    """Return what a function gives for 1, and whether it was found on disk, as in a new process."""
    compiled_once = numba.njit(function)
    compiled_once._cache = cache.KernelCache(function)
    return compiled_once(1.0), bool(compiled_once.stats.cache_hits)


@pytest.mark.parametrize("damage", [cut, emptied, flipped, of_zeros])
def test_a_damaged_file_is_compiled_anew_and_is_whole_again(
    folder: Path, damage: Callable[[bytes], bytes]
) -> None:
    assert called(plus_one) == (2.0, False)
    (path,) = folder.iterdir()
    path.write_bytes(damage(path.read_bytes()))
    assert called(plus_one) == (2.0, False)
    assert called(plus_one) == (2.0, True)
    assert cache.why_not_kept() is None


def test_a_file_of_another_function_is_not_taken_for_this_one(folder: Path) -> None:
    called(plus_one)
    (path,) = folder.iterdir()
    assert called(plus_two) == (3.0, False)
    (other,) = (one for one in folder.iterdir() if one != path)
    path.write_bytes(other.read_bytes())
    assert called(plus_one) == (2.0, False)


def test_a_full_disk_costs_the_file_and_not_the_answer(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "replace", full)
    assert called(plus_one) == (2.0, False)
    assert list(folder.iterdir()) == []
    told = cache.why_not_kept()
    assert told is not None
    assert "No space left on device" in told
    assert "NUMBA_CACHE_DIR" in told


def test_a_folder_that_goes_away_costs_no_answer(folder: Path) -> None:
    called(plus_one)
    shutil.rmtree(folder)
    assert called(plus_one) == (2.0, False)
    assert called(plus_one) == (2.0, False)


def test_with_nowhere_to_write_functions_are_compiled_in_each_process(
    toy: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # A file in the place of each folder: nobody can write there, root neither.
    (toy / "file").write_text("")
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(toy / "file"))
    monkeypatch.setenv("XDG_CACHE_HOME", str(toy / "file"))
    for sources in (toy / "toy", toy / "toy" / "jit"):
        (sources / "__pycache__").write_text("")
    told = shown(toy)
    assert told.startswith("2.0 0 compiled kernels cannot be kept")
    assert "NUMBA_CACHE_DIR" in told


def test_a_folder_that_cannot_be_made_is_passed_over(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "file"))
    beside = tmp_path / "sources"
    assert cache._folder(str(beside)) == str(beside / "__pycache__")


@pytest.mark.slow
def test_processes_that_begin_together_share_a_cache(toy: Path) -> None:
    several = [
        subprocess.Popen(command(), cwd=toy, stdout=subprocess.PIPE, text=True) for _ in range(3)
    ]
    answers = [one.communicate(timeout=120)[0].strip() for one in several]
    assert set(answers) <= {MADE, FOUND}
    assert shown(toy) == FOUND
    assert not list((toy / "cache").rglob("*.tmp"))


def test_a_package_in_an_archive_is_kept_too_and_its_changes_are_noticed(
    toy: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def pack(told: str) -> None:
        with zipfile.ZipFile(toy / "toy.zip", "w") as archive:
            for source in (toy / "hidden").rglob("*.py"):
                text = source.read_text().replace("1.0", told)
                archive.writestr(str(Path("toy") / source.relative_to(toy / "hidden")), text)

    (toy / "toy").rename(toy / "hidden")
    monkeypatch.setenv("PYTHONPATH", str(toy / "toy.zip"))
    pack("1.0")
    assert shown(toy) == MADE
    pack("4.0")
    assert shown(toy) == "5.0 0 None"


@pytest.mark.slow
def test_checks_of_bounds_reach_kernels_and_are_kept_apart(
    toy: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    deep = "import numpy as np\nfrom toy.outer import beyond\nbeyond(np.ones(3))\nprint('silent')"
    assert shown(toy, deep) == "silent"
    monkeypatch.setenv("NUMBA_BOUNDSCHECK", "1")
    done = subprocess.run(command(deep), cwd=toy, capture_output=True, text=True, check=False)
    assert "IndexError" in done.stderr


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        (
            None,
            None,
            ["compiling the kernels, once per installation; this takes about half a minute"],
        ),
        ("cannot be kept", "cannot be kept", ["cannot be kept"]),
    ],
)
def test_the_command_line_says_one_sentence(
    before: str | None, after: str | None, said: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    troubles, heard = iter([before, after]), list[str]()
    monkeypatch.setattr(compiling, "why_not_kept", lambda: next(troubles))
    with compiling.compilation_announced(heard.append), event.trigger_event("numba:compile"):
        pass
    assert heard == said


@pytest.mark.slow
def test_a_command_answers_without_a_cache_and_with_a_broken_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    main = "from undula.app.cli import main; raise SystemExit(main())"
    ask = [sys.executable, "-c", main, "find", "spinning", "--set", "model.segments=8"]
    kept_in = tmp_path / "cache"
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(kept_in))

    def answer(*where: str) -> tuple[str, str]:
        done = subprocess.run([*ask, *where], capture_output=True, text=True, check=True)
        return done.stdout, done.stderr

    first = answer()
    assert first[1].count("\n") == 1
    assert "compiling the kernels, once" in first[1]
    assert answer() == (first[0], "")
    for size in (0, 100):
        for path in kept_in.rglob("*.nbc"):
            os.truncate(path, size)
        assert answer() == first
    shutil.copytree(ROOT / "src", tmp_path / "src", ignore=shutil.ignore_patterns("__pycache__"))
    for folder in [one for one in (tmp_path / "src").rglob("*") if one.is_dir()]:
        (folder / "__pycache__").write_text("")
    monkeypatch.delenv("NUMBA_CACHE_DIR")
    monkeypatch.setenv("XDG_CACHE_HOME", "/dev/null")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path / "src"))
    monkeypatch.setenv("PYTHONDONTWRITEBYTECODE", "1")
    told, said = answer()
    assert told == first[0]
    assert said.count("\n") == 1
    assert "cannot be kept" in said
