"""Figure of quasi-static ramps: energies over the parameter, and shapes of some steps.

After the figure on bead-spring chains of Ling, Guo & Kanso (2018).
"""

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from undula.views.common import style
from undula.views.common.labels import label_above
from undula.views.common.legends import fitting_legend
from undula.views.ramp.energies import (
    LEGEND_SCALE,
    draw_energies,
    draw_thresholds,
    marker,
    threshold_labels,
)
from undula.views.ramp.gallery import (
    LINE,
    Cell,
    chosen_steps,
    common_view,
    draw_cell,
    words_below,
)
from undula.views.ramp.series import StepSeries, read_series, verdict_colours

# Least width of a column, height of the figure, room below a panel, and gap below the words of a
# cell [inches].
_COLUMN, _HEIGHT, _LABEL, _GAP = 3.3, 7.0, 0.6, 0.16
# Bottom of the galleries and baseline of the names of the ramps, in fractions of the figure.
_FOOT, _NAMES = 0.012, 0.884


def ramp_diagram(
    datasets: Sequence[xr.Dataset],
    *,
    thresholds: Sequence[Mapping[str, float]] = (),
    title: str | None = None,
) -> Figure:
    """Draw ramps: bending energies over the parameter, and shapes of some steps.

    Parameters
    ----------
    datasets : sequence of xarray.Dataset
        At least one ramp, as `undula.load_ramp` returns it, all along the same parameter; each is
        a column.
    thresholds : sequence of mapping of str to float
        Names and values of solved thresholds for each ramp; values beyond the steps are left out.
    title : str, optional
        Title of the figure; by default model and load of a single ramp.

    Returns
    -------
    matplotlib.figure.Figure
        10 by 7 inches, wider for more than three ramps; not registered with pyplot.

    Raises
    ------
    InputError
        No ramp is given, a variable is missing, or the ramps are along different parameters.

    Examples
    --------
    >>> import undula
    >>> from undula.views import ramp_diagram
    >>> stored = undula.load("results/steps.nc")
    >>> ramp_diagram([stored]).savefig("steps.png")
    """
    series = read_series(datasets)
    shown = _shown(series, thresholds)
    colours = verdict_colours([verdict for ramp in series for verdict in ramp.verdicts])
    with style.figure_style(datasets[0]):
        figure = Figure(figsize=(max(10.0, _COLUMN * len(series)), _HEIGHT))
        load = series[0].load if len(series) == 1 else ""
        style.write_title(figure, load if title is None else title, (_in(figure, 0.22), 0.955))
        _add_legend(figure, series, colours, thresholds=any(shown))
        top = _draw_galleries(figure, series, colours)
        _draw_panels(figure, series, shown, colours, bottom=top + _LABEL / _HEIGHT)
    return figure


def _shown(
    series: Sequence[StepSeries], thresholds: Sequence[Mapping[str, float]]
) -> list[dict[str, float]]:
    """Return the thresholds of each ramp that lie on its axis."""
    filled = [*thresholds, *({} for _ in series)]
    return [
        {name: value for name, value in own.items() if ramp.span[0] <= value <= ramp.span[1]}
        for ramp, own in zip(series, filled, strict=False)
    ]


def _in(figure: Figure, inches: float) -> float:
    """Return a width in inches as a fraction of the figure."""
    return inches / figure.get_figwidth()


def _columns(figure: Figure, count: int) -> list[tuple[float, float]]:
    """Return the left and right edges of the columns."""
    edges = np.linspace(_in(figure, 0.25), 1.0 - _in(figure, 0.15), count + 1).tolist()
    return list(pairwise(edges))


