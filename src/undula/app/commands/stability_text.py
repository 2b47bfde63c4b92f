"""The answers of `undula stability` for people."""

from collections.abc import Iterator, Sequence

import numpy as np

from undula.analysis.linear.results import CriticalCurve, Crossing, GrowthCurve, Onset, Spectrum
from undula.models.units import Units
from undula.terminal.numbers import with_error
from undula.terminal.units_text import units_lines

#: Rates and frequencies are per this time; the printed equation's is shorter by the drag ratio.
_TIME = {False: "T", True: "(T/gamma)"}


def onset_text(title: str, onset: Onset, at_force: Spectrum, units: Units) -> str:
    """Return thresholds, later crossings and the spectrum at the given force, one a line."""
    lines = list(_onset_lines(onset, at_force, units))
    width = max(len(name) for name, _ in lines)
    head = [
        f"{title}: stability of the straight state, method {onset.method}",
        *units_lines(units.names(), units.forces),
    ]
    return "\n".join([*head, *(f"  {name:<{width}}  {said}" for name, said in lines)])


def growth_text(title: str, growth: GrowthCurve, units: Units) -> str:
    """Return leading rates and frequencies as a table."""
    places = list(np.ndindex(growth.rates.shape))
    columns: list[tuple[str, Sequence[str]]] = []
    if growth.parameter is not None and growth.values is not None:
        values = growth.values
        columns = [(growth.parameter, [f"{values[at[0]]:.6g}" for at in places])]
    columns += [
        ("force", [f"{growth.forces[at[-1]]:.6g}" for at in places]),
        ("rate", [f"{growth.rates[at]:.8g}" for at in places]),
        ("frequency", [f"{growth.frequencies[at]:.8g}" for at in places]),
        ("error", [f"{growth.errors[at]:.1g}" for at in places]),
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
    hopf = [each.force_in(force) for each, force in zip(units, curve.forces, strict=True)]
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
        what = "joins" if crossing.growth_slope > 0.0 else "calms down"
        yield (
            "later",
            f"at {_force(crossing.force, crossing.error, units)} a pair of"
            f" {crossing.frequency:.6g} cycles per {unit} {what}",
        )
    for value, error in zip(at_force.values, at_force.errors, strict=True):
        if value.imag < 0.0:
            continue  # told with its partner
        turns = 2.0 * np.pi
        swings = with_error(value.imag / turns, error / turns) if value.imag > 0.0 else ""
        told = f"rate {_rate(float(value.real), float(error))} per {unit}"
        yield f"at {at_force.force:.6g}", f"{told}, {swings} cycles per {unit}" if swings else told


def _force(force: float, error: float | None, units: Units) -> str:
    return f"{with_error(force, error)} {units.force}{units.beside(force)}"


def _crossing_lines(crossing: Crossing, unit: str, of_force: str) -> Iterator[tuple[str, str]]:
    frequency = with_error(crossing.frequency, crossing.frequency_error)
    yield "frequency", f"{frequency} cycles per {unit}"
    yield "growth slope", f"{crossing.growth_slope:.6g} per {unit} and {of_force}"


def _rate(value: float, error: float) -> str:
    # A filament that is pulled straightens at rates of any smallness, each known to many digits.
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
