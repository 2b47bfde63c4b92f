"""Each verdict has one colour, from one table, in every figure."""

import ast
import re
from collections.abc import Mapping
from pathlib import Path
from typing import get_args, get_type_hints

import pytest

import undula
from undula.analysis.maps.stability_along_force import VERDICTS
from undula.analysis.regimes.verdict import STRAIGHT as STRAIGHT_VERDICT
from undula.analysis.regimes.verdict import UNDECIDED
from undula.analysis.runs.reached_state import ReachedState
from undula.reproduction.figures.branch_panels import FLAPPING, SPINNING, STRAIGHT
from undula.views.branches.named_branches import _FURTHER, _colours
from undula.views.common.verdict_styles import LOOKS, look_of, ordered

PACKAGE = Path(undula.__file__).parent
TABLE = PACKAGE / "views" / "common" / "verdict_styles.py"
#: Modules that name the motion of a run.
NAMING = (*PACKAGE.glob("analysis/regimes/*.py"), PACKAGE / "analysis" / "runs" / "classify_run.py")


def names_given(module: ast.Module, constants: Mapping[str, str]) -> set[str]:
    """Return the words that a module gives as first argument to `Name` or `Verdict`.

    A variable stands for every word that the module assigns to it, or for a named constant.
    """
    words: set[str] = set()
    for node in ast.walk(module):
        called = isinstance(node, ast.Call) and isinstance(node.func, ast.Name)
        if called and node.func.id in ("Name", "Verdict"):
            words |= words_of(node.args[0], module, constants)
    return words


def words_of(value: ast.expr, module: ast.Module, constants: Mapping[str, str]) -> set[str]:
    """Return the words that an expression can have."""
    if isinstance(value, ast.Constant):
        return {value.value}
    if isinstance(value, ast.IfExp):
        first, second = (words_of(part, module, constants) for part in (value.body, value.orelse))
        return first | second
    if isinstance(value, ast.Attribute):
        if value.attr == "name":
            return set()  # of a `Name`, whose words are read where it is made
        assert value.attr == "kind", ast.unparse(value)
        # The kind of a state that the integration has detected.
        return {*get_args(get_type_hints(ReachedState)["kind"])}
    assert isinstance(value, ast.Name), ast.unparse(value)
    if value.id in constants:
        return {constants[value.id]}
    assigned = [
        node.value
        for node in ast.walk(module)
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == value.id
    ]
    assert assigned, f"{value.id} is not assigned in its module"
    return {word for part in assigned for word in words_of(part, module, constants)}


def verdicts_of_runs() -> set[str]:
    """Return every verdict that a run can have."""
    constants = {"STRAIGHT": STRAIGHT_VERDICT, "UNDECIDED": UNDECIDED}
    modules = [ast.parse(path.read_text("utf-8")) for path in NAMING]
    return {word for module in modules for word in names_given(module, constants)}


def test_the_verdicts_of_runs_are_read_from_the_sources_that_give_them() -> None:
    source = 'x = "a" if y else STRAIGHT\nName(x, "r")\nVerdict("b" if z else "c")\nOther("d")'
    assert names_given(ast.parse(source), {"STRAIGHT": "s"}) == {"a", "b", "c", "s"}
    with pytest.raises(AssertionError, match="not assigned"):
        names_given(ast.parse("Name(x)"), {})


def test_each_verdict_that_a_run_or_a_solved_state_can_have_has_its_look_in_the_table() -> None:
    assert verdicts_of_runs() | {*VERDICTS.values()} == LOOKS.keys()


def test_no_two_verdicts_share_a_colour_and_none_has_that_of_unknown_words() -> None:
    colours = [look.colour.lower() for look in LOOKS.values()]
    assert len({*colours, look_of("no verdict").colour.lower()}) == len(colours) + 1


@pytest.mark.parametrize("look", [STRAIGHT, SPINNING, FLAPPING])
def test_panels_of_the_paper_take_colours_from_the_table(look: tuple[str, str]) -> None:
    colour, verdict = look
    assert verdict in LOOKS
    assert colour == look_of(verdict).colour


@pytest.mark.parametrize("names", [("spinning", "planar flapping"), ("planar flapping",)])
def test_a_branch_has_the_colour_of_its_verdict_whatever_its_place(names: tuple[str, ...]) -> None:
    assert _colours(names) == [look_of(name).colour for name in names]
    assert _colours(["modulated"]) == [look_of("modulated spinning").colour]


def test_a_further_branch_of_a_verdict_has_a_colour_that_no_verdict_has() -> None:
    first, second, third = _colours(["spinning", "spinning", "spinning"])
    assert first == look_of("spinning").colour
    assert len({first, second, third}) == 3
    taken = {look.colour.lower() for look in LOOKS.values()}
    assert not taken & {colour.lower() for colour in _FURTHER}


def test_no_other_table_gives_colours_to_verdicts() -> None:
    for path in (*PACKAGE.glob("views/**/*.py"), *PACKAGE.glob("reproduction/figures/*.py")):
        if path == TABLE:
            continue
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.Dict | ast.Tuple):
                source = ast.unparse(node)
                coloured = re.search(r"#[0-9A-Fa-f]{6}|_COLOUR\b", source)
                assert not (coloured and any(f"'{name}'" in source for name in LOOKS)), (
                    f"{path.name}: {source}"
                )


def test_legends_name_verdicts_in_the_order_of_the_table_and_unknown_words_last() -> None:
    assert ordered(["a word", "chaotic", "straight", "chaotic"]) == [
        "straight",
        "chaotic",
        "a word",
    ]
