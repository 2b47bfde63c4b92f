"""The house keeps its shape: who imports whom, and the purpose of each dependency."""

import ast
import re
import subprocess
import sys
import sysconfig
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SOURCE = ROOT / "src" / "undula"
MODULES = sorted(SOURCE.rglob("*.py"))
NETCDF_CALLS = re.compile(
    r"^(open|load)_(dataset|dataarray|mfdataset|datatree|groups)$|^to_netcdf$"
)


def room(path: Path) -> str:
    """Dotted name of a module inside the package, without the package's own name."""
    return ".".join(path.relative_to(SOURCE).with_suffix("").parts)


def imported(tree: ast.AST) -> Iterator[str]:
    """Full name of everything that a module imports, at its head or inside a function."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield "." * node.level + (node.module or "")


def attributes(tree: ast.AST) -> Iterator[str]:
    """Name of every attribute that a module reads."""
    yield from (node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute))


def parsed() -> Iterator[tuple[str, ast.AST]]:
    """Each module's dotted name with its syntax tree."""
    for path in MODULES:
        yield room(path), ast.parse(path.read_text(encoding="utf-8"), str(path))


def users_of(*packages: str) -> set[str]:
    """Modules that import one of these outside packages."""
    return {
        name
        for name, tree in parsed()
        if any(target.split(".")[0] in packages for target in imported(tree))
    }


def runtime_dependencies() -> list[str]:
    """Names of the packages that running undula needs."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    return [re.split(r"[^A-Za-z0-9_.-]", line)[0] for line in project["dependencies"]]


def test_imports_follow_the_contracts_of_the_house() -> None:
    linter = Path(sysconfig.get_path("scripts")) / "lint-imports"
    done = subprocess.run(
        [sys.executable, str(linter), "--no-cache"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_no_module_imports_from_the_front_door() -> None:
    assert {name for name, tree in parsed() if "undula" in imported(tree)} == set()


@pytest.mark.parametrize("package", runtime_dependencies())
def test_every_runtime_dependency_states_its_reason(package: str) -> None:
    page = (ROOT / "docs" / "dependencies.md").read_text(encoding="utf-8")
    assert re.search(rf"^\| {re.escape(package)} \|", page, re.MULTILINE)


def test_only_views_and_the_figures_of_the_paper_import_plotting_libraries() -> None:
    users = users_of("matplotlib", "mpl_toolkits", "imageio", "imageio_ffmpeg")
    drawing = ("views.", "reproduction.figures.")
    assert {name for name in users if not name.startswith(drawing)} == set()


def test_only_the_store_opens_result_files() -> None:
    libraries = users_of("h5netcdf", "h5py", "netCDF4")
    callers = {name for name, tree in parsed() if any(map(NETCDF_CALLS.match, attributes(tree)))}
    # The reading on trial is the work of another process, which reads for nobody.
    assert libraries | callers <= {"storage.run_file", "storage.format_of", "storage.trial_reading"}
