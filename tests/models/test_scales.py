"""Claims on SI scales: the published values, the way there and back, refusals."""

import math
from typing import get_args

import pytest
from hypothesis import given
from hypothesis import strategies as st

from refusal import complaint
from undula.errors import InputError
from undula.models.scales import Quantity, Scales

# Ling, Guo & Kanso, J. R. Soc. Interface 2018: Table 1, and for the two forces its discussion
# of the transitions. (quantity, dimensionless, SI, half a unit of the last printed digit)
PUBLISHED = [
    ("time", 1.0, 0.546, 0.0005),
    ("frequency", 1.0, 1.83, 0.005),
    ("force", 1.0, 2e-12, 0.5e-12),
    ("force_density", 1.0, 0.1e-6, 0.05e-6),
    ("length", 1.0, 20e-6, 0.5e-6),
    ("force", 37.7, 75.4e-12, 0.05e-12),
    ("force", 188.0, 376e-12, 0.5e-12),
]
QUANTITIES: list[Quantity] = list(get_args(Quantity))
# Far beyond any filament, and far inside what is accepted.
sizes = st.floats(1e-30, 1e30)


@pytest.mark.parametrize(("quantity", "number", "si", "half_digit"), PUBLISHED)
def test_the_published_si_values_are_met_to_the_last_printed_digit(
    quantity: Quantity, number: float, si: float, half_digit: float
) -> None:
    assert abs(Scales().to_si(quantity, number) - si) <= half_digit


def test_the_published_normal_drag_is_met_to_the_last_printed_digit() -> None:
    # Same table: 2.73e-3 Pa s.
    assert abs(Scales().normal_drag - 2.73e-3) <= 0.005e-3


def test_the_default_force_units_are_exact_in_piconewtons() -> None:
    # 800 pN um^2 over 20 um squared and cubed; only round-off separates them.
    assert Scales().force == pytest.approx(2e-12, rel=1e-14)
    assert Scales().force_density == pytest.approx(1e-7, rel=1e-14)
    assert Scales().energy == pytest.approx(4e-17, rel=1e-14)


@given(sizes, sizes, sizes, st.floats(1e-9, 0.999), st.sampled_from(QUANTITIES))
def test_converting_there_and_back_changes_nothing(
    length: float, stiffness: float, viscosity: float, slenderness: float, quantity: Quantity
) -> None:
    scales = Scales(length, stiffness, viscosity, slenderness)
    # One product and one quotient: at most two roundings.
    assert scales.from_si(quantity, scales.to_si(quantity, 75.0)) == pytest.approx(75.0, rel=1e-15)


@given(st.floats(0.1, 10.0))
def test_each_unit_scales_with_the_power_of_length_that_it_should(factor: float) -> None:
    one, other = Scales(), Scales(length=factor * Scales().length)
    powers = {"time": 4, "frequency": -4, "force": -2, "force_density": -3, "energy": -1}
    powers |= {"rate": -4, "power": -5, "curvature": -1}
    for quantity, power in powers.items():
        # A handful of roundings, raised to the fourth power.
        ratio = getattr(other, quantity) / getattr(one, quantity)
        assert ratio == pytest.approx(factor**power, rel=1e-13)


@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf, -math.inf, 1e-300, 1e300])
@pytest.mark.parametrize("name", ["length", "bending_stiffness", "viscosity", "slenderness"])
def test_a_value_that_gives_no_scales_is_refused_by_name(name: str, value: float) -> None:
    with pytest.raises(InputError, match="is not a positive number") as caught:
        Scales(**{name: value})
    assert str(caught.value).startswith(f"{name} = {value} is not")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("slenderness", [1.0, 1.5])
def test_a_rod_as_thick_as_long_is_refused(slenderness: float) -> None:
    with pytest.raises(InputError, match=r"^slenderness = 1\.\d is out of range; .* below 1$"):
        Scales(slenderness=slenderness)


@pytest.mark.parametrize("extreme", [1e-36, 1e36])
def test_the_widest_accepted_values_still_give_finite_scales(extreme: float) -> None:
    scales = Scales(length=extreme, bending_stiffness=1 / extreme, viscosity=extreme)
    values = [getattr(scales, quantity) for quantity in QUANTITIES]
    assert all(math.isfinite(value) and value > 0.0 for value in values)


def test_scales_are_made_from_texts_with_units() -> None:
    texts = {"length": "12 um", "stiffness": "25 pN um^2", "viscosity": "1 mPa s"}
    assert Scales.from_units(**texts, slenderness=0.02) == Scales(12e-6, 25e-24, 1e-3, 0.02)
    assert Scales.from_units() == Scales()


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"length": "12 s"}, "length = '12 s' has a unit that is not that of a length; give a"),
        ({"length": "12 parsec"}, "length = '12 parsec' is 3.7e+17 m, which is out of range;"),
        ({"stiffness": "-1 pN um^2"}, "stiffness = '-1 pN um^2' is not above 0; give a"),
        ({"viscosity": 1e-3}, "viscosity = 0.001 is not a number and its unit; give a viscosity"),
        ({"slenderness": 1.5}, "slenderness = 1.5 is out of range"),
    ],
)
def test_texts_that_give_no_scales_are_refused_by_name(given: dict, sentence: str) -> None:
    assert complaint(lambda: Scales.from_units(**given)).startswith(sentence)


def test_physical_numbers_are_those_of_the_published_table_in_their_units() -> None:
    assert Scales().physical("force", 37.7) == (pytest.approx(75.4, rel=1e-12), "pN")
    assert Scales().physical("length", 1.0) == (pytest.approx(20.0, rel=1e-12), "um")
    assert Scales().physical("curvature", 1.0) == (pytest.approx(0.05, rel=1e-12), "1/um")


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_a_unit_in_the_table_is_one_dimensionless_unit(quantity: Quantity) -> None:
    value, unit = Scales().physical(quantity, 1.0)
    assert Scales().units()[quantity] == {"value": value, "unit": unit}


def test_power_is_energy_in_time_and_rate_is_one_over_time() -> None:
    scales = Scales()
    assert scales.power * scales.time == pytest.approx(scales.energy, rel=1e-15)
    assert scales.rate == scales.frequency
