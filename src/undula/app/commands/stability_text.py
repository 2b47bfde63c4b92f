"""Answers of `undula stability` for people."""

from collections.abc import Iterator, Sequence

import numpy as np

from undula.analysis.linear.curves import CriticalCurve, GrowthCurve
from undula.analysis.linear.results import Crossing, Onset, Spectrum
from undula.models.scales import Scales
from undula.models.units import Units
from undula.terminal.numbers import with_error
from undula.terminal.physical import bracketed, scales_lines
from undula.terminal.units_text import units_lines

#: Unit of time of rates and frequencies; that of the paper's equation is shorter by the drag ratio.
_TIME = {False: "T", True: "(T/gamma)"}


def onset_text(
    title: str, onset: Onset, at_force: Spectrum, units: Units, scales: Scales | None = None
) -> str:
    """Return thresholds, later crossings and the spectrum at the given force, one in each line."""
    lines = list(_onset_lines(onset, at_force, units, scales))
    width = max(len(name) for name, _ in lines)
    head = [
        f"{title}: stability of the straight state, method {onset.method}",
        *units_lines(units.names(), units.forces),
        *scales_lines(scales),
    ]
    return "\n".join([*head, *(f"  {name:<{width}}  {content}" for name, content in lines)])


def growth_text(title: str, growth: GrowthCurve, units: Units, scales: Scales | None = None) -> str:
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
    return "\n".join([head, *units_lines(units.names()), *scales_lines(scales), _table(columns)])


def thresholds_text(
    title: str, curve: CriticalCurve, units: Sequence[Units], scales: Scales | None = None
) -> str:
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
    lines = [*units_lines(first.names(), first.forces), *scales_lines(scales)]
    return "\n".join([head, *lines, _table(columns)])


def _onset_lines(
    onset: Onset, at_force: Spectrum, units: Units, scales: Scales | None
) -> Iterator[tuple[str, str]]:
    unit = _TIME[onset.paper_time]

    def force(value: float, error: float | None) -> str:
        return f"{_force(value, error, units)}{bracketed(scales, 'force', value, error=error)}"

    if onset.oscillatory_force is not None:
        yield "rings from", force(onset.oscillatory_force, onset.oscillatory_error)
    if onset.hopf is None:
        yield "oscillates", f"never: {onset}"
    else:
        yield "oscillates from", force(onset.hopf.force, onset.hopf.error)
        yield from _crossing_lines(onset.hopf, unit, units.force, scales)
    for crossing in onset.later:
        change = "joins" if crossing.growth_slope > 0.0 else "calms down"
        yield (
            "later",
            f"at {force(crossing.force, crossing.error)} a pair of"
            f" {crossing.frequency:.6g} cycles per {unit}"
            f"{bracketed(scales, 'frequency', crossing.frequency)} {change}",
        )
    yield from _spectrum_lines(at_force, unit, scales)


def _spectrum_lines(
    at_force: Spectrum, unit: str, scales: Scales | None
) -> Iterator[tuple[str, str]]:
    for value, error in zip(at_force.values, at_force.errors, strict=True):
        if value.imag < 0.0:
            continue  # the complex conjugate is listed
        growth, spread = float(value.real), float(error)
        line = f"rate {_rate(growth, spread)} per {unit}"
        line += bracketed(scales, "rate", growth, error=spread)
        if value.imag > 0.0:
            frequency, spread = float(value.imag) / (2.0 * np.pi), spread / (2.0 * np.pi)
            line += f", {with_error(frequency, spread)} cycles per {unit}"
            line += bracketed(scales, "frequency", frequency, error=spread)
        yield f"at {at_force.force:.6g}", line


def _force(force: float, error: float | None, units: Units) -> str:
    return f"{with_error(force, error)} {units.force}{units.bracketed(force)}"


def _crossing_lines(
    crossing: Crossing, unit: str, force_unit: str, scales: Scales | None
) -> Iterator[tuple[str, str]]:
    value, error = crossing.frequency, crossing.frequency_error
    physical = bracketed(scales, "frequency", value, error=error)
    yield "frequency", f"{with_error(value, error)} cycles per {unit}{physical}"
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
