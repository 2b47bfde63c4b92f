"""Claims on physical numbers in texts, in the units of the published filament."""

import pytest

from undula.models.scales import Quantity, Scales
from undula.terminal.physical import bracketed, of_parameter, scales_lines, with_physical

# B/L^2 = 2 pN, B/L = 40 pN um, 1 cycle per T = 1.832 Hz.
PUBLISHED = Scales()


@pytest.mark.parametrize(
    ("quantity", "values", "error", "text"),
    [
        ("force", [75.0], None, " (150 pN)"),
        ("force", [1.0, 2.5], None, " (2 to 5 pN)"),
        ("force", [1.0, 1.0 + 1e-9], None, " (2 pN)"),
        ("energy", [0.123456], None, " (4.938 pN um)"),
        ("frequency", [77.4], None, " (141.8 Hz)"),
        # Digits beyond the error are left out.
        ("frequency", [77.4], 3.0, " (142 Hz)"),
        ("frequency", [77.4], 100.0, " (100 Hz)"),
        ("rate", [-1.0], 1e-9, " (-1.832 1/s)"),
        ("force", [0.0], 1.0, " (0 pN)"),
    ],
)
def test_a_number_stands_in_brackets_in_its_unit(
    quantity: Quantity, values: list[float], error: float | None, text: str
) -> None:
    assert bracketed(PUBLISHED, quantity, *values, error=error) == text


@pytest.mark.parametrize("values", [[None], [float("nan")], [1.0, None], []])
def test_numbers_that_are_missing_have_no_brackets(values: list[float | None]) -> None:
    assert bracketed(PUBLISHED, "force", *values) == ""


def test_without_scales_texts_and_answers_stay_as_they_are() -> None:
    answer = {"status": "done", "force": 75.0}
    assert bracketed(None, "force", 75.0) == ""
    assert of_parameter(None, "load.force", 75.0) == ""
    assert scales_lines(None) == []
    assert with_physical(answer, "find", None) is answer


def test_a_parameter_has_the_unit_of_its_quantity() -> None:
    assert of_parameter(PUBLISHED, "load.force", 10.0, 20.0) == " (20 to 40 pN)"
    assert of_parameter(PUBLISHED, "load.position", 0.5) == " (10 um)"
    assert of_parameter(PUBLISHED, "load.slope", 0.5) == ""


def test_a_line_below_the_heading_holds_the_units() -> None:
    assert scales_lines(PUBLISHED) == [
        "  L = 20 um, T = 0.5458 s, B/L^2 = 2 pN, B/L = 40 pN um, 1 cycle per T = 1.832 Hz"
    ]


def test_an_answer_holds_its_physical_numbers_besides_its_own() -> None:
    answer = {"status": "done", "force": 75.0}
    physical = {"force": {"value": 150.0, "unit": "pN"}}
    assert with_physical(answer, "find", PUBLISHED) == {**answer, "physical": physical}
