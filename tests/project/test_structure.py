"""The package keeps its shape: import cycles, sizes of folders, modules and functions."""

import ast
from collections import Counter
from collections.abc import Iterator

import grimp
import pytest

from pages import ROOT

SOURCE = ROOT / "src" / "undula"
MODULES = sorted(SOURCE.rglob("*.py"))
TESTS = sorted((ROOT / "tests").rglob("*.py"))
MOST_FILES, MOST_LINES, MOST_LINES_OF_A_FUNCTION = 22, 300, 40
#: Factories write out, in one place, the kernel that they make.
FACTORIES = SOURCE / "models" / "rod"


@pytest.fixture(scope="module")
def graph() -> grimp.ImportGraph:
    """Give the imports between the modules of the package, read from their text."""
    return grimp.build_graph("undula", cache_dir=None)


def cycle(imports: dict[str, set[str]]) -> list[str]:
    """Return the names on a cycle of imports; an empty list where there is no cycle."""
    finished: set[str] = set()

    def follow(name: str, path: list[str]) -> list[str]:
        if name in path:
            return path[path.index(name) :]
        if name not in finished:
            for target in sorted(imports.get(name, ())):
                if closed := follow(target, [*path, name]):
                    return closed
            finished.add(name)
        return []

    return next((closed for name in sorted(imports) if (closed := follow(name, []))), [])


def imports_of(graph: grimp.ImportGraph, depth: int | None = None) -> dict[str, set[str]]:
    """Return what each module imports, or each package at a depth; modules stand alone."""
    imports: dict[str, set[str]] = {}
    for module in graph.modules:
        here = package(module, depth)
        targets = {package(name, depth) for name in graph.find_modules_directly_imported_by(module)}
        imports.setdefault(here, set()).update(targets - {here})
    return imports


def package(module: str, depth: int | None) -> str:
    return ".".join(module.split(".")[:depth])


def test_a_cycle_is_found_where_there_is_one() -> None:
    assert cycle({"a": {"b"}, "b": {"c"}, "c": {"b"}}) == ["b", "c"]
    assert cycle({"a": {"b", "c"}, "b": {"d"}, "c": {"d"}, "d": set()}) == []


def test_no_files_import_each_other_in_a_circle(graph: grimp.ImportGraph) -> None:
    assert cycle(imports_of(graph)) == []


@pytest.mark.parametrize("depth", [2, 3, 4])
def test_no_packages_import_each_other_in_a_circle(graph: grimp.ImportGraph, depth: int) -> None:
    assert cycle(imports_of(graph, depth)) == []


def test_no_folder_holds_too_many_files() -> None:
    counts = Counter(path.parent.relative_to(ROOT).as_posix() for path in (*MODULES, *TESTS))
    assert {folder: count for folder, count in counts.items() if count > MOST_FILES} == {}


def test_no_source_file_is_longer_than_300_lines() -> None:
    lengths = {path.name: len(path.read_text("utf-8").splitlines()) for path in MODULES}
    assert {name: lines for name, lines in lengths.items() if lines > MOST_LINES} == {}


def functions() -> Iterator[tuple[str, int]]:
    """Yield the name of each function and how many lines of code it has, its docstring apart."""
    for path in MODULES:
        if FACTORIES in path.parents:
            continue
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                yield f"{path.relative_to(SOURCE)}: {node.name}", lines_of(node)


def lines_of(node: ast.FunctionDef | ast.AsyncFunctionDef) -> int:
    first = node.body[0]
    told = ast.get_docstring(node) is not None
    docstring = (first.end_lineno or 0) - first.lineno + 1 if told else 0
    return (node.end_lineno or 0) - node.lineno + 1 - docstring


def test_no_function_is_too_long() -> None:
    long = {name: lines for name, lines in functions() if lines > MOST_LINES_OF_A_FUNCTION}
    assert long == {}
