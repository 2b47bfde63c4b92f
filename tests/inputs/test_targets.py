"""Targets of inverse questions, with and without units."""

import pytest

from refusal import complaint
from undula.inputs.targets import parse_target
from undula.models.scales import Scales

SCALES = Scales()


@pytest.mark.parametrize(
    ("text", "name", "quantity", "si"),
    [
        ("frequency=20 Hz", "frequency", "frequency", 20.0),
        ("leading_rate = -3 1/s", "leading_rate", "frequency", -3.0),
        ("value=8 pN", "value", "force", 8e-12),
        ("tip_radius_max=2 um", "tip_radius_max", "length", 2e-6),
        ("period=0.5 ms", "period", "time", 5e-4),
    ],
)
def test_a_target_may_have_a_unit_of_its_quantity(
    text: str, name: str, quantity: str, si: float
) -> None:
    found, value = parse_target(text, SCALES)
    assert found == name
    assert SCALES.to_si(quantity, value) == pytest.approx(si, rel=1e-12)  # type: ignore[arg-type]


def test_a_unit_needs_scales_and_the_right_quantity() -> None:
    assert "[units]" in complaint(lambda: parse_target("frequency=20 Hz"))
    assert "frequency" in complaint(lambda: parse_target("frequency=20 pN", SCALES))
    assert "no number" in complaint(lambda: parse_target("frequency=fast", SCALES))
    assert "no number" in complaint(lambda: parse_target("planarity=20 Hz", SCALES))
