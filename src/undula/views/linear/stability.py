"""Stability of the straight filament under one load: growth, thresholds and leading mode.

The left half is after the figure "Frequency of oscillations versus linear stability analysis" of
Ling, Guo & Kanso (2018).
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from undula.analysis.linear.curves import GrowthCurve
from undula.analysis.linear.results import Onset, Spectrum
from undula.errors import InputError
from undula.models.scales import Scales
from undula.views.common import style
from undula.views.common.physical_labels import in_physical
from undula.views.linear.growth import draw_growth, set_span, start_at_zero
from undula.views.linear.mode_shapes import draw_mode

# Rows of text above a panel, in fractions of its height.
_LOW, _HIGH = 1.04, 1.13


def stability_portrait(
    onset: Onset,
    growth: GrowthCurve,
    spectrum: Spectrum,
    *,
    title: str,
    units: style.UnitNames = style.FILAMENT,
    scales: Scales | None = None,
) -> Figure:
    """Draw growth rate, frequency and thresholds of the straight filament, and its leading mode.

    Parameters
    ----------
    onset : Onset
        The thresholds, which are marked.
    growth : GrowthCurve
        The leading eigenvalue over the force, without a parameter.
    spectrum : Spectrum
        Spectrum whose leading mode is drawn, over one cycle if it oscillates.
    title : str
        Title of the figure.
    units : mapping of str to str
        Names of the model's units, by quantity; by default those of a filament.
    scales : Scales, optional
        SI values of the dimensionless units, which the labels then state.

    Returns
    -------
    matplotlib.figure.Figure
        10 by 5.5 inches, not registered with pyplot.

    Raises
    ------
    InputError
        `growth` has a parameter, or the three arguments have different time units.

    Examples
    --------
    >>> import numpy as np
    >>> import undula
    >>> from undula.views import stability_portrait
    >>> model = undula.Filament(segments=8, load=undula.TipLoad(75.0))
    >>> growth = undula.growth_curve(model, np.linspace(0.0, 100.0, 5))
    >>> onset, spectrum = undula.onset(model), undula.spectrum(model)
    >>> figure = stability_portrait(onset, growth, spectrum, title="tip force")
    """
    if growth.parameter is not None:
        raise InputError(
            f"growth is over {growth.parameter}: give a curve over the force alone, or use"
            " growth_figure"
        )
    if not onset.paper_time == growth.paper_time == spectrum.paper_time:
        raise InputError(
            f"paper_time is {onset.paper_time} in onset, {growth.paper_time} in growth and"
            f" {spectrum.paper_time} in spectrum: compute all three in one time unit"
        )
    with style.figure_style(scales):
        figure = style.headed_figure(title, paper_time=growth.paper_time)
        upper, lower = draw_growth(figure, growth, units, left=0.085, right=0.6, top=0.82)
        marked = [mark.force for mark in _marks(onset)]
        set_span(upper, np.array([*growth.forces, *marked, spectrum.force]))
        _draw_marks(upper, lower, onset)
        _mark_spectrum(upper, lower, spectrum)
        draw_mode(figure, spectrum)
    return figure


@dataclass(frozen=True)
class _Mark:
    """A vertical line at a force: its name, value, text and dashes."""

    name: str
    force: float
    text: str
    dashes: str


def _marks(onset: Onset) -> list[_Mark]:
    marks = []
    if onset.oscillatory_force is not None:
        force = _force(onset.oscillatory_force)
        text = rf"rings from $F$ = {force}"
        marks.append(_Mark("oscillatory force", onset.oscillatory_force, text, "--"))
    if onset.hopf is not None:
        unit = style.frequency_unit(paper_time=onset.paper_time)
        unit += in_physical("frequency", onset.hopf.frequency)
        text = rf"Hopf at $F$ = {_force(onset.hopf.force)}, {onset.hopf.frequency:.4g} {unit}"
        marks.append(_Mark("Hopf force", onset.hopf.force, text, "-"))
    return marks


def _force(value: float) -> str:
    return f"{value:.4g}{in_physical('force', value)}"


def _draw_marks(upper: Axes, lower: Axes, onset: Onset) -> None:
    """Draw lines at the thresholds, with their values in two rows above the panels."""
    marks = _marks(onset)
    rightwards = bool(marks) and marks[-1].force < np.mean(upper.get_xlim())
    # The text that crosses the other line is in the upper row.
    rows = (_HIGH, _LOW) if rightwards and len(marks) > 1 else (_LOW, _HIGH)
    for mark, row in zip(marks, rows, strict=False):
        look: Any = {"color": style.INK, "lw": 0.9, "ls": mark.dashes, "gid": mark.name}
        upper.axvline(mark.force, ymax=row + 0.05, clip_on=False, **look)
        lower.axvline(mark.force, **look)
        upper.annotate(
            mark.text,
            (mark.force, row),
            xycoords=upper.get_xaxis_transform(),
            xytext=(4 if rightwards else -4, 0),
            textcoords="offset points",
            ha="left" if rightwards else "right",
        )
    if onset.hopf is None:
        text = rf"no loss of stability up to $F$ = {onset.searched_to:.4g}"
        upper.text(0.5, _HIGH, text, ha="center", transform=upper.transAxes)


def _mark_spectrum(upper: Axes, lower: Axes, spectrum: Spectrum) -> None:
    look: Any = {"color": style.ENERGY_COLOUR, "ms": 6.5, "gid": "spectrum", "zorder": 5}
    for axes, value in ((upper, spectrum.rates[0]), (lower, spectrum.frequencies[0])):
        axes.plot([spectrum.force], [value], "o", **look)
    start_at_zero(lower)
    lower.legend(lower.lines[-1:], [rf"mode on the right, $F$ = {spectrum.force:.4g}"], loc="best")
