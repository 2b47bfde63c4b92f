"""Claims on answers in physical units, on an answer and units that are made up."""

import json

import pytest

from commands import unknown_keys
from undula.schema.answer_keys import ANSWERS
from undula.schema.key_kinds import FORCE, FREQUENCY, Named, plain, range_of, with_physical
from undula.schema.physical_answer import physical_numbers

KEYS = with_physical(
    {
        **plain("kind", "stable"),
        "force": FORCE,
        "frequency": FREQUENCY,
        "energy": range_of("energy"),
        "by_name": Named(FORCE),
    }
)


def doubled(quantity: str, value: float) -> tuple[float, str]:
    return 2.0 * value, f"of {quantity}"


@pytest.mark.parametrize(
    ("answer", "physical"),
    [
        ({"force": 1.5}, {"force": {"value": 3.0, "unit": "of force"}}),
        ({"force": [1, 2]}, {"force": [{"value": v, "unit": "of force"} for v in (2.0, 4.0)]}),
        ({"force": None, "kind": "a", "stable": True}, {}),
        (
            {"energy": {"min": 1, "max": None}},
            {"energy": {"min": {"value": 2.0, "unit": "of energy"}}},
        ),
        ({"energy": 1.0}, {"energy": {"value": 2.0, "unit": "of energy"}}),
        ({"by_name": {"a": 1.0}}, {"by_name": {"a": {"value": 2.0, "unit": "of force"}}}),
    ],
)
def test_numbers_with_a_unit_are_mirrored_and_nothing_else_is(answer: dict, physical: dict) -> None:
    assert physical_numbers(answer, KEYS, doubled) == physical
    assert unknown_keys(json.dumps({"physical": physical}), KEYS) == []


def test_a_value_has_the_quantity_of_the_parameter_that_its_answer_names() -> None:
    points = [{"load.force": 1.0, "frequency": 3.0}, {"load.force": 2.0, "frequency": None}]
    answer = {
        "parameter": "load.force",
        "points": points,
        "bifurcations": [{"kind": "Hopf", "value": 5.0}],
    }
    physical = physical_numbers(answer, ANSWERS["follow"], doubled)
    assert physical["points"][1] == {"load.force": {"value": 4.0, "unit": "of force"}}
    assert physical["bifurcations"] == [{"value": {"value": 10.0, "unit": "of force"}}]
    assert unknown_keys(json.dumps({"physical": physical}), ANSWERS["follow"]) == []


def test_a_value_of_a_parameter_without_unit_is_left_out() -> None:
    answer = {"parameter": "load.slope", "bifurcations": [{"kind": "fold", "value": 0.5}]}
    assert physical_numbers(answer, ANSWERS["follow"], doubled) == {}


def test_an_axis_names_its_own_parameter() -> None:
    answer = {"axes": [{"key": "load.slope", "first": 0}, {"key": "load.force", "first": 1}]}
    physical = physical_numbers(answer, ANSWERS["sweep"], doubled)
    assert physical == {"axes": [None, {"first": {"value": 2.0, "unit": "of force"}}]}


def test_round_off_of_the_conversion_is_left_out() -> None:
    physical = physical_numbers({"force": 3.0}, KEYS, lambda _, value: (0.1 * value, "N"))
    assert physical["force"]["value"] == 0.3
