"""`undula units`: conversion between dimensionless and physical numbers of a filament."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from undula.errors import InputError
from undula.models.scales import Quantity, Scales
from undula.schema.physical_units import SHOWN_IN

#: Name of the dimensionless unit of each quantity that the command converts.
UNIT: Mapping[Quantity, str] = {
    "length": "L",
    "time": "T",
    "frequency": "cycles per T",
    "force": "B/L^2",
    "force_density": "B/L^3",
    "energy": "B/L",
}


@dataclass(frozen=True)
class Converted:
    """A value in dimensionless and physical units."""

    quantity: Quantity
    dimensionless: float
    physical: float

    @property
    def unit(self) -> str:
        """Name of the physical unit."""
        return SHOWN_IN[self.quantity][0]


def scales_of(length: float, stiffness: float, viscosity: float, slenderness: float) -> Scales:
    """Return the scales of a filament.

    Parameters
    ----------
    length
        Length [um].
    stiffness
        Bending stiffness [pN um^2].
    viscosity
        Viscosity of the fluid [mPa s].
    slenderness
        Radius over length, above 0 and below 1.

    Raises
    ------
    InputError
        A value is not positive and finite, or the slenderness not below 1.
    """
    given = {"length": length, "stiffness": stiffness, "viscosity": viscosity}
    for name, value in given.items():
        if not 0.0 < value < float("inf"):
            raise InputError(f"--{name} {value} is out of range; give a finite number above 0")
    if not 0.0 < slenderness < 1.0:
        raise InputError(
            f"--slenderness {slenderness} is out of range; give radius over length, above 0 and"
            " below 1"
        )
    return Scales(length * 1e-6, stiffness * 1e-24, viscosity * 1e-3, slenderness)


def without_none(
    *, force: float | None, time: float | None, frequency: float | None, energy: float | None
) -> dict[Quantity, float]:
    """Return the numbers other than None, by quantity."""
    values: dict[Quantity, float | None] = {
        "force": force,
        "time": time,
        "frequency": frequency,
        "energy": energy,
    }
    return {quantity: value for quantity, value in values.items() if value is not None}


def convert(
    scales: Scales, dimensionless: Mapping[Quantity, float], physical: Mapping[Quantity, float]
) -> list[Converted]:
    """Convert numbers in both directions.

    Parameters
    ----------
    scales
        Scales of the filament.
    dimensionless, physical
        Numbers by quantity: in units of L, T and B, and in those of `SHOWN_IN`.

    Raises
    ------
    InputError
        A number is not finite.
    """
    for quantity, value in [*dimensionless.items(), *physical.items()]:
        if not abs(value) < float("inf"):
            raise InputError(f"{quantity} {value} is not a finite number; give a finite one")
    return [
        *(_to_physical(scales, quantity, value) for quantity, value in dimensionless.items()),
        *(_from_physical(scales, quantity, value) for quantity, value in physical.items()),
    ]


def units_answer(scales: Scales, converted: list[Converted]) -> dict[str, Any]:
    """Return scales and conversions in plain JSON types."""
    return {
        "status": "done",
        "filament": {
            "length_um": _tidy(scales.length * 1e6),
            "stiffness_pn_um2": _tidy(scales.bending_stiffness * 1e24),
            "viscosity_mpa_s": _tidy(scales.viscosity * 1e3),
            "slenderness": scales.slenderness,
        },
        "units": {quantity: _with_unit(unit) for quantity, unit in _all_units(scales)},
        "converted": [
            {"quantity": value.quantity, "dimensionless": value.dimensionless} | _with_unit(value)
            for value in converted
        ],
    }


def units_text(scales: Scales, converted: list[Converted]) -> str:
    """Return scales and conversions for people, one in each line."""
    head = (
        f"L = {scales.length * 1e6:g} um, B = {scales.bending_stiffness * 1e24:g} pN um^2,"
        f" viscosity {scales.viscosity * 1e3:g} mPa s, a/L = {scales.slenderness:g}"
    )
    shown = [unit for _, unit in _all_units(scales)] + converted
    return "\n".join([head, *(_line(value) for value in shown)])


def _all_units(scales: Scales) -> Iterator[tuple[Quantity, Converted]]:
    for quantity in UNIT:
        yield quantity, _to_physical(scales, quantity, 1.0)


def _to_physical(scales: Scales, quantity: Quantity, value: float) -> Converted:
    return Converted(quantity, value, scales.physical(quantity, value)[0])


def _from_physical(scales: Scales, quantity: Quantity, value: float) -> Converted:
    number = scales.from_si(quantity, value * SHOWN_IN[quantity][1])
    return Converted(quantity, number, value)


def _tidy(value: float) -> float:
    """Return a number without the round-off of a conversion."""
    return float(f"{value:.12g}")


def _with_unit(value: Converted) -> dict[str, Any]:
    return {"physical": value.physical, "unit": value.unit}


def _line(value: Converted) -> str:
    name, unit = value.quantity.replace("_", " "), UNIT[value.quantity]
    dimensionless = f"{value.dimensionless:>8.6g} {unit:<12}"
    return f"  {name:<13} {dimensionless} = {value.physical:.6g} {value.unit}"
