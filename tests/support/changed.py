"""The tests of what changed, for `make quick`: those beside a changed file that import it.

``python tests/support/changed.py`` prints their paths. The folders of the tests mirror those of the
package; where none of the tests beside a file imports it, all of them are its tests.
"""

import subprocess
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path

ROOT = Path(__file__).parents[2]
SOURCE, TESTS = "src/undula/", "tests/"


def changed() -> set[str]:
    """Return the paths of files that differ from the common base with the main branch."""
    base = git("merge-base", "HEAD", "origin/main") or ["HEAD"]
    return {*git("diff", "--name-only", *base), *git("ls-files", "--others", "--exclude-standard")}


def git(*words: str) -> list[str]:
    """Return the lines that git prints; none where it fails."""
    done = subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, check=False)
    return done.stdout.split("\n")[:-1] if done.returncode == 0 else []


def of_files(paths: Iterable[str], root: Path = ROOT) -> set[str]:
    """Return the paths of the tests of changed files."""
    return {
        test.relative_to(root).as_posix()
        for path in paths
        if path.endswith((".py", ".toml"))
        for test in _of_file(path, root)
    }


def _of_file(path: str, root: Path) -> Iterator[Path]:
    file = root / path
    if path.startswith(SOURCE):
        yield from _beside(file, root)
    elif path.startswith(TESTS) and file.name.startswith("test_"):
        yield from [file] if file.exists() else []
    elif path.startswith(TESTS):
        yield from _importing(file.stem, (root / TESTS).rglob("test_*.py"))


def _beside(file: Path, root: Path) -> list[Path]:
    """Return the tests in the folder that mirrors that of a source."""
    module = file.relative_to(root / "src").with_suffix("")
    folder = root / TESTS / Path(*module.parts[1:]).parent
    while not folder.is_dir():
        folder = folder.parent
    if folder == root / TESTS:
        folder = folder / "project"
    beside = sorted(folder.glob("test_*.py"))
    return _importing(".".join(module.parts), beside) or beside


def _importing(module: str, tests: Iterable[Path]) -> list[Path]:
    """Return the tests that import a module."""
    package, _, name = module.rpartition(".")
    ways = [f"from {module} import ", f"import {module}\n", f"from {package} import {name}\n"]
    found = [test for test in tests if any(way in test.read_text("utf-8") for way in ways)]
    return sorted(found)


if __name__ == "__main__":
    sys.stdout.write("\n".join(sorted(of_files(changed()))) + "\n")
