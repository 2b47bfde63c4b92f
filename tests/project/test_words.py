"""Docstrings and comments are plain English, and former names do not come back."""

import ast
import io
import re
import tokenize
from collections.abc import Iterator
from functools import cache
from itertools import pairwise
from pathlib import Path

import pytest

import undula

SOURCE = Path(undula.__file__).parent
#: Forms that no docstring and no comment has.
BANNED_FORMS = {
    "tell": re.compile(r"\b(tells?|told|telling|has to tell)\b"),
    "is none": re.compile(r"\b(is|are) none\b(?! of)"),
    "so many": re.compile(r"\bso (many|much as)\b"),
    "beside": re.compile(r"\bbeside\b"),
    "goes round": re.compile(r"\b(go|goes|going|went|gone) round\b"),
    "held body": re.compile(r"\bheld (body|bodies)\b"),
    "come to": re.compile(r"\b(comes?|came|coming) to\b(?! rest)"),
}
#: Words with which no docstring and no description of an attribute or argument begins.
BANNED_OPENINGS = re.compile(r"(What|How|Whether)\b")
#: Former names that stand for nothing else in the field.
FORMER_NAMES = {
    *("lent", "Late", "Recent", "found_again", "Winding", "WindingRod", "Arrival", "Lookout"),
    *("Judged", "kind_named", "Pace", "weigh", "Spread", "slid", "slip", "take_change"),
    *("gentle_structure", "gentle_kernel", "FramedRod", "framed", "ASIDE", "unrest"),
    *("brief", "SHOWN_BRIEFLY", "BRIEFLY", "shown_until", "BRIEFLY_TOLD"),
    *("FOLLOWED", "WATCHED", "RESTLESS", "FALLS", "LITTLE", "STILL", "HOVERING", "THIN", "MOST"),
    *("GOES_ROUND", "SIGNIFICANT", "RECURRENT", "PRECESSES", "WINDMILLS", "SUBTLE", "PLAIN"),
    *("Birth", "births", "birth_of", "born_downwards", "follow_born", "Stretches", "known_to"),
    *("Borders", "borders", "solved_borders", "solved_line", "Course", "settle_and_step"),
    *("Told", "Asked", "claim_output", "slips", "complaints", "disagreements", "critical_force"),
    *("load_study", "load_steps", "load_series", "write_steps", "step_diagram"),
}
#: Former names that are also ordinary words: banned where their kind of object was renamed.
FORMER_FUNCTIONS = {
    *("missing", "told", "come_to", "refactor", "departure", "spins", "windmills", "flaps"),
    *("winds", "winding", "returns", "converged", "held_name", "rests", "wandering", "study"),
}
#: Functions that claims of the catalogue call by these names.
WORDS_OF_CLAIMS = {("reproduction/claims/measures.py", "missing")}
FORMER_CLASSES = {"Memory", "Closure", "Study", "Held", "Continuum"}


SOURCES = sorted(SOURCE.rglob("*.py"))


@cache
def tree_of(path: Path) -> ast.Module:
    """Return the syntax tree of a file."""
    return ast.parse(path.read_text("utf-8"))


def docstrings(tree: ast.Module) -> Iterator[tuple[int, str]]:
    """Yield line and text of every docstring, those of modules included."""
    kinds = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    for node in ast.walk(tree):
        if isinstance(node, kinds) and (text := ast.get_docstring(node)):
            yield node.body[0].lineno, text


def comments(text: str) -> Iterator[tuple[int, str]]:
    """Yield line and text of every block of comments, with its lines joined."""
    block, first, last = "", 0, 0
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type != tokenize.COMMENT:
            continue
        line, words = token.start[0], token.string.lstrip("#: ")
        if block and line == last + 1:
            block, last = f"{block} {words}", line
            continue
        if block:
            yield first, block
        block, first, last = words, line, line
    if block:
        yield first, block


def prose(text: str) -> Iterator[tuple[int, str]]:
    """Yield line and text of docstrings and comments, without code and with single spaces."""
    for line, words in (*docstrings(ast.parse(text)), *comments(text)):
        plain = re.sub(r"``.*?``|`.*?`|>>>.*|\"[^\"]*\"", " ", words)
        yield line, re.sub(r"\s+", " ", plain)


