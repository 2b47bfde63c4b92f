"""The example programs run, and pin what they claim; the gallery shows every example."""

import runpy
from pathlib import Path

import pytest

from cases import mostly_slow
from pages import DOCS, ROOT

ALL = sorted(path for path in (ROOT / "examples").iterdir() if path.suffix in (".py", ".toml"))
PROGRAMS = [path for path in ALL if path.suffix == ".py"]
#: Programs that take half a minute and more.
LONG = {"natural_curvature", "second_transition", "two_and_three_links"}


@pytest.mark.parametrize(
    "example",
    mostly_slow(PROGRAMS, lambda path: path.stem not in LONG),
    ids=lambda path: path.stem,
)
def test_an_example_runs_and_draws_its_figure(example: Path, tmp_path: Path) -> None:
    figure = tmp_path / "figure.png"
    # Each asserts its own claim.
    runpy.run_path(str(example))["main"](str(figure))
    assert figure.read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("example", ALL, ids=lambda path: path.name)
def test_an_example_is_in_the_gallery_with_its_command_and_a_figure(example: Path) -> None:
    gallery = (DOCS / "gallery.md").read_text(encoding="utf-8")
    (shown,) = (part for part in gallery.split("\n### ") if f": `{example.name}`" in part)
    assert f" examples/{example.name}" in shown
    assert "](img/" in shown
