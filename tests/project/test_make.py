"""What `make quick` runs: the tests of what changed."""

from pathlib import Path

import pytest

from changed import of_files

BESIDE = ["analysis/maps/test_one.py", "analysis/maps/test_two.py"]


@pytest.fixture
def clone(tmp_path: Path) -> Path:
    """Give a small package and its tests."""
    tests = tmp_path / "tests"
    for folder in ("analysis/maps", "project", "support"):
        (tests / folder).mkdir(parents=True)
    (tests / "analysis/maps/test_one.py").write_text("from undula.analysis.maps.one import f\n")
    (tests / "analysis/maps/test_two.py").write_text("import undula\nfrom systems import run\n")
    (tests / "project/test_pages.py").write_text("")
    return tmp_path


@pytest.mark.parametrize(
    ("changed", "tests"),
    [
        ("src/undula/analysis/maps/one.py", ["analysis/maps/test_one.py"]),
        (
            "src/undula/analysis/maps/new.py",
            ["analysis/maps/test_one.py", "analysis/maps/test_two.py"],
        ),
        ("src/undula/errors.py", ["project/test_pages.py"]),
        ("tests/support/systems.py", ["analysis/maps/test_two.py"]),
        ("tests/analysis/maps/test_two.py", ["analysis/maps/test_two.py"]),
        ("tests/analysis/maps/test_gone.py", []),
        ("docs/index.md", []),
    ],
)
def test_tests_of_a_change_are_those_beside_it_that_import_it(
    changed: str, tests: list[str], clone: Path
) -> None:
    assert sorted(of_files([changed], clone)) == [f"tests/{test}" for test in tests]
