"""What the pages tell a reader to type: their blocks of Python and their command lines."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGES = sorted(
    [ROOT / "README.md", *DOCS.glob("*.md"), *DOCS.glob("theory/*.md"), *DOCS.glob("api/*.md")]
)

_PYTHON = re.compile(r"^```python\n(.*?)^```", re.DOTALL | re.MULTILINE)
_TYPED = re.compile(r"^(?: {4})?(?:\.venv/bin/)?undula (.*)$", re.MULTILINE)
_CALLED = re.compile(r"`(un\.[^`]+)`")
_NAMED = re.compile(r"`undula ([^`]+)`")


def name(page: Path) -> str:
    """Return the path of a page from the root of the repository."""
    return page.relative_to(ROOT).as_posix()


def blocks(page: Path) -> list[str]:
    """Return the blocks of Python of a page."""
    return _PYTHON.findall(page.read_text(encoding="utf-8"))


def typed(page: Path) -> list[str]:
    """Return what stands behind `undula` on the lines of a page that are to be typed."""
    lines = _TYPED.findall(page.read_text(encoding="utf-8").replace("\\\n", " "))
    return [part for line in lines for part in line.split(" && undula ")]


def named(page: Path) -> list[str]:
    """Return what stands behind `undula` where a page names a command amid its text."""
    return _NAMED.findall(page.read_text(encoding="utf-8"))


def called(page: Path) -> list[str]:
    """Return what a page names of the Python interface amid its text."""
    return _CALLED.findall(page.read_text(encoding="utf-8"))
