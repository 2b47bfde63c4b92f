"""The cache of compiled code notices every change of what is compiled, and of nothing else."""

import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any, NamedTuple

import numba
import pytest
from numba.core import codegen

from uncached import uncached
from undula.jit import cache, compilation


class Foreign(NamedTuple):
    """A record of a user's own."""

    a: float
    b: int


Point = type("Point", (Foreign,), {"__module__": "undula.models.anything"})

INNER = "from toy.jit.compilation import kernel\n\n\n@kernel\ndef inner(x):\n    return x + {}\n"
OUTER = """
from toy.jit.compilation import entry
from toy.inner import inner


@entry("")
def outer(x):
    return inner(x)
"""
SHOW = "from toy.outer import outer; print(outer(1.0), sum(outer.stats.cache_hits.values()))"


def digest_of(package: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    monkeypatch.setattr(cache, "PACKAGE", package)
    return cache.kernel_digest.__wrapped__()


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """Return the folder of a package with files on floors of their own."""
    root = tmp_path / "package"
    for floor in ("numerics", "analysis"):
        (root / floor).mkdir(parents=True)
    (root / "one.py").write_text("a = 1\n")
    (root / "numerics" / "two.py").write_text("b = 2\n")
    (root / "analysis" / "sums.py").write_text("from undula.jit.compilation import entry\n")
    (root / "analysis" / "words.py").write_text("c = 3\n")
    return root


def test_the_digest_of_the_same_sources_is_the_same_wherever_they_lie(
    package: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    elsewhere = package.parent / "elsewhere"
    shutil.copytree(package, elsewhere)
    assert digest_of(package, monkeypatch) == digest_of(elsewhere, monkeypatch)


@pytest.mark.parametrize("name", ["one.py", "numerics/two.py", "analysis/sums.py"])
def test_the_digest_changes_with_a_character_of_any_file_that_is_compiled(
    package: Path, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = digest_of(package, monkeypatch)
    with (package / name).open("a") as source:
        source.write("#")
    assert digest_of(package, monkeypatch) != before


def test_the_digest_stays_when_a_file_changes_of_which_nothing_is_compiled(
    package: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = digest_of(package, monkeypatch)
    (package / "analysis" / "words.py").write_text("c = 4\n")
    assert digest_of(package, monkeypatch) == before


def test_compiled_functions_outside_their_floors_take_nothing_from_other_files() -> None:
    # What they took from there could change without a new digest.
    for source in cache.PACKAGE.rglob("*.py"):
        place, text = source.relative_to(cache.PACKAGE), source.read_text("utf-8")
        if place.parts[0] in (*cache.COMPILED_PACKAGES, place.name):
            continue
        if re.search(r"import .*\b(entry|kernel|kernel_in_order)\b", text):
            taken = re.findall(r"^from (undula\S*) import", text, flags=re.MULTILINE)
            assert set(taken) <= {"undula.jit.compilation", "undula.jit.borrowed"}, place


def test_the_digest_changes_when_a_file_comes_goes_or_is_renamed(
    package: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    digests = [digest_of(package, monkeypatch)]
    (package / "three.py").write_text("c = 3\n")
    digests.append(digest_of(package, monkeypatch))
    (package / "three.py").rename(package / "four.py")
    digests.append(digest_of(package, monkeypatch))
    (package / "one.py").unlink()
    digests.append(digest_of(package, monkeypatch))
    assert len(set(digests)) == 4


def test_the_digest_does_not_depend_on_files_that_are_no_sources(
    package: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = digest_of(package, monkeypatch)
    (package / "__pycache__").mkdir()
    (package / "__pycache__" / "one.nbi").write_bytes(b"compiled")
    assert digest_of(package, monkeypatch) == before


def test_functions_and_records_of_other_packages_are_not_kept() -> None:
    # Nothing here would notice that they change.
    assert not isinstance(cache.keep_on_disk(numba.njit(shutil.copytree))._cache, cache.KernelCache)
    own, foreign = (numba.typeof(record(1.0, 2)) for record in (Point, Foreign))
    assert cache._all_ours((numba.float64, own))
    assert not cache._all_ours((numba.float64, foreign))


def test_a_kernel_is_optimised_with_what_calls_it_and_not_before(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    optimised: list[str] = []
    optimise = codegen.JITCodeLibrary._optimize_final_module

    def noted(library: codegen.JITCodeLibrary) -> None:
        optimised.append(library.name)
        optimise(library)

    monkeypatch.setattr(codegen.JITCodeLibrary, "_optimize_final_module", noted)
    inner = compilation.kernel(lambda x: 2.0 * x)

    @uncached
    def outer(x: Any) -> Any:
        return inner(x)

    assert outer(1.5) == inner(1.5) == 3.0
    assert any("outer" in name for name in optimised)
    assert not any("lambda" in name for name in optimised)


def show(folder: Path) -> list[str]:
    """Run the toy in a fresh process; return what it computed and its hits of the cache."""
    command = [sys.executable, "-c", SHOW]
    run = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True)
    return run.stdout.split()


def test_a_changed_kernel_is_compiled_anew_where_another_file_calls_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PYTHONDONTWRITEBYTECODE", "1")  # edits within a second look like none
    toy = tmp_path / "toy"
    toy.mkdir()
    shutil.copytree(Path(compilation.__file__).parent, toy / "jit")
    for source in (toy / "jit").glob("*.py"):
        source.write_text(source.read_text().replace("undula", "toy"))
    (toy / "outer.py").write_text(OUTER)
    (toy / "inner.py").write_text(INNER.format(1.0))
    assert show(tmp_path) == ["2.0", "0"]
    assert show(tmp_path) == ["2.0", "1"]
    (toy / "inner.py").write_text(INNER.format(5.0))
    assert show(tmp_path) == ["6.0", "0"]
