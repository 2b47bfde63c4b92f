"""The example programs run, and pin what they claim."""

import runpy
from pathlib import Path

import pytest

EXAMPLES = sorted((Path(__file__).parent.parent / "examples").glob("*.py"))


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_runs_and_draws_its_figure(example: Path, tmp_path: Path) -> None:
    figure = tmp_path / "figure.png"
    # Each asserts its own claim.
    runpy.run_path(str(example))["main"](str(figure))
    assert figure.read_bytes().startswith(b"\x89PNG")
