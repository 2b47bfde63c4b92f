"""Each verdict has one colour, from one table, in every figure."""

import ast
import re
from pathlib import Path

import pytest

import undula
from undula.reproduction.figures.branch_panels import FLAPPING, SPINNING, STRAIGHT
from undula.views.branches.named_branches import _FURTHER, _colours
from undula.views.common.verdict_styles import LOOKS, look_of, ordered

PACKAGE = Path(undula.__file__).parent
TABLE = PACKAGE / "views" / "common" / "verdict_styles.py"


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
