"""The examples in the docstrings of exported names run and give what they show."""

import doctest
from typing import Any

import pytest

import undula

FINDER = doctest.DocTestFinder(recurse=False)
#: Models, loads and initial states: each of them shows an example.
BUILDING_BLOCKS = (
    *("Chain", "CurvatureTable", "Filament", "InputError", "Scales"),
    *("BeadLoad", "LinearLoad", "Load", "PointLoad", "PowerLoad", "ProfileLoad", "TableLoad"),
    *("TipLoad", "from_state", "helix", "kicked", "mode", "planar", "straight"),
)


def examples(name: str) -> list[doctest.DocTest]:
    exported: Any = getattr(undula, name)
    found = FINDER.find(exported, name, globs={})
    return [example for example in found if example.examples]


@pytest.mark.parametrize("name", BUILDING_BLOCKS)
def test_every_building_block_shows_an_example(name: str) -> None:
    assert examples(name)


@pytest.mark.parametrize("name", sorted({*undula.__all__} - {"observables", "views"}))
def test_examples_give_what_they_show(name: str) -> None:
    for example in examples(name):
        shown = list[str]()
        failed, _ = doctest.DocTestRunner(verbose=False).run(example, out=shown.append)
        assert not failed, "".join(shown)


def test_an_example_that_gives_something_else_fails() -> None:
    wrong = doctest.DocTestParser().get_doctest(">>> 1 + 1\n3\n", {}, "wrong", None, 0)
    assert doctest.DocTestRunner(verbose=False).run(wrong, out=lambda _: None).failed == 1
