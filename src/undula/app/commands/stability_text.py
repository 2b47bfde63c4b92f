"""Answers of `undula stability` for people."""

from collections.abc import Iterator, Sequence

import numpy as np

from undula.analysis.linear.curves import CriticalCurve, GrowthCurve
from undula.analysis.linear.results import Crossing, Onset, Spectrum
from undula.models.units import Units
from undula.terminal.numbers import with_error
from undula.terminal.units_text import units_lines

#: Unit of time of rates and frequencies; that of the paper's equation is shorter by the drag ratio.
_TIME = {False: "T", True: "(T/gamma)"}


def onset_text(title: str, onset: Onset, at_force: Spectrum, units: Units) -> str:
    """Return thresholds, later crossings and the spectrum at the given force, one in each line."""
    lines = list(_onset_lines(onset, at_force, units))
    width = max(len(name) for name, _ in lines)
    head = [
        f"{title}: stability of the straight state, method {onset.method}",
        *units_lines(units.names(), units.forces),
    ]
    return "\n".join([*head, *(f"  {name:<{width}}  {content}" for name, content in lines)])


def growth_text(title: str, growth: GrowthCurve, units: Units) -> str:
    """Return leading rates and frequencies as a table."""
    places = list(np.ndindex(growth.rates.shape))
    columns: list[tuple[str, Sequence[str]]] = []
    if growth.parameter is not None and growth.values is not None:
        values = growth.values
        columns = [(growth.parameter, [f"{values[place[0]]:.6g}" for place in places])]
    columns += [
        ("force", [f"{growth.forces[place[-1]]:.6g}" for place in places]),
        ("rate", [f"{growth.rates[place]:.8g}" for place in places]),
        ("frequency", [f"{growth.frequencies[place]:.8g}" for place in places]),
        ("error", [f"{growth.errors[place]:.1g}" for place in places]),
    ]
    unit = _TIME[growth.paper_time]
    head = (
        f"{title}: leading eigenvalue, rates per {unit}, frequencies in cycles per {unit}, method"
        f" {growth.method}"
    )
    return "\n".join([head, *units_lines(units.names()), _table(columns)])


def thresholds_text(title: str, curve: CriticalCurve, units: Sequence[Units]) -> str:
    """Return thresholds along a parameter as a table, with the units of the model at each value."""
    unit, first = _TIME[curve.onsets[0].paper_time], units[0]
    hopf = [own_units.force_in(force) for own_units, force in zip(units, curve.forces, strict=True)]
    columns = [
        (curve.parameter, [f"{value:.6g}" for value in curve.values]),
        ("rings from", [_number(force, 10) for force in curve.oscillatory_forces]),
        ("Hopf force", [_number(force, 10) for force in curve.forces]),
        ("error", [_number(error, 1) for error in curve.errors]),
        *((f"in {name}", [_number(force[name], 6) for force in hopf]) for name in first.forces),
        ("frequency", [_number(frequency, 8) for frequency in curve.frequencies]),
        ("growth slope", [_number(slope, 6) for slope in curve.growth_slopes]),
    ]
    head = (
        f"{title}: thresholds of the straight state in {first.force} and cycles per {unit}, method"
        f" {curve.method}"
    )
    return "\n".join([head, *units_lines(first.names(), first.forces), _table(columns)])


def _onset_lines(onset: Onset, at_force: Spectrum, units: Units) -> Iterator[tuple[str, str]]:
    unit = _TIME[onset.paper_time]
    if onset.oscillatory_force is not None:
        yield "rings from", _force(onset.oscillatory_force, onset.oscillatory_error, units)
    if onset.hopf is None:
        yield "oscillates", f"never: {onset}"
    else:
        yield "oscillates from", _force(onset.hopf.force, onset.hopf.error, units)
        yield from _crossing_lines(onset.hopf, unit, units.force)
    for crossing in onset.later:
        change = "joins" if crossing.growth_slope > 0.0 else "calms down"
        yield (
            "later",
            f"at {_force(crossing.force, crossing.error, units)} a pair of"
            f" {crossing.frequency:.6g} cycles per {unit} {change}",
        )
    for value, error in zip(at_force.values, at_force.errors, strict=True):
        if value.imag < 0.0:
            continue  # the complex conjugate is listed
        rate = f"rate {_rate(float(value.real), float(error))} per {unit}"
        turn = 2.0 * np.pi
        frequency = with_error(value.imag / turn, error / turn) if value.imag > 0.0 else ""
        line = f"{rate}, {frequency} cycles per {unit}" if frequency else rate
        yield f"at {at_force.force:.6g}", line


def _force(force: float, error: float | None, units: Units) -> str:
    return f"{with_error(force, error)} {units.force}{units.bracketed(force)}"


def _crossing_lines(crossing: Crossing, unit: str, force_unit: str) -> Iterator[tuple[str, str]]:
    frequency = with_error(crossing.frequency, crossing.frequency_error)
    yield "frequency", f"{frequency} cycles per {unit}"
    yield "growth slope", f"{crossing.growth_slope:.6g} per {unit} and {force_unit}"


def _rate(value: float, error: float) -> str:
    # A pulled filament straightens at rates that may be tiny and are accurate to many digits.
    if error < abs(value) < 1e-3:
        return f"{value:.6g} ± {error:.1g}"
    return with_error(value, error)


def _number(value: float, digits: int) -> str:
    return f"{value:.{digits}g}" if np.isfinite(value) else "none"


def _table(columns: Sequence[tuple[str, Sequence[str]]]) -> str:
    widths = [max(len(name), *(len(cell) for cell in cells)) for name, cells in columns]
    rows = [[name for name, _ in columns], *zip(*(cells for _, cells in columns), strict=True)]
    return "\n".join(
        "  " + "  ".join(f"{cell:>{width}}" for cell, width in zip(row, widths, strict=True))
        for row in rows
    )
