"""What README and docs tell a reader to type does what they say."""

import ast
import inspect
import re
import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
import typer

import undula
from cases import mostly_slow
from pages import DOCS, PAGES, blocks, called, name, named, typed
from stand_ins import BegunError, examples_in, results_in, stop_where_work_begins
from undula.app.cli import app, main

#: Pages with a block that takes long: a phrase of the block, and why it does.
HEAVY = {
    "docs/diagrams.md": ("stability_boundaries(", "boundaries take half a minute a column"),
}
#: What a page writes for something that the reader has to fill in.
BLANK = re.compile(r"\b[A-Z]+\b(?!\^)")
COMMANDS = typer.main.get_command(app).commands  # type: ignore[attr-defined]

MODEL = undula.Filament(4, undula.TipLoad(75.0))

#: Pages whose Python is run by `make test-slow` alone.
SLOW_PAGES = {
    *("docs/diagrams.md", "docs/output.md"),
    *("docs/theory/curved.md", "docs/theory/regimes.md"),
}

with_python = [page for page in PAGES if blocks(page)]


@pytest.fixture(autouse=True)
def _at_the_root(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    examples_in(tmp_path)


def is_heavy(page: Path, block: str) -> bool:
    return name(page) in HEAVY and HEAVY[name(page)][0] in block


def run(page: Path, chosen: Sequence[str], capsys: pytest.CaptureFixture[str]) -> None:
    """Run blocks of a page one after another, and compare what they print with what it says."""
    names: dict[str, Any] = {}
    for block in chosen:
        exec(compile(block, name(page), "exec"), names)
        said = capsys.readouterr().out.splitlines()
        promised = re.findall(r"^print\(.*\)  # (.*)$", block, re.MULTILINE)
        for promise in promised:
            assert any(keeps(promise, line) for line in said), (promise, said)


def keeps(promise: str, line: str) -> bool:
    """Whether a line begins with what was promised of it, up to its dots."""
    promised, told = promise.split("...")[0].split(), line.split()
    return len(promised) <= len(told) and all(map(agree, promised, told))


def agree(promised: str, told: str) -> bool:
    """Whether two words are equal; numbers to a unit of their last digit, errors to their size."""
    try:
        number, other = float(promised.strip("(),:")), float(told.strip("(),:"))
    except ValueError:
        return promised == told
    digits = promised.strip("(),:")
    if "e" in digits:  # of an error only the size is meant, which round-off may change
        return 0.1 < other / number < 10.0
    last = 10.0 ** -len(digits.partition(".")[2])
    return abs(other - number) < 1.01 * last


@pytest.mark.parametrize(
    "page", mostly_slow(with_python, lambda page: name(page) not in SLOW_PAGES), ids=name
)
def test_the_python_of_a_page_runs_and_prints_what_it_says(
    page: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    light = [block for block in blocks(page) if not is_heavy(page, block)]
    if any("results/" in block for block in light):
        results_in(tmp_path)
    run(page, light, capsys)


@pytest.mark.parametrize("heavy", HEAVY)
def test_what_is_heavy_is_on_its_page(heavy: str) -> None:
    (page,) = (page for page in PAGES if name(page) == heavy)
    assert any(is_heavy(page, block) for block in blocks(page))


@pytest.mark.slow
@pytest.mark.parametrize("heavy", HEAVY)
def test_the_heavy_python_of_a_page_runs(
    heavy: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (page,) = (page for page in PAGES if name(page) == heavy)
    results_in(tmp_path)
    run(page, blocks(page), capsys)


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_no_python_is_left_out_of_the_tests(page: Path) -> None:
    # Python that is only indented would not be run.
    text = page.read_text(encoding="utf-8")
    assert not re.search(r"^ {4,}(import|from) \w+", text, re.MULTILINE)


@pytest.mark.parametrize("page", [page for page in PAGES if typed(page) or named(page)], ids=name)
def test_the_commands_of_a_page_are_understood(
    page: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    stop_where_work_begins(monkeypatch)
    for line in [*typed(page), *named(page)]:
        words = shlex.split(line, comments=True)
        if is_abridged(words):
            check_options(words)
        else:
            supply(words)
            try:
                status = main(words)
            except BegunError:
                status = 0
            assert status == 0, (line, capsys.readouterr().err)


def test_every_command_is_on_the_first_page() -> None:
    told = " ".join([*named(DOCS / "index.md"), *typed(DOCS / "index.md")])
    assert set(COMMANDS) <= set(told.split())


def is_abridged(words: Sequence[str]) -> bool:
    """Whether words only name a command, alone, with options, or with blanks to be filled in."""
    return all(word.startswith("-") for word in words[1:]) or any(map(BLANK.search, words))


def check_options(words: Sequence[str]) -> None:
    command = COMMANDS[words[0]]
    known = {option for one in command.params for option in one.opts} | {"--help"}
    assert {word for word in words[1:] if word.startswith("--")} <= known, words


def supply(words: Sequence[str]) -> None:
    """Make the files and folders of results that words name."""
    for path in map(Path, words):
        if path.suffix == ".nc":
            path.parent.mkdir(parents=True, exist_ok=True)
            path.touch()
        elif path.suffix == ".zarr":
            path.mkdir(parents=True, exist_ok=True)


@pytest.mark.parametrize("call", called(DOCS / "questions.md"))
def test_a_call_that_is_told_beside_a_command_has_the_arguments_it_gives(call: str) -> None:
    for node in ast.walk(ast.parse(call)):
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            assert node.value.id != "un" or node.attr in undula.__all__
        if isinstance(node, ast.Call) and not any(is_dots(given) for given in node.args):
            function = eval(ast.unparse(node.func), {"un": undula, "model": MODEL, "range": range})
            if function is not range:
                inspect.signature(function).bind(*node.args, **{k.arg: k for k in node.keywords})


def is_dots(given: ast.expr) -> bool:
    return isinstance(given, ast.Constant) and given.value is ...


@pytest.mark.parametrize("room", ["undula", "undula.views"])
def test_every_public_name_is_on_a_page_of_the_interface(room: str) -> None:
    public = undula.__all__ if room == "undula" else undula.views.__all__
    shown = {
        found
        for page in (DOCS / "api").glob("*.md")
        for found in re.findall(r"^::: (\S+)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    }
    assert {f"{room}.{one}" for one in public} - shown - {"undula.views"} == set()
