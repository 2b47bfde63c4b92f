"""The examples in the docstrings of exported names run and give what they show."""

import contextlib
import doctest
import inspect
import io
import re
from pathlib import Path
from typing import Any

import pytest

import undula
import undula.views
from small_sweeps import done, sweep_of
from undula.app.cli import main

FINDER = doctest.DocTestFinder(recurse=False)
#: Models, loads and initial states: each of them shows an example.
BUILDING_BLOCKS = (
    *("Chain", "CurvatureTable", "Filament", "InputError", "Scales"),
    *("BeadLoad", "LinearLoad", "Load", "PointLoad", "PowerLoad", "ProfileLoad", "TableLoad"),
    *("TipLoad", "from_state", "helix", "kicked", "mode", "planar", "straight"),
)
VIEWS = tuple(f"views.{name}" for name in undula.views.__all__)
#: A filament of a few links, run for a moment.
_MODEL = "[model]\nsegments = 4\n[time]\nuntil = 0.05\nsamples = 60\n"
_FORCES = '[[study.axes]]\nkey = "load.force"\nvalues = [25.0, 75.0, 125.0]\n'
_POINT_LOADS = '[load]\nprofile = "point"\n[study]\nkeep = "period"\n'
_POSITIONS = '[[study.axes]]\nkey = "load.position"\nvalues = [0.5, 1.0]\n'
_STARTS = '[study]\npolicy = "random"\ntries = 3\namplitudes = [0.01, 1.0]\n'


def write_results(folder: Path) -> None:
    """Write a run, a ramp and two sweeps below a folder, as their commands do."""
    results = folder / "results"
    results.mkdir()
    short = folder / "short.toml"
    short.write_text(_MODEL, "utf-8")
    _do("run", str(short), "--out", str(results / "spinning"))
    _do("step", str(short), "--along", "load.force=25:75:25", "--out", str(results))
    point_loads = _MODEL + _POINT_LOADS + _POSITIONS + _FORCES
    done(sweep_of(folder, point_loads), results / "point-loads.zarr")
    done(sweep_of(folder, _MODEL + _STARTS + _FORCES), results / "starts.zarr")


def _do(*words: str) -> None:
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        status = main(list(words))
    assert status == 0, words


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Give a folder with the stored results that examples name."""
    folder = tmp_path_factory.mktemp("examples")
    write_results(folder)
    return folder


def exported(name: str) -> Any:
    """Return what undula exports by a name, as "views.movie"."""
    value: Any = undula
    for part in name.split("."):
        value = getattr(value, part)
    return value


def examples(name: str) -> list[doctest.DocTest]:
    found = FINDER.find(exported(name), name, globs={})
    return [example for example in found if example.examples]


def undescribed(value: Any) -> set[str]:
    """Return the arguments without an entry among the Parameters, or Attributes of a class."""
    section = "Attributes" if inspect.isclass(value) else "Parameters"
    found = re.search(rf"{section}\n-+\n(.*?)(\n\n\w+\n-+\n|\Z)", inspect.getdoc(value) or "", re.S)
    entries = re.findall(r"^(\w[\w, ]*) : .+\n    \S", found[1], re.M) if found else []
    described = {name for entry in entries for name in entry.split(", ")}
    return {*inspect.signature(value).parameters} - described


@pytest.mark.parametrize("name", [*BUILDING_BLOCKS, *VIEWS])
def test_every_building_block_and_view_shows_an_example(name: str) -> None:
    assert examples(name)


@pytest.mark.parametrize("name", VIEWS)
def test_no_example_of_a_view_is_left_out(name: str) -> None:
    lines = [line for found in examples(name) for line in found.examples]
    assert [line.source for line in lines if doctest.SKIP in line.options] == []


@pytest.mark.parametrize("name", VIEWS)
def test_every_view_describes_all_its_arguments_with_their_types(name: str) -> None:
    assert undescribed(exported(name)) == set()


def test_an_argument_without_a_type_or_without_a_description_is_seen() -> None:
    def draw(first: int, second: int, third: int) -> None:
        """Draw.

        Parameters
        ----------
        first : int
            The first.
        second
            The second, without a type.
        third : int

        Returns
        -------
        fourth : int
            Nothing.
        """

    assert undescribed(draw) == {"second", "third"}


@pytest.mark.parametrize("name", sorted({*undula.__all__, *VIEWS} - {"observables", "views"}))
def test_examples_give_what_they_show(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest
) -> None:
    shown = examples(name)
    reads = any("results/" in example.docstring for example in shown)
    monkeypatch.chdir(request.getfixturevalue("results") if reads else tmp_path)
    for example in shown:
        report = list[str]()
        failed, _ = doctest.DocTestRunner(verbose=False).run(example, out=report.append)
        assert not failed, "".join(report)


def test_an_example_that_gives_something_else_fails() -> None:
    wrong = doctest.DocTestParser().get_doctest(">>> 1 + 1\n3\n", {}, "wrong", None, 0)
    assert doctest.DocTestRunner(verbose=False).run(wrong, out=lambda _: None).failed == 1