def _draw_galleries(
    figure: Figure, series: Sequence[StepSeries], colours: Mapping[str, str]
) -> float:
    """Draw shapes of some steps of each ramp; return the upper end of the galleries."""
    rows, across = (1, 7) if len(series) == 1 else (2, 4) if len(series) == 2 else (2, 3)
    columns = _columns(figure, len(series))
    pitch = (columns[0][1] - columns[0][0]) / across
    inches = pitch * figure.get_figwidth()
    galleries = [_cells(ramp, rows * across, colours, inches) for ramp in series]
    # Every regime is shown, even if a gallery then needs more rows.
    rows = max(rows, *(-(-len(gallery) // across) for gallery in galleries))
    cells = [cell for gallery in galleries for cell in gallery]
    view, words = common_view(cells), _GAP + LINE * max(len(cell.words) for cell in cells)
    # The galleries take at most half of the height.
    width_inches = min(0.94 * inches, (0.5 * _HEIGHT / rows - words) / view.aspect)
    height = (width_inches * view.aspect + words) / _HEIGHT
    for (left, _), gallery in zip(columns, galleries, strict=True):
        for place, cell in enumerate(gallery):
            row, column = divmod(place, across)
            middle = left + (column + 0.5) * pitch
            foot = _FOOT + (rows - row - 1) * height + words / _HEIGHT
            width = _in(figure, width_inches)
            draw_cell(figure, cell, view, (middle - 0.5 * width, foot, width))
    return _FOOT + rows * height


def _cells(series: StepSeries, count: int, colours: Mapping[str, str], inches: float) -> list[Cell]:
    verdicts, back = series.verdicts, series.up != series.up[0]
    cells = []
    for k in chosen_steps(series.values, verdicts, back, count):
        direction = (" up" if series.up[k] else " down") if series.there_and_back else ""
        words = words_below(f"{series.values[k]:.6g}{direction}", verdicts[k], inches)
        cells.append(Cell(series.shapes[k], words, colours[verdicts[k]]))
    return cells


def _draw_panels(
    figure: Figure,
    series: Sequence[StepSeries],
    thresholds: Sequence[Mapping[str, float]],
    colours: Mapping[str, str],
    *,
    bottom: float,
) -> None:
    """Draw the energies of each ramp, with the names of the thresholds above."""
    edges = [
        (left + _in(figure, 0.6), right - _in(figure, 0.1))
        for left, right in _columns(figure, len(series))
    ]
    panels = list(zip(series, thresholds, edges, strict=True))
    labels = [threshold_labels(ramp, own, *ends) for ramp, own, ends in panels]
    tops = [label_above(figure, own, *ends) for own, ends in zip(labels, edges, strict=True)]
    for own_labels, top in zip(labels, tops, strict=True):
        for label in own_labels:
            # Leaders continue where the panel of another column ends lower.
            line = [label.place, label.place], [min(tops), top]
            figure.add_artist(Line2D(*line, color=label.colour, lw=0.8))
    for ramp, own, (left, right) in panels:
        axes = figure.add_axes((left, bottom, right - left, min(tops) - bottom))
        draw_energies(figure, axes, ramp, colours)
        draw_thresholds(axes, own)
        if ramp is series[0] or ramp.units != series[0].units:
            axes.set_ylabel(style.energy_label(ramp.units))
        if len(series) > 1:
            figure.text(left, _NAMES, ramp.load)


def _add_legend(
    figure: Figure, series: Sequence[StepSeries], colours: Mapping[str, str], *, thresholds: bool
) -> None:
    handles: list[Artist] = [
        Line2D([], [], label=verdict, **marker(colour, up=True, size=LEGEND_SCALE))
        for verdict, colour in colours.items()
    ]
    if any(ramp.there_and_back for ramp in series):
        handles += [
            Line2D([], [], label=name, **marker(style.QUIET, up=name == "up", size=1.0))
            for name in ("up", "down")
        ]
    if thresholds:
        handles.append(Line2D([], [], color=style.INK, lw=0.8, ls="--", label="solved threshold"))
    fitting_legend(figure, handles, (_in(figure, 0.14), 0.945), handletextpad=0.3)