def openings(docstring: str) -> Iterator[str]:
    """Yield the first line of a docstring and the first lines of its indented descriptions."""
    lines = docstring.splitlines()
    yield lines[0]
    for heading, description in pairwise(lines):
        if re.match(r"\w[\w, *]*( : .*)?$", heading) and re.match(r" {4}\S", description):
            yield description.strip()


def defined_names(tree: ast.Module) -> Iterator[tuple[int, str, str]]:
    """Yield line, kind and name of everything that a module defines or binds."""
    for node in ast.walk(tree):
        if isinstance(node, ast.ClassDef):
            yield node.lineno, "class", node.name
        elif isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            yield node.lineno, "function", node.name
        elif isinstance(node, ast.arg):
            yield node.lineno, "argument", node.arg
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            yield node.lineno, "variable", node.id
        elif isinstance(node, ast.alias):
            yield node.lineno, "import", (node.asname or node.name).rpartition(".")[2]


def is_former(kind: str, name: str) -> bool:
    """Return True if a name is a former one for its kind of object."""
    plain = name.lstrip("_")
    return (
        plain in FORMER_NAMES
        or (kind == "function" and plain in FORMER_FUNCTIONS)
        or (kind == "class" and plain in FORMER_CLASSES)
    )


def place(path: Path) -> str:
    return path.relative_to(SOURCE).as_posix()


@pytest.mark.parametrize("path", SOURCES, ids=place)
def test_no_docstring_and_no_comment_has_a_banned_form(path: Path) -> None:
    found = [
        f"{place(path)}:{line}: {form!r} in {text[:80]!r}"
        for line, text in prose(path.read_text("utf-8"))
        for form, pattern in BANNED_FORMS.items()
        if pattern.search(text)
    ]
    assert not found


@pytest.mark.parametrize("path", SOURCES, ids=place)
def test_no_docstring_or_description_begins_with_a_question_word(path: Path) -> None:
    found = [
        f"{place(path)}:{line}: {opening}"
        for line, text in docstrings(tree_of(path))
        for opening in openings(text)
        if BANNED_OPENINGS.match(opening)
    ]
    assert not found


@pytest.mark.parametrize("path", SOURCES, ids=place)
def test_no_former_name_is_defined(path: Path) -> None:
    found = [
        f"{place(path)}:{line}: {kind} {name}"
        for line, kind, name in defined_names(tree_of(path))
        if is_former(kind, name) and (place(path), name) not in WORDS_OF_CLAIMS
    ]
    assert not found


def test_every_exception_is_a_word_that_claims_use() -> None:
    claims = [path.read_text("utf-8") for path in SOURCE.glob("reproduction/claims/items/*.toml")]
    for name, word in WORDS_OF_CLAIMS:
        assert any(f"{word}(" in text for text in claims), f"{name}: {word}"


@pytest.mark.parametrize(
    "text",
    [
        '"""What is told from the beats."""',
        "# There is none.",
        "# There are as many, so many are left.",
        "# A later sample beside it.",
        "# The motion goes\n# round the axis.",
        "# Names of held bodies.",
        "# The state that a run has come to.",
    ],
)
def test_a_banned_form_is_seen(text: str) -> None:
    assert any(
        pattern.search(words) for _, words in prose(text) for pattern in BANNED_FORMS.values()
    )


@pytest.mark.parametrize(
    "text", ["# None of these is none of ours.", "# A run that comes to rest.", "# `told` [T]."]
)
def test_plain_english_is_not_taken_for_a_banned_form(text: str) -> None:
    assert not any(
        pattern.search(words) for _, words in prose(text) for pattern in BANNED_FORMS.values()
    )


def test_a_question_word_is_seen_at_the_beginning_of_a_description() -> None:
    text = "A run.\n\nAttributes\n----------\nfirst, last : int\n    How many there are.\n"
    assert [opening for opening in openings(text) if BANNED_OPENINGS.match(opening)]
    assert not [opening for opening in openings("A run.\n\nTells how.") if opening != "A run."]


@pytest.mark.parametrize(
    ("code", "name"),
    [("def missing(): pass", "missing"), ("_THIN = 1", "_THIN"), ("class Memory: pass", "Memory")],
)
def test_a_former_name_is_seen(code: str, name: str) -> None:
    names = defined_names(ast.parse(code))
    assert name in {text for _, kind, text in names if is_former(kind, text)}
    assert not is_former("variable", "missing")
