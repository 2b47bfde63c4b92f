"""Claims on texts of a number and its unit: values known by definition, and refusals."""

import contextlib
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from refusal import complaint
from undula.errors import InputError
from undula.schema.unit_texts import has_unit, si_value

# (quantity, text, SI value by the definition of the unit)
VALUES = [
    ("length", "12 um", 12e-6),
    ("length", "12um", 12e-6),
    ("length", "12 µm", 12e-6),
    ("length", "1.2e-2 mm", 12e-6),
    ("length", "120000 angstrom", 12e-6),
    ("stiffness", "25 pN um^2", 25e-24),
    ("stiffness", "25 pN*um**2", 25e-24),
    ("stiffness", "25 pN·µm²", 25e-24),
    ("viscosity", "1 mPa s", 1e-3),
    ("viscosity", "1 cP", 1e-3),
    ("force", "8 pN", 8e-12),
    ("force", "8e-7 dyn", 8e-12),
    ("time", "0.2 s", 0.2),
    ("time", "200 ms", 0.2),
    ("frequency", "20 Hz", 20.0),
    ("frequency", "20 1/s", 20.0),
    ("energy", "40 pN um", 4e-17),
    ("curvature", "0.1 1/um", 1e5),
    ("curvature", "0.1 um^-1", 1e5),
]


@pytest.mark.parametrize(("quantity", "text", "value"), VALUES)
def test_a_text_has_the_value_that_its_unit_defines(quantity: str, text: str, value: float) -> None:
    assert si_value("name", text, quantity) == pytest.approx(value, rel=1e-14)


@pytest.mark.parametrize(
    ("quantity", "given", "sentence"),
    [
        ("length", 12, "is not a number and its unit"),
        ("length", "", "is not a number and its unit"),
        ("length", "nan um", "is not a number and its unit"),
        ("length", "um", "is not a number and its unit"),
        ("length", "12", "has no unit"),
        ("length", "12 s", "has a unit that is not that of a length"),
        ("length", "12 degC", "has a unit that is not that of a length"),
        ("energy", "12 N", "has a unit that is not that of an energy"),
        ("length", "12 zork", "has a unit that is not known"),
        ("length", "1e999 um", "is inf m, which is out of range"),
        ("force", "9**9 N", "has a unit that cannot be read"),
        ("force", "1 N**9**9", "has a unit that cannot be read"),
        ("force", "1 N; N", "has a unit that cannot be read"),
        ("force", f"1 {'N ' * 40}", "has a unit that cannot be read"),
        ("frequency", "60 rpm", "has a unit that is one of an angle"),
    ],
)
def test_whatever_is_no_quantity_is_refused_with_an_example(
    quantity: str, given: object, sentence: str
) -> None:
    refused = complaint(lambda: si_value("name", given, quantity))
    assert refused.startswith("name = ")
    assert sentence in refused
    assert "; give a" in refused


@pytest.mark.parametrize(
    ("quantity", "given", "sentence"),
    [
        ("length", "-12 um", "is not above 0; give a length with its unit, such as '12 um'"),
        ("stiffness", "0 pN um^2", "is not above 0; give a stiffness"),
        ("length", "12 parsec", "is 3.7e+17 m, which is out of range; give a length from 1e-09"),
        ("viscosity", "1e-12 Pa s", "is 1e-12 Pa s, which is out of range; give a viscosity"),
    ],
)
def test_properties_of_a_filament_are_positive_and_within_bounds(
    quantity: str, given: str, sentence: str
) -> None:
    assert math.isfinite(si_value("name", given, quantity))
    refused = complaint(lambda: si_value("name", given, quantity, of_filament=True))
    assert sentence in refused


@given(st.text(max_size=30), st.sampled_from(["length", "stiffness", "viscosity", "force"]))
def test_any_text_has_a_finite_value_or_is_refused(text: str, quantity: str) -> None:
    with contextlib.suppress(InputError):
        assert math.isfinite(si_value("name", text, quantity))


@given(st.text("0123456789.eE+-*/^ umNPas²·1", max_size=20))
def test_any_arithmetic_has_a_finite_value_or_is_refused(text: str) -> None:
    with contextlib.suppress(InputError):
        assert math.isfinite(si_value("name", text, "force"))


@pytest.mark.parametrize(
    ("text", "result"),
    [
        ("8 pN", True),
        ("8pN", True),
        ("8", False),
        ("8O", False),
        ("0, 1", False),
        ("settled", False),
    ],
)
def test_a_unit_is_a_known_one_after_a_number(text: str, result: bool) -> None:
    assert has_unit(text) is result
