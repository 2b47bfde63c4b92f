"""Claims on values from the command line: what ranges and lists stand for, and what is neither."""

import pytest

from refusal import complaint
from undula.inputs.ranges import parse_axis, parse_values


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("0:60:4", (0.0, 20.0, 40.0, 60.0)),
        ("1:-1:3", (1.0, 0.0, -1.0)),
        ("2.5:7:1", (2.5,)),
        (" 1e1 : 2e1 : 2 ", (10.0, 20.0)),
        ("75", (75.0,)),
        ("30, 10,20", (30.0, 10.0, 20.0)),
    ],
)
def test_a_range_has_both_ends_and_a_list_keeps_its_order(
    text: str, values: tuple[float, ...]
) -> None:
    found = parse_values("--forces", text)
    assert found == values
    # Numbers of numpy would be told as such in complaints.
    assert {type(value) for value in found} == {float}


def test_an_axis_is_a_parameter_with_its_values() -> None:
    assert parse_axis("--along", "load.slope=-1:1:3") == ("load.slope", (-1.0, 0.0, 1.0))
    assert parse_axis("--along", " model.segments = 10,20") == ("model.segments", (10.0, 20.0))


NO_RANGES = ["", "0:60", "0:60:3:4", "a:60:3", "0:b:3", ":60:3", "1,2,x", "1,,2", "1,2,", "1;2"]


@pytest.mark.parametrize("text", NO_RANGES)
def test_what_is_neither_a_range_nor_a_list_is_refused(text: str) -> None:
    assert complaint(lambda: parse_values("--forces", text)) == (
        f"--forces {text} is no range; write START:STOP:COUNT, or numbers as 1,2,5"
    )


@pytest.mark.parametrize("text", ["nan:60:3", "0:inf:3", "1,-inf", "NaN", "1e400"])
def test_a_number_that_is_not_finite_is_named(text: str) -> None:
    culprit = next(part for part in text.replace(":", ",").split(",") if part not in {"0", "1"})
    assert complaint(lambda: parse_values("--forces", text)) == (
        f"--forces {text}: {culprit} is not a finite number; give one"
    )


@pytest.mark.parametrize("count", ["0", "-3", "2.5", "x", "1000001", "9" * 5000, "٣"])
def test_a_number_of_points_that_is_none_is_refused(count: str) -> None:
    assert complaint(lambda: parse_values("--forces", f"0:60:{count}")) == (
        f"--forces 0:60:{count}: {count} is no number of points; give a whole number from 1 to"
        " 1000000"
    )


def test_a_missing_number_of_points_is_told() -> None:
    assert "nothing is no number of points" in complaint(lambda: parse_values("--forces", "0:60:"))


def test_a_range_too_long_for_a_number_is_refused() -> None:
    assert complaint(lambda: parse_values("--forces", "-1e308:1e308:3")) == (
        "--forces -1e308:1e308:3 spans more than a number can hold; give a shorter range"
    )


@pytest.mark.parametrize("text", ["load.slope", "load.slope=", "=0:1:3", "=", ""])
def test_an_axis_without_a_parameter_or_values_is_refused(text: str) -> None:
    assert complaint(lambda: parse_axis("--along", text)) == (
        f"--along {text} has no 'KEY=RANGE'; write it like load.slope=-1:1:41"
    )


def test_bad_values_of_an_axis_are_named_with_its_parameter() -> None:
    assert complaint(lambda: parse_axis("--along", "load.slope=0:1")) == (
        "--along load.slope 0:1 is no range; write START:STOP:COUNT, or numbers as 1,2,5"
    )
