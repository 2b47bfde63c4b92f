"""What the library says holds wherever it is called from: it names no command and no option."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

import undula

SOURCE = Path(undula.__file__).parent
#: Rooms that know nothing of the command line.
ROOMS = ("analysis", "models", "numerics")
#: Of the other packages the files that read nothing that is typed and no file that a command makes.
PURE = {
    "inputs": (
        "build",
        "messages",
        "model_tables",
        "ramp_values",
        "ranges",
        "run_tables",
        "sweep_table",
        "table",
    ),
    "sweeps": ("chunk_grid", "point", "sweep"),
    "schema": ("sweep_variables",),
    "storage": ("differences",),
    "reproduction/claims": ("catalogue", "errata", "evaluate", "measures", "sweep_measures"),
}
COMMANDS = (
    *("run", "resume", "plot", "stability", "find", "follow", "threshold", "step", "sweep"),
    *("status", "reproduce", "units", "movie"),
)
NAMED = re.compile(rf"\bundula ({'|'.join(COMMANDS)})\b|(?<![\w-])--[a-z]")


def modules() -> list[Path]:
    pure = [SOURCE / room / f"{name}.py" for room, names in PURE.items() for name in names]
    return sorted([*(path for room in ROOMS for path in (SOURCE / room).rglob("*.py")), *pure])


def texts(tree: ast.Module) -> Iterator[tuple[int, str]]:
    """Yield line and text of every string that is no docstring."""
    told = {
        id(node.value)
        for node in ast.walk(tree)
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in told:
            yield node.lineno, node.value


@pytest.mark.parametrize("path", modules(), ids=lambda path: f"{path.parent.name}/{path.stem}")
def test_no_message_of_the_library_names_a_command_or_an_option(path: Path) -> None:
    found = [
        f"{path.name}:{line}: {text}"
        for line, text in texts(ast.parse(path.read_text("utf-8")))
        if NAMED.search(text)
    ]
    assert not found


@pytest.mark.parametrize(
    "text", ["ask undula stability", "as in --along load.force=1:2", "`undula find spinning`"]
)
def test_a_command_or_an_option_is_seen_in_a_text(text: str) -> None:
    assert NAMED.search(text)
    assert not NAMED.search("what undula is - a well-known -- library")
