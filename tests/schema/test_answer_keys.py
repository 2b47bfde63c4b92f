"""Keys of answers: documented, and compared with whatever a command answers."""

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from commands import unknown_keys
from undula.schema.answer_keys import ANSWERS
from undula.schema.key_kinds import PARAMETER, Named

DOCS = Path(__file__).parents[2] / "docs"
#: Words in code spans of the pages.
DOCUMENTED = {
    word
    for page in DOCS.glob("*.md")
    for span in re.findall(r"`([^`\n]+)`", page.read_text("utf-8"))
    for word in re.findall(r"\w+", span)
}


def names_of(keys: Any) -> Iterator[str]:
    if isinstance(keys, Named):
        yield from names_of(keys.values)
    elif not isinstance(keys, str):
        for name, inner in keys.items():
            yield name
            yield from names_of(inner)


@pytest.mark.parametrize("command", ANSWERS)
def test_every_key_is_documented(command: str) -> None:
    names = {name for name in names_of(ANSWERS[command]) if not name.endswith("_error")}
    assert names - DOCUMENTED - {PARAMETER} == set()


def test_a_key_that_the_schema_lacks_is_found_at_its_place() -> None:
    answer = {"status": "done", "later": [{"force": 1.0, "speed": 2.0}], "haste": 3.0}
    assert unknown_keys(json.dumps(answer), ANSWERS["stability"]) == [".later.speed", ".haste"]


def test_parameters_and_names_that_the_input_gives_are_no_unknown_keys() -> None:
    points = [{"load.position": 0.5, "force": 40.0, "speed": 1.0}]
    answer = {"points": points, "force_in": {"K/l": 2.0}}
    assert unknown_keys(json.dumps(answer), ANSWERS["stability"]) == [".points.speed"]


def test_an_object_in_place_of_a_number_is_found() -> None:
    answer = json.dumps({"force": {"value": 1.0}})
    assert unknown_keys(answer, ANSWERS["find"]) == [
        ".force: an object in place of a number or word"
    ]
