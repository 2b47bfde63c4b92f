"""Thresholds of the force over a second parameter, several in one panel."""

from collections.abc import Sequence
from itertools import cycle
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from undula.arrays import Array
from undula.errors import InputError
from undula.models.scales import Scales
from undula.views.common import style
from undula.views.common.legends import fitting_legend
from undula.views.linear.growth import set_span, start_at_zero

# Colours and markers; the markers distinguish the curves without colours.
_LOOKS = (
    (style.X_COLOUR, "o"),
    (style.Y_COLOUR, "s"),
    (style.Z_COLOUR, "^"),
    (style.ENERGY_COLOUR, "D"),
    (style.ACTIVE_COLOUR, "v"),
)
# Ratio of thresholds above which the axis is logarithmic.
_DECADES_FROM = 30.0


def threshold_curves(
    curves: Sequence[tuple[str, Array, Array, Array]],
    *,
    parameter: str,
    title: str,
    units: style.UnitNames = style.FILAMENT,
    scales: Scales | None = None,
) -> Figure:
    """Draw thresholds over a parameter, one line with markers for each kind.

    Parameters
    ----------
    curves : sequence of tuple
        Name of each curve, values of the parameter, forces, NaN without a threshold, and errors of
        the forces: arrays of shape (m,).
    parameter : str
        Name of the parameter, such as "load.slope".
    title : str
        Title of the figure.
    units : mapping of str to str
        Names of the models' units, by quantity; by default those of a filament.
    scales : Scales, optional
        SI values of the dimensionless units, which the labels then state.

    Returns
    -------
    matplotlib.figure.Figure
        10 by 5.5 inches, not registered with pyplot. Lines are broken at missing thresholds.

    Raises
    ------
    InputError
        No curve is given, or the arrays of a curve differ in shape.

    Examples
    --------
    >>> import numpy as np
    >>> from undula.views import threshold_curves
    >>> slopes = np.array([-1.0, 0.0, 1.0])
    >>> curve = ("onset", slopes, np.array([90.0, 75.0, 60.0]), np.full(3, 0.1))
    >>> figure = threshold_curves([curve], parameter="load.slope", title="made up")
    """
    if not curves:
        raise InputError("curves is empty: give at least one curve")
    for curve in curves:
        _check(*curve)
    with style.figure_style(scales):
        figure = style.headed_figure(title, paper_time=False)
        axes = figure.add_axes((0.09, 0.105, 0.885, 0.745))
        for (colour, marker), curve in zip(cycle(_LOOKS), curves, strict=False):
            _draw(axes, *curve, colour, marker)
        _set_spans(axes, curves)
        axes.set_xlabel(style.parameter_label(parameter))
        axes.set_ylabel(style.force_label(units))
        handles = axes.get_legend_handles_labels()[0]
        fitting_legend(figure, handles, (0.08, 0.935), handlelength=2.4)
    return figure


def _check(name: str, values: Array, forces: Array, errors: Array) -> None:
    sizes = [np.size(array) for array in (values, forces, errors)]
    if len(set(sizes)) > 1:
        raise InputError(
            f"the curve {name!r} has {sizes[0]} values, {sizes[1]} thresholds and {sizes[2]}"
            " errors: give one of each for every value"
        )


def _draw(
    axes: Axes, name: str, values: Array, forces: Array, errors: Array, colour: str, marker: str
) -> None:
    order = np.argsort(values)
    places, heights, around = (np.asarray(array)[order] for array in (values, forces, errors))
    shown = np.isfinite(heights)
    label = name if np.any(shown) else f"{name}: none found"
    look: Any = {"color": colour, "lw": 1.6, "ms": 5.0, "gid": name, "label": label}
    axes.plot(places, heights, marker=marker, **look)
    shown &= np.isfinite(around)
    low, high = (heights + sign * around for sign in (-1.0, 1.0))
    axes.vlines(places[shown], low[shown], high[shown], color=colour, gid=f"{name}, error")


def _set_spans(axes: Axes, curves: Sequence[tuple[str, Array, Array, Array]]) -> None:
    places = np.concatenate([values for _, values, _, _ in curves])
    # Half a marker fits at both ends.
    margin = 0.015 * float(np.ptp(places))
    set_span(axes, np.array([places.min() - margin, places.max() + margin]))
    forces = np.concatenate([forces for _, _, forces, _ in curves])
    finite = forces[np.isfinite(forces)]
    if finite.size and finite.max() > _DECADES_FROM * finite.min() > 0.0:
        axes.set_yscale("log")
    else:
        start_at_zero(axes)
